"""Launch files: arguments, groups, includes, and what is wrong in them."""

from __future__ import annotations

import pytest

from fibws.errors import LaunchError
from fibws.ros1.launch.model import Argument
from fibws.ros1.launch.reader import MOST_FILES, MOST_INCLUDES, Reader

from .conftest import MAIN, MadeUp, Read

NODE = '<node pkg="p" type="t" name="{}"/>'


def test_nodes_are_in_the_order_of_the_file(read: Read) -> None:
    launch = read(NODE.format("b") + NODE.format("a"))
    assert [node.resolved for node in launch.nodes.values()] == ["/b", "/a"]
    assert launch.files == [MAIN]


# Arguments


def test_an_argument_has_its_default_or_what_was_given(read: Read) -> None:
    text = '<arg name="n" default="1"/><param name="n" value="$(arg n)"/>'
    assert read(text).parameters == {"/n": 1}
    assert read(text, n="2").parameters == {"/n": 2}


def test_an_argument_with_a_value_cannot_be_given_another(read: Read) -> None:
    text = '<arg name="n" value="1"/>'
    assert read(text).nodes == {}
    with pytest.raises(LaunchError, match=r"main.launch:2: <arg>: n has the value '1' and was"):
        read(text, n="2")


def test_an_argument_may_be_made_of_others(read: Read) -> None:
    text = '<arg name="a" value="x"/><arg name="b" default="$(arg a)y"/>'
    assert read(text + '<param name="p" value="$(arg b)"/>').parameters == {"/p": "xy"}


def test_an_argument_without_a_value_is_missed_where_it_is_needed(read: Read) -> None:
    read('<arg name="n"/>')
    with pytest.raises(LaunchError) as raised:
        read('<arg name="n"/>\n<param name="p" value="$(arg n)"/>')
    assert str(raised.value) == (
        "main.launch:3: <param value>: the arg n has no value: it must be given as n:=VALUE"
    )


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<arg default="1"/>', "<arg> has no name, which it must have"),
        ('<arg name="n" value="1" default="2"/>', "both value and default"),
        ('<arg name="n"/><arg name="n"/>', "n has been declared already"),
        ('<arg name="n" defualt="1"/>', "has no attribute defualt; did you mean default?"),
    ],
)
def test_an_argument_that_cannot_be_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert error in str(raised.value)


def test_an_argument_of_a_group_is_unknown_outside(read: Read) -> None:
    with pytest.raises(LaunchError, match="no <arg> is called n here"):
        read('<group><arg name="n" value="1"/></group><param name="p" value="$(arg n)"/>')


def test_the_arguments_of_a_file_are_known(read: Read) -> None:
    launch = read(
        '<arg name="a" default="$(env HOME)" doc="where"/><arg name="b" value="2"/>'
        '<arg name="c" if="false"/>'
    )
    assert launch.arguments == {
        "a": Argument("a", "/home/me", "where"),
        "b": Argument("b", None, "", True),
    }


def test_arguments_are_known_though_none_is_given(world: MadeUp) -> None:
    reader = Reader(world)
    reader.read_arguments(
        "a.launch",
        b'<launch><arg name="a"/><arg name="b" default="$(arg a)"/><x/><arg name="c"/></launch>',
    )
    assert list(reader.launch.arguments) == ["a", "b", "c"]
    assert reader.launch.arguments["b"].default == "$(arg a)"


def test_what_is_given_and_not_known_is_told(world: MadeUp) -> None:
    reader = Reader(world, {"sped": "1", "__ns": "/x"})
    reader.read("a.launch", b'<launch><arg name="speed" default="1"/></launch>')
    assert reader.unknown_values() == ["sped:=1: no <arg> is called sped; did you mean speed?"]


# if and unless


@pytest.mark.parametrize(
    ("condition", "is_read"),
    [
        ('if="true"', True),
        ('if="1"', True),
        ('if="False"', False),
        ('if="$(eval 1 > 2)"', False),
        ('unless="0"', True),
        ('unless="true"', False),
    ],
)
@pytest.mark.parametrize(
    "tag",
    [
        '<node pkg="p" type="t" name="n" {}/>',
        '<param name="p" value="1" {}/>',
        "<rosparam {}>p: 1</rosparam>",
        '<group {}><param name="p" value="1"/></group>',
        '<test pkg="p" type="t" test-name="n" {}/>',
        '<include file="one.launch" {}/>',
    ],
)
def test_a_tag_is_read_on_condition(
    tag: str, condition: str, is_read: bool, read: Read, world: MadeUp
) -> None:
    world.files["one.launch"] = b'<launch><param name="p" value="1"/></launch>'
    launch = read(tag.format(condition))
    assert bool(launch.nodes or launch.parameters) is is_read


def test_remaps_variables_and_arguments_have_conditions_too(read: Read) -> None:
    launch = read(
        '<remap from="a" to="b" if="0"/><env name="A" value="b" if="0"/>'
        '<arg name="a" value="1" if="0"/><arg name="a" value="2" unless="0"/>'
        + NODE.format("n$(arg a)")
    )
    [node] = launch.nodes.values()
    assert (node.name, node.remaps, node.environment) == ("n2", (), ())


@pytest.mark.parametrize(
    ("condition", "error"),
    [
        ('if="yes"', "<group if>: 'yes' is neither true nor false"),
        ('unless=""', "<group unless>: '' is neither"),
        ('if="1" unless="1"', "<group> has both if and unless"),
        ('if="$(arg x)"', "<group if>: no <arg> is called x here"),
    ],
)
def test_a_condition_that_cannot_be_is_an_error(condition: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(f"<group {condition}/>")
    assert error in str(raised.value)


# Groups


def test_a_group_has_a_namespace_for_what_is_in_it(read: Read) -> None:
    launch = read(
        '<group ns="a"><group ns="b">' + NODE.format("n") + '</group><param name="p" value="1"/>'
        '<group ns="/c">' + NODE.format("n") + "</group></group>" + NODE.format("n")
    )
    assert [node.resolved for node in launch.nodes.values()] == ["/a/b/n", "/c/n", "/n"]
    assert launch.parameters == {"/a/p": 1}


def test_what_a_group_changes_holds_in_it_alone_and_for_what_follows(read: Read) -> None:
    launch = read(
        NODE.format("before") + '<group><remap from="a" to="b"/><env name="A" value="1"/>'
        '<param name="~p" value="1"/>' + NODE.format("within") + "</group>" + NODE.format("after")
    )
    before, within, after = launch.nodes.values()
    assert (within.remaps, within.environment) == ((("a", "b"),), (("A", "1"),))
    for node in (before, after):
        assert (node.remaps, node.environment) == ((), ())
    assert launch.parameters == {"/within/p": 1}


def test_a_group_may_clear_its_parameters(read: Read) -> None:
    assert read('<group ns="a" clear_params="true"/>').cleared == ["/a"]
    with pytest.raises(LaunchError, match="<group clear_params> needs an ns"):
        read('<group clear_params="true"/>')


@pytest.mark.parametrize("namespace", ["", "a b", "~a", "1"])
def test_a_namespace_that_is_no_name_is_an_error(namespace: str, read: Read) -> None:
    with pytest.raises(LaunchError, match=r"main.launch:2: <group ns>: "):
        read(f'<group ns="{namespace}"/>')


def test_all_may_be_in_a_namespace(world: MadeUp) -> None:
    reader = Reader(world, namespace="/robot")
    reader.read("a.launch", f"<launch>{NODE.format('n')}</launch>".encode())
    assert reader.launch.nodes["/robot/n"].resolved == "/robot/n"


# Includes


@pytest.fixture
def one(world: MadeUp) -> MadeUp:
    """one.launch takes an argument, and has another."""
    world.files["one.launch"] = (
        b'<launch><arg name="a"/><arg name="b" default="2"/>\n'
        b'<param name="ab" value="$(arg a)$(arg b)"/></launch>'
    )
    return world


def test_an_include_is_given_arguments(one: MadeUp, read: Read) -> None:
    launch = read(
        '<arg name="x" value="7"/><include file="one.launch"><arg name="a" value="$(arg x)"/>'
        "</include>"
    )
    assert launch.parameters == {"/ab": 72}
    assert launch.files == [MAIN, "one.launch"]
    assert list(launch.arguments) == ["x"]


def test_an_include_does_not_see_other_arguments(one: MadeUp, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read('<arg name="a" value="7"/>\n<include file="one.launch"/>')
    assert str(raised.value) == (
        "one.launch:2: <param value>: the arg a has no value: it must be given as a:=VALUE, "
        "included from main.launch:3"
    )


def test_an_include_may_pass_all_arguments(one: MadeUp, read: Read) -> None:
    text = '<arg name="a" value="7"/><arg name="more" value="1"/>'
    launch = read(f'{text}<include file="one.launch" pass_all_args="true"/>')
    assert launch.parameters == {"/ab": 72}
    launch = read(
        f'{text}<include file="one.launch" pass_all_args="true"><arg name="a" value="8"/></include>'
    )
    assert launch.parameters == {"/ab": 82}


def test_an_include_that_passes_all_may_change_a_value_of_what_is_included(
    world: MadeUp, read: Read
) -> None:
    world.files["one.launch"] = (
        b'<launch><arg name="a" value="1"/><param name="p" value="$(arg a)"/></launch>'
    )
    text = '<arg name="a" value="7"/><include file="one.launch" pass_all_args="true"/>'
    assert read(text).parameters == {"/p": 1}


def test_an_include_has_a_namespace_and_variables(world: MadeUp, read: Read) -> None:
    world.files["one.launch"] = f"<launch>{NODE.format('n')}</launch>".encode()
    launch = read(
        '<include file="one.launch" ns="a" clear_params="true"><env name="A" value="1"/></include>'
        + NODE.format("n")
    )
    assert [(node.resolved, node.environment) for node in launch.nodes.values()] == [
        ("/a/n", (("A", "1"),)),
        ("/n", ()),
    ]
    assert launch.cleared == ["/a"]


def test_the_remaps_of_the_file_hold_in_what_it_includes(world: MadeUp, read: Read) -> None:
    world.files["one.launch"] = (
        f'<launch>{NODE.format("n")}<remap from="c" to="d"/></launch>'.encode()
    )
    launch = read('<remap from="a" to="b"/><include file="one.launch"/>' + NODE.format("m"))
    assert [node.remaps for node in launch.nodes.values()] == [(("a", "b"),), (("a", "b"),)]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<include file="no.launch"/>', "<include>: cannot read no.launch: No such file or direct"),
        ('<include file="no.launch"/>', "; one beside this file is $(dirname)/no.launch"),
        ('<include file=""/>', "<include file>: it is empty"),
        ("<include/>", "<include> has no file, which it must have"),
        ('<include fil="a"/>', "did you mean file?"),
        (
            '<include file="one.launch"><arg name="a" value="1"/><arg name="bb" value="1"/>'
            "</include>",
            "one.launch has no <arg> that is called bb; did you mean b?",
        ),
        ('<include file="one.launch"><arg name="a"/></include>', "a has no value to pass on"),
        ('<include file="one.launch"><node/></include>', "<include> has no <node> in it"),
        ('<include file="$(find robt)/a.launch"/>', "package 'robt' not found: did you mean robot"),
        ('<include file="one.launch" pass_all_args="x"/>', "'x' is neither true nor false"),
    ],
)
def test_an_include_that_cannot_be_is_an_error(
    text: str, error: str, one: MadeUp, read: Read
) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert str(raised.value).startswith("main.launch:2: ")
    assert error in str(raised.value)


def test_an_error_tells_of_all_files_that_lead_to_it(world: MadeUp, read: Read) -> None:
    world.files["one.launch"] = b'<launch>\n\n<include file="two.launch"/></launch>'
    world.files["two.launch"] = b"<launch>\n<nod/></launch>"
    with pytest.raises(LaunchError) as raised:
        read('<include file="one.launch"/>')
    assert str(raised.value) == (
        "two.launch:2: there is no tag <nod>; did you mean node?, "
        "included from one.launch:3, included from main.launch:2"
    )


def test_files_cannot_include_each_other_for_ever(world: MadeUp, read: Read) -> None:
    world.files["one.launch"] = b'<launch><include file="one.launch"/></launch>'
    with pytest.raises(LaunchError, match=f"more than {MOST_INCLUDES} files include each other"):
        read('<include file="one.launch"/>')


def test_an_error_tells_but_once_of_files_that_include_each_other(
    world: MadeUp, read: Read
) -> None:
    world.files["one.launch"] = b'<launch><include file="two.launch"/></launch>'
    world.files["two.launch"] = b'<launch><include file="one.launch"/></launch>'
    with pytest.raises(LaunchError) as raised:
        read('<include file="one.launch"/>')
    assert str(raised.value).count("included from two.launch:1") == 1


def test_files_cannot_include_others_again_and_again(world: MadeUp, read: Read) -> None:
    for level in range(MOST_INCLUDES - 2):
        below = f'<include file="{level + 1}.launch"/>' * 2
        world.files[f"{level}.launch"] = f"<launch>{below}</launch>".encode()
    world.files[f"{MOST_INCLUDES - 2}.launch"] = b"<launch/>"
    with pytest.raises(LaunchError, match=f"more than {MOST_FILES} files are included"):
        read('<include file="0.launch"/>')


# Tags


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("\n<Node/>", "main.launch:3: there is no tag <Node>; did you mean node?"),
        ("<robot/>", "there is no tag <robot>"),
        ('<group n="a"/>', "<group> has no attribute n; did you mean ns?"),
        ("<group><x/></group>", "there is no tag <x>; known are arg, env, group"),
    ],
)
def test_what_is_not_known_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert error in str(raised.value)


@pytest.mark.parametrize(
    ("document", "error"),
    [
        (b"<lunch/>", "a.launch:1: a launch file is one <launch>, not a <lunch>"),
        (b'<launch\n depracated="x"/>', "a.launch:1: <launch> has no attribute depracated"),
    ],
)
def test_a_file_is_one_launch(document: bytes, error: str, world: MadeUp) -> None:
    with pytest.raises(LaunchError) as raised:
        Reader(world).read("a.launch", document)
    assert error in str(raised.value)


def test_what_has_no_meaning_any_more_is_told(world: MadeUp) -> None:
    reader = Reader(world)
    reader.read("a.launch", b'<launch deprecated="use b"><master auto="start"/></launch>')
    assert reader.launch.warnings == [
        "a.launch: deprecated: use b",
        "a.launch:1: <master> has no meaning any more, and is read past",
    ]


def test_two_nodes_cannot_have_one_name(read: Read) -> None:
    with pytest.raises(LaunchError, match=r"main.launch:3: /n is .* the node in main.launch:2"):
        read(NODE.format("n") + "\n" + NODE.format("n"))
    read(NODE.format("n") + '<group ns="a">' + NODE.format("n") + "</group>")


def test_nodes_are_of_this_machine(read: Read, world: MadeUp) -> None:
    here = '<machine name="m" address="localhost" env-loader="/x" user="me"/>'
    assert len(read(here + '<node pkg="p" type="t" name="n" machine="m"/>').nodes) == 1
    away = '<machine name="m" address="robot.local" default="{}"/>'
    assert len(read(away.format("false") + NODE.format("n")).nodes) == 1
    world.here = ("robot.local",)
    assert len(read(away.format("true") + NODE.format("n")).nodes) == 1
    world.here = ()
    for text in ('<node pkg="p" type="t" name="n" machine="m"/>', NODE.format("n")):
        default = "false" if "machine" in text else "true"
        with pytest.raises(LaunchError, match=r"the machine m is robot.local, and nodes are"):
            read(away.format(default) + text)


def test_several_files_are_read_into_one_launch(world: MadeUp) -> None:
    reader = Reader(world, {"a": "1"})
    reader.read(
        "a.launch", b'<launch><arg name="a" default="0"/><env name="A" value="b"/></launch>'
    )
    reader.read("b.launch", f'<launch><arg name="a"/>{NODE.format("n$(arg a)")}</launch>'.encode())
    [node] = reader.launch.nodes.values()
    assert (node.name, node.environment) == ("n1", ())


def test_a_file_that_cannot_be_read_raises(world: MadeUp) -> None:
    with pytest.raises(FileNotFoundError):
        Reader(world).read("nope.launch")
