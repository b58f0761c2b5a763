"""Substitutions: $(arg), $(env), $(find), $(eval) and the others."""

from __future__ import annotations

import math
import os.path
from typing import Any

import pytest

from fibws.errors import InvalidValue
from fibws.ros1.errors import PackageNotFound
from fibws.ros1.launch.scope import ALLOWED_NAMES, Scope, evaluate, substitute

from .conftest import FakeEnvironment


@pytest.fixture
def scope(environment: FakeEnvironment) -> Scope:
    scope = Scope(environment, "launch/main.launch", values={"speed": "2", "who": "you and me"})
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
def test_substitutions(text: str, result: str, scope: Scope) -> None:
    assert substitute(text, scope).replace("\\", "/") == result


def test_dirname_is_absolute(scope: Scope) -> None:
    folder = os.path.abspath("launch")
    assert substitute("$(dirname)/a.yaml", scope) == f"{folder}/a.yaml"
    assert substitute("$(eval dirname() + '/a')", scope) == f"{folder}/a"


def test_value_is_not_substituted_again(scope: Scope) -> None:
    scope.values["who"] = "$(env HOME)"
    assert substitute("$(arg who)", scope) == "$(env HOME)"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("$(arg rate)", "rate:=VALUE"),
        ("$(arg spede)", "unknown arg spede; did you mean speed?"),
        ("$(arg)", "expected $(arg NAME)"),
        ("$(arg a b)", "$(arg a b): expected $(arg NAME)"),
        ("$(env NOPE)", "variable NOPE is not set"),
        ("$(optenv)", "missing name"),
        ("$(dirname x)", "$(dirname) takes no arguments"),
        ("$(anon)", "expected $(anon NAME)"),
        ("$(fnd robot)", "$(fnd robot); did you mean find?"),
        ("$(export x)", "$(export x); known are arg, env"),
        ("$()", "unknown substitution $()"),
        ("$(arg speed", "unclosed $(: $(arg speed"),
        ("$(arg $(arg who))", "$(arg $(arg who))"),
        ("x$(eval 1)", "must be the whole text"),
        ("$(eval rate > 1)", "rate:=VALUE"),
        ("$(eval nope)", "unknown name nope"),
    ],
)
def test_invalid_substitution_is_an_error(text: str, error: str, scope: Scope) -> None:
    with pytest.raises(ValueError) as raised:
        substitute(text, scope)
    assert error in str(raised.value)


def test_unknown_package_is_an_error(scope: Scope) -> None:
    with pytest.raises(PackageNotFound, match="did you mean robot"):
        substitute("$(find robt)", scope)


def test_standard_input_has_no_folder(environment: FakeEnvironment) -> None:
    with pytest.raises(ValueError, match="no folder"):
        substitute("$(dirname)", Scope(environment, "<stdin>"))


def test_too_long_result_is_an_error(scope: Scope) -> None:
    scope.values["speed"] = "x" * 10_000
    with pytest.raises(ValueError, match="limit is 1000000"):
        substitute("$(arg speed)" * 200, scope)


# $(eval)


VARIABLES = {"n": 3, "text": "a,b", "arg": {"n": 3}.get, "long": "x" * 100_000}


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("arg('n') * 2 + n", 9),
        ("n > 5 or text.split(',')", ["a", "b"]),
        ("1 < n < 2 < unknown", False),
        ("sin(pi / 2) + sqrt(4)", 3.0),
        ("factorial(5)", 120),
        ("frexp(8)", [0.5, 4]),
        ("pow(2, 0.5)", math.sqrt(2)),
        ("true and not false", True),
    ],
)
def test_expressions_use_arguments_and_mathematics(expression: str, value: Any) -> None:
    assert evaluate(expression, VARIABLES) == value


@pytest.mark.parametrize(
    ("expression", "fact"),
    [
        ("speed > 1", "speed"),
        ("n(1)", "3 is not a function"),
        ("sqrt(-1)", "."),
        ("arg", "function"),
        ("text.__class__", "double underscores"),
        ("arg('n')('n')", "unsupported"),
        ("os.getcwd()", "unsupported"),
        ("open('/etc/passwd')", "unknown name open"),
    ],
)
def test_failures_are_reported(expression: str, fact: str) -> None:
    with pytest.raises(InvalidValue, match=fact):
        evaluate(expression, VARIABLES)


@pytest.mark.parametrize("function", ["factorial", "comb", "perm", "prod", "lcm"])
def test_functions_with_large_results_take_small_numbers_only(function: str) -> None:
    with pytest.raises(InvalidValue, match="limit: 1000"):
        ALLOWED_NAMES[function](1001)


@pytest.mark.parametrize(
    "expression",
    [
        "factorial(100000)",
        "list(map(factorial, [100000]))",
        "map(map, [factorial], [[3000000]])",
        "prod([1000] * 5000)",
        "comb(10 ** 8, 10 ** 7)",
        "long",
    ],
)
def test_expressions_take_neither_long_nor_much_memory(expression: str) -> None:
    with pytest.raises(InvalidValue, match=r"too (large|long)"):
        evaluate(expression, VARIABLES)
