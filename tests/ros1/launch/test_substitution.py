"""$(arg), $(env), $(find) and the others."""

from __future__ import annotations

import os.path

import pytest

from fibws.errors import PackageNotFound
from fibws.ros1.launch.scope import Scope
from fibws.ros1.launch.substitution import substitute

from .conftest import MadeUp


@pytest.fixture
def scope(world: MadeUp) -> Scope:
    scope = Scope(world, "launch/main.launch", values={"speed": "2", "who": "you and me"})
    scope.declared = {"speed", "who", "rate"}
    return scope


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("plain $ text ()", "plain $ text ()"),
        ("$(arg speed)", "2"),
        ("$( arg  speed )m of $(arg who)!", "2m of you and me!"),
        ("$$(arg speed)", "$2"),
        ("$(env HOME)/x", "/home/me/x"),
        ("$(optenv HOME)", "/home/me"),
        ("<$(optenv NOPE)>", "<>"),
        ("$(optenv NOPE two words)", "two words"),
        ("$(optenv EMPTY x)", ""),
        ("$(find robot)/launch/$(arg speed).launch", "/ws/src/robot/launch/2.launch"),
        ("$(anon talker) $(anon talker)", "talker_host_1 talker_host_1"),
        ("$(eval speed * 2 > 3)", "True"),
        ("$(eval arg('who') + env('HOME') + optenv('NOPE', 'n'))", "you and me/home/men"),
        ("$(eval find('robot') + anon('x'))", "/ws/src/robotx_host_1"),
        ("$(eval str(speed) + ')')", "2)"),
    ],
)
def test_a_command_stands_for_its_value(text: str, result: str, scope: Scope) -> None:
    assert substitute(text, scope).replace("\\", "/") == result


def test_the_folder_of_the_file_is_absolute(scope: Scope) -> None:
    folder = os.path.abspath("launch")
    assert substitute("$(dirname)/a.yaml", scope) == f"{folder}/a.yaml"
    assert substitute("$(eval dirname() + '/a')", scope) == f"{folder}/a"


def test_a_value_is_not_read_again(scope: Scope) -> None:
    scope.values["who"] = "$(env HOME)"
    assert substitute("$(arg who)", scope) == "$(env HOME)"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("$(arg rate)", "the arg rate has no value: it must be given as rate:=VALUE"),
        ("$(arg spede)", "no <arg> is called spede here; did you mean speed?"),
        ("$(arg)", "$(arg): write one name, $(arg NAME)"),
        ("$(arg a b)", "$(arg a b): write one name"),
        ("$(env NOPE)", "the environment variable NOPE is not set"),
        ("$(optenv)", "names no variable"),
        ("$(dirname x)", "$(dirname) takes no words"),
        ("$(anon)", "write one name"),
        ("$(fnd robot)", "there is no $(fnd); did you mean find?"),
        ("$(export x)", "there is no $(export); known are arg, env"),
        ("$()", "there is no $()"),
        ("$(arg speed", "a $( is not closed: $(arg speed"),
        ("$(arg $(arg who))", "a $( has another ( or $ in it"),
        ("x$(eval 1)", "$(eval ...) must be all of it"),
        ("$(eval rate > 1)", "the arg rate has no value"),
        ("$(eval nope)", "unknown name nope"),
    ],
)
def test_what_stands_for_nothing_is_an_error(text: str, error: str, scope: Scope) -> None:
    with pytest.raises(ValueError) as raised:
        substitute(text, scope)
    assert error in str(raised.value)


def test_a_package_that_is_not_found_is_an_error(scope: Scope) -> None:
    with pytest.raises(PackageNotFound, match="did you mean robot"):
        substitute("$(find robt)", scope)


def test_standard_input_is_in_no_folder(world: MadeUp) -> None:
    with pytest.raises(ValueError, match="in no folder"):
        substitute("$(dirname)", Scope(world, "<stdin>"))


def test_what_grows_without_end_is_refused(scope: Scope) -> None:
    scope.values["speed"] = "x" * 10_000
    with pytest.raises(ValueError, match="longer than 1000000 characters"):
        substitute("$(arg speed)" * 200, scope)
