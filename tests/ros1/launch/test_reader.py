"""The reader of launch files: arguments, conditions, groups, includes, nodes."""

from __future__ import annotations

from itertools import count
from typing import Any

import pytest

from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.model import Argument, LaunchNode
from fibws.ros1.launch.reader import MOST_FILES, MOST_INCLUDES, LaunchReader

from .conftest import MAIN, FakeEnvironment, Read

NODE = '<node pkg="p" type="t" name="{}"/>'
START = '<node pkg="p" type="t" name="n"'


def test_nodes_keep_the_order_of_the_file(read: Read) -> None:
    launch = read(NODE.format("b") + NODE.format("a"))
    assert [node.resolved for node in launch.nodes.values()] == ["/b", "/a"]
    assert launch.files == [MAIN]


# Arguments


def test_arg_has_its_default_or_the_given_value(read: Read) -> None:
    text = '<arg name="n" default="1"/><param name="n" value="$(arg n)"/>'
    assert read(text).parameters == {"/n": 1}
    assert read(text, n="2").parameters == {"/n": 2}


def test_arg_with_a_fixed_value_cannot_be_set(read: Read) -> None:
    text = '<arg name="n" value="1"/>'
    assert read(text).nodes == {}
    with pytest.raises(LaunchError, match=r"main.launch:2: <arg>: .*'2'.*'1'"):
        read(text, n="2")


def test_arg_may_use_others(read: Read) -> None:
    text = '<arg name="a" value="x"/><arg name="b" default="$(arg a)y"/>'
    assert read(text + '<param name="p" value="$(arg b)"/>').parameters == {"/p": "xy"}


def test_missing_value_of_an_arg_is_an_error_where_it_is_used(read: Read) -> None:
    read('<arg name="n"/>')
    with pytest.raises(LaunchError) as raised:
        read('<arg name="n"/>\n<param name="p" value="$(arg n)"/>')
    assert str(raised.value).startswith("main.launch:3: <param value>: ")
    assert "n:=VALUE" in str(raised.value)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<arg default="1"/>', "<arg> requires attribute name"),
        ('<arg name="n" value="1" default="2"/>', "both value and default"),
        ('<arg name="n"/><arg name="n"/>', "n is declared twice"),
    ],
)
def test_invalid_arg_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert error in str(raised.value)


def test_arg_of_a_group_is_unknown_outside(read: Read) -> None:
    with pytest.raises(LaunchError, match="unknown arg n"):
        read('<group><arg name="n" value="1"/></group><param name="p" value="$(arg n)"/>')


def test_arguments_of_a_file_are_known(read: Read) -> None:
    launch = read(
        '<arg name="a" default="$(env HOME)" doc="where"/><arg name="b" value="2"/>'
        '<arg name="c" if="false"/>'
    )
    assert launch.arguments == {
        "a": Argument("a", "/home/me", "where"),
        "b": Argument("b", None, "", True),
    }


def test_arguments_are_known_without_values(environment: FakeEnvironment) -> None:
    reader = LaunchReader(environment)
    reader.read_arguments(
        "a.launch",
        b'<launch><arg name="a"/><arg name="b" default="$(arg a)"/><x/><arg name="c"/></launch>',
    )
    assert list(reader.launch.arguments) == ["a", "b", "c"]
    assert reader.launch.arguments["b"].default == "$(arg a)"


def test_unknown_value_is_reported(environment: FakeEnvironment) -> None:
    reader = LaunchReader(environment, {"sped": "1", "__ns": "/x"})
    reader.read("a.launch", b'<launch><arg name="speed" default="1"/></launch>')
    [warning] = reader.unknown_values()
    assert "sped:=1" in warning and "did you mean speed?" in warning


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
def test_if_and_unless_apply_to_all_tags(
    tag: str, condition: str, is_read: bool, read: Read, environment: FakeEnvironment
) -> None:
    environment.files["one.launch"] = b'<launch><param name="p" value="1"/></launch>'
    launch = read(tag.format(condition))
    assert bool(launch.nodes or launch.parameters) is is_read


def test_if_and_unless_apply_to_remap_env_and_arg(read: Read) -> None:
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
        ('if="yes"', "<group if>: expected true or false, got 'yes'"),
        ('unless=""', "<group unless>: "),
        ('if="1" unless="1"', "<group> has both if and unless"),
        ('if="$(arg x)"', "<group if>: unknown arg x"),
    ],
)
def test_invalid_condition_is_an_error(condition: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(f"<group {condition}/>")
    assert error in str(raised.value)


# Groups


def test_group_has_a_namespace(read: Read) -> None:
    launch = read(
        '<group ns="a"><group ns="b">' + NODE.format("n") + '</group><param name="p" value="1"/>'
        '<group ns="/c">' + NODE.format("n") + "</group></group>" + NODE.format("n")
    )
    assert [node.resolved for node in launch.nodes.values()] == ["/a/b/n", "/c/n", "/n"]
    assert launch.parameters == {"/a/p": 1}


def test_group_limits_the_scope_of_remaps_variables_and_private_parameters(read: Read) -> None:
    launch = read(
        NODE.format("before") + '<group><remap from="a" to="b"/><env name="A" value="1"/>'
        '<param name="~p" value="1"/>' + NODE.format("within") + "</group>" + NODE.format("after")
    )
    before, within, after = launch.nodes.values()
    assert (within.remaps, within.environment) == ((("a", "b"),), (("A", "1"),))
    for node in (before, after):
        assert (node.remaps, node.environment) == ((), ())
    assert launch.parameters == {"/within/p": 1}


def test_group_may_clear_its_parameters(read: Read) -> None:
    assert read('<group ns="a" clear_params="true"/>').cleared == ["/a"]
    with pytest.raises(LaunchError, match="<group clear_params> requires attribute ns"):
        read('<group clear_params="true"/>')


@pytest.mark.parametrize("namespace", ["", "a b", "~a", "1"])
def test_invalid_namespace_is_an_error(namespace: str, read: Read) -> None:
    with pytest.raises(LaunchError, match=r"main.launch:2: <group ns>: "):
        read(f'<group ns="{namespace}"/>')


def test_everything_can_be_put_into_a_namespace(environment: FakeEnvironment) -> None:
    reader = LaunchReader(environment, namespace="/robot")
    reader.read("a.launch", f"<launch>{NODE.format('n')}</launch>".encode())
    assert reader.launch.nodes["/robot/n"].resolved == "/robot/n"


# Includes


@pytest.fixture
def one(environment: FakeEnvironment) -> FakeEnvironment:
    """A file one.launch with an argument, and another one with a default."""
    environment.files["one.launch"] = (
        b'<launch><arg name="a"/><arg name="b" default="2"/>\n'
        b'<param name="ab" value="$(arg a)$(arg b)"/></launch>'
    )
    return environment


def test_include_passes_arguments(one: FakeEnvironment, read: Read) -> None:
    launch = read(
        '<arg name="x" value="7"/><include file="one.launch"><arg name="a" value="$(arg x)"/>'
        "</include>"
    )
    assert launch.parameters == {"/ab": 72}
    assert launch.files == [MAIN, "one.launch"]
    assert list(launch.arguments) == ["x"]


def test_include_does_not_pass_other_arguments(one: FakeEnvironment, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read('<arg name="a" value="7"/>\n<include file="one.launch"/>')
    assert str(raised.value).startswith("one.launch:2: <param value>: ")
    assert str(raised.value).endswith(", included from main.launch:3")


def test_include_may_pass_all_arguments(one: FakeEnvironment, read: Read) -> None:
    text = '<arg name="a" value="7"/><arg name="more" value="1"/>'
    launch = read(f'{text}<include file="one.launch" pass_all_args="true"/>')
    assert launch.parameters == {"/ab": 72}
    launch = read(
        f'{text}<include file="one.launch" pass_all_args="true"><arg name="a" value="8"/></include>'
    )
    assert launch.parameters == {"/ab": 82}


def test_included_file_may_change_a_value_passed_by_pass_all_args(
    environment: FakeEnvironment, read: Read
) -> None:
    environment.files["one.launch"] = (
        b'<launch><arg name="a" value="1"/><param name="p" value="$(arg a)"/></launch>'
    )
    text = '<arg name="a" value="7"/><include file="one.launch" pass_all_args="true"/>'
    assert read(text).parameters == {"/p": 1}


@pytest.mark.parametrize("attributes", ["", 'pass_all_args="true"', 'ns="a"'])
def test_included_file_has_anonymous_names_of_its_own(
    environment: FakeEnvironment, read: Read, monkeypatch: pytest.MonkeyPatch, attributes: str
) -> None:
    numbers = count(1)
    monkeypatch.setattr(environment, "anonymous", lambda name: f"{name}_{next(numbers)}")
    environment.files["one.launch"] = b'<launch><param name="included" value="$(anon n)"/></launch>'
    launch = read(
        f'<param name="before" value="$(anon n)"/><include file="one.launch" {attributes}/>'
        '<param name="after" value="$(anon n)"/>'
    )
    assert list(launch.parameters.values()) == ["n_1", "n_2", "n_1"]


def test_include_has_a_namespace_and_variables(environment: FakeEnvironment, read: Read) -> None:
    environment.files["one.launch"] = f"<launch>{NODE.format('n')}</launch>".encode()
    launch = read(
        '<include file="one.launch" ns="a" clear_params="true"><env name="A" value="1"/></include>'
        + NODE.format("n")
    )
    assert [(node.resolved, node.environment) for node in launch.nodes.values()] == [
        ("/a/n", (("A", "1"),)),
        ("/n", ()),
    ]
    assert launch.cleared == ["/a"]


def test_remaps_apply_to_included_files(environment: FakeEnvironment, read: Read) -> None:
    environment.files["one.launch"] = (
        f'<launch>{NODE.format("n")}<remap from="c" to="d"/></launch>'.encode()
    )
    launch = read('<remap from="a" to="b"/><include file="one.launch"/>' + NODE.format("m"))
    assert [node.remaps for node in launch.nodes.values()] == [(("a", "b"),), (("a", "b"),)]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<include file="no.launch"/>', "<include>: cannot read no.launch: No such file"),
        ('<include file="no.launch"/>', "$(dirname)/no.launch"),
        ('<include file=""/>', "<include file>: must not be empty"),
        ("<include/>", "<include> requires attribute file"),
        (
            '<include file="one.launch"><arg name="a" value="1"/><arg name="bb" value="1"/>'
            "</include>",
            "one.launch has no <arg> bb; did you mean b?",
        ),
        ('<include file="one.launch"><arg name="a"/></include>', "missing value of a"),
        ('<include file="$(find robt)/a.launch"/>', "package 'robt' not found"),
        ('<include file="one.launch" pass_all_args="x"/>', "got 'x'"),
    ],
)
def test_invalid_include_is_an_error(
    text: str, error: str, one: FakeEnvironment, read: Read
) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert str(raised.value).startswith("main.launch:2: ")
    assert error in str(raised.value)


def test_error_names_the_including_files(environment: FakeEnvironment, read: Read) -> None:
    environment.files["one.launch"] = b'<launch>\n\n<include file="two.launch"/></launch>'
    environment.files["two.launch"] = b"<launch>\n<node/></launch>"
    with pytest.raises(LaunchError) as raised:
        read('<include file="one.launch"/>')
    assert str(raised.value).startswith("two.launch:2: ")
    assert str(raised.value).endswith(", included from one.launch:3, included from main.launch:2")


def test_endless_includes_are_an_error(environment: FakeEnvironment, read: Read) -> None:
    environment.files["one.launch"] = b'<launch><include file="one.launch"/></launch>'
    with pytest.raises(LaunchError, match=f"limit is {MOST_INCLUDES} files"):
        read('<include file="one.launch"/>')


def test_error_names_each_including_file_once(environment: FakeEnvironment, read: Read) -> None:
    environment.files["one.launch"] = b'<launch><include file="two.launch"/></launch>'
    environment.files["two.launch"] = b'<launch><include file="one.launch"/></launch>'
    with pytest.raises(LaunchError) as raised:
        read('<include file="one.launch"/>')
    assert str(raised.value).count("included from two.launch:1") == 1


def test_too_many_includes_are_an_error(environment: FakeEnvironment, read: Read) -> None:
    for level in range(MOST_INCLUDES - 2):
        below = f'<include file="{level + 1}.launch"/>' * 2
        environment.files[f"{level}.launch"] = f"<launch>{below}</launch>".encode()
    environment.files[f"{MOST_INCLUDES - 2}.launch"] = b"<launch/>"
    with pytest.raises(LaunchError, match=f"limit is {MOST_FILES}"):
        read('<include file="0.launch"/>')


# Tags


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("<Node/>", "unknown tag <Node>; did you mean node?"),
        ('<sphinxdoc if="nonsense">x</sphinxdoc>', "unknown tag <sphinxdoc>"),
        ('<group n="a"/>', "unknown attribute n of <group>; did you mean ns?"),
        ('<arg name="n" defualt="1"/>', "unknown attribute defualt of <arg>"),
        (f'{START} outptu="screen"/>', "unknown attribute outptu of <node>; did you mean output?"),
        (f'{START} test-name="x"/>', "unknown attribute test-name of <node>"),
        (f"{START}><arg/></node>", "unknown tag <arg>"),
        (f"{START}><parm/></node>", "unknown tag <parm>; did you mean param?"),
        ('<test pkg="p" type="t" test-name="x" nam="a"/>', "did you mean name?"),
        ('<remap from="a" to="b" too="c"/>', "did you mean to?"),
        ('<param name="p" value="1" vlaue="1"/>', "did you mean value?"),
        ('<rosparam fil="f">a: 1</rosparam>', "did you mean file?"),
        ('<include file="one.launch" fil="a"/>', "did you mean file?"),
        ('<include file="one.launch"><node/></include>', "unknown tag <node>"),
    ],
)
def test_unknown_tags_and_attributes_are_warnings(
    text: str, warning: str, environment: FakeEnvironment, read: Read
) -> None:
    environment.files["one.launch"] = b"<launch/>"
    launch = read(f"\n{text}\n{NODE.format('other')}")
    [found] = launch.warnings
    assert found.startswith("main.launch:3: ")
    assert warning in found
    assert "/other" in launch.nodes


@pytest.mark.parametrize(
    ("document", "error"),
    [
        (b"\n<lunch/>", "a.launch:2: expected <launch>, got <lunch>"),
        (b"<launch>", "a.launch:1: "),
    ],
)
def test_file_without_a_launch_is_an_error(
    document: bytes, error: str, environment: FakeEnvironment
) -> None:
    with pytest.raises(LaunchError) as raised:
        LaunchReader(environment).read("a.launch", document)
    assert error in str(raised.value)


def test_obsolete_tags_are_warnings(environment: FakeEnvironment) -> None:
    reader = LaunchReader(environment)
    reader.read("a.launch", b'<launch deprecated="use b"><master auto="start"/></launch>')
    deprecated, master = reader.launch.warnings
    assert deprecated == "a.launch: deprecated: use b"
    assert master.startswith("a.launch:1: <master>")


def test_two_nodes_with_one_name_are_an_error(read: Read) -> None:
    with pytest.raises(LaunchError, match=r"main.launch:3: /n is .* main.launch:2"):
        read(NODE.format("n") + "\n" + NODE.format("n"))
    read(NODE.format("n") + '<group ns="a">' + NODE.format("n") + "</group>")


def test_nodes_are_of_this_machine(read: Read, environment: FakeEnvironment) -> None:
    here = '<machine name="m" address="localhost" env-loader="/x" user="me"/>'
    assert len(read(here + '<node pkg="p" type="t" name="n" machine="m"/>').nodes) == 1
    away = '<machine name="m" address="robot.local" default="{}"/>'
    assert len(read(away.format("false") + NODE.format("n")).nodes) == 1
    environment.local = ("robot.local",)
    assert len(read(away.format("true") + NODE.format("n")).nodes) == 1
    environment.local = ()
    for text in ('<node pkg="p" type="t" name="n" machine="m"/>', NODE.format("n")):
        default = "false" if "machine" in text else "true"
        with pytest.raises(LaunchError, match=r"machine m \(robot.local\)"):
            read(away.format(default) + text)


def test_machine_may_be_declared_after_its_nodes(read: Read) -> None:
    node = '<node pkg="p" type="t" name="n" machine="m"/>'
    text = node + '<machine name="m" address="localhost" timeout="10" default="TRUE"/>'
    assert len(read(text).nodes) == 1
    with pytest.raises(LaunchError, match=r"main.launch:2: .*unknown machine m"):
        read(node)


@pytest.mark.parametrize(
    ("attributes", "error"),
    [
        ('timeout="0"', "<machine timeout>: must be a number > 0, got '0'"),
        ('timeout=""', "<machine timeout>: must be a number > 0, got ''"),
        ('ssh-port="x"', "<machine ssh-port>: expected an integer, got 'x'"),
        ('default="x"', "<machine default>: expected true, false or never, got 'x'"),
        ('ros-root="/x"', "<machine ros-root>: not supported"),
        ('user="$(arg nope)"', "<machine user>: unknown arg nope"),
    ],
)
def test_invalid_attribute_of_a_machine_is_an_error(
    attributes: str, error: str, read: Read
) -> None:
    with pytest.raises(LaunchError) as raised:
        read(f'<machine name="m" address="localhost" {attributes}/>')
    assert error in str(raised.value)


def test_machine_is_declared_once(read: Read) -> None:
    machine = '<machine name="m" address="localhost"/>\n'
    read(machine + machine)
    with pytest.raises(LaunchError, match=r"main.launch:3: .*m is declared twice"):
        read(machine + '<machine name="m" address="localhost" user="me"/>')


def test_tags_in_nodes_and_includes_may_be_in_upper_case(
    read: Read, environment: FakeEnvironment
) -> None:
    environment.files = {"a.launch": b'<launch><arg name="a"/></launch>'}
    launch = read(
        f'{START}><Param name="a" value="1"/></node>'
        '<include file="a.launch"><ARG name="a" value="1"/></include><Node/>'
    )
    assert launch.parameters == {"/n/a": 1}
    [warning] = launch.warnings
    assert "<Node>" in warning


def test_several_files_are_read_into_one_launch(environment: FakeEnvironment) -> None:
    reader = LaunchReader(environment, {"a": "1"})
    reader.read(
        "a.launch", b'<launch><arg name="a" default="0"/><env name="A" value="b"/></launch>'
    )
    reader.read("b.launch", f'<launch><arg name="a"/>{NODE.format("n$(arg a)")}</launch>'.encode())
    [node] = reader.launch.nodes.values()
    assert (node.name, node.environment) == ("n1", ())


def test_file_that_cannot_be_read_raises(environment: FakeEnvironment) -> None:
    with pytest.raises(FileNotFoundError):
        LaunchReader(environment).read("nope.launch")


# <node>, <test>, <remap>, <env>


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ("", {}),
        ("args=\"-x $(env HOME) 'a b'\"", {"args": "-x /home/me 'a b'"}),
        ('output="screen"', {"screen": True}),
        ('output="log"', {"screen": False}),
        ('respawn="true" respawn_delay="1.5"', {"respawn": True, "respawn_delay": 1.5}),
        ('required="true"', {"required": True}),
        ('ns="a//b/"', {"namespace": "/a/b"}),
        ('ns="/"', {"namespace": "/"}),
        ('cwd="node"', {"cwd": "node"}),
        ('cwd="ROS_HOME"', {"cwd": None}),
        ('cwd="ros_home"', {"cwd": None}),
        ('launch-prefix="gdb --args"', {"prefix": "gdb --args"}),
        ('machine=""', {}),
    ],
)
def test_attributes_of_a_node(attributes: str, expected: dict[str, Any], read: Read) -> None:
    [node] = read(f"{START} {attributes}/>").nodes.values()
    assert node == LaunchNode(package="p", type="t", name="n", file=MAIN, line=2, **expected)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<node type="t" name="n"/>', "<node> requires attribute pkg"),
        ('<node pkg="p" name="n"/>', "<node> requires attribute type"),
        ('<node pkg="p" type="t"/>', "<node> requires attribute name"),
        ('<node pkg="" type="t" name="n"/>', "<node pkg>: must not be empty"),
        ('<node pkg="p" type="t" name="a/b"/>', "namespaces are not allowed in node names"),
        ('<node pkg="p" type="t" name="a-b"/>', "'a-b' is not a legal name"),
        (f'{START} output="scren"/>', "<node output>: expected screen or log, got 'scren'"),
        (f'{START} respawn="yes"/>', "<node respawn>: expected true or false, got 'yes'"),
        (f'{START} respawn_delay="-1"/>', "must be a number >= 0, got '-1'"),
        (f'{START} respawn_delay="nan"/>', "got 'nan'"),
        (f'{START} respawn="1" required="1"/>', "both respawn and required"),
        (f'{START} cwd="home"/>', "got 'home'"),
        (f'{START} ns=""/>', "<node ns>: must not be empty"),
        (f'{START} args="$(arg x)"/>', "<node args>: unknown arg x"),
    ],
)
def test_invalid_node_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert str(raised.value).startswith("main.launch:2: ")
    assert error in str(raised.value)


def test_tags_in_a_node_apply_to_it_only(read: Read) -> None:
    launch = read(
        f'{START}><remap from="a" to="/b//c/"/><env name="A" value="1"/>'
        '<param name="p" value="1" if="1"/><param name="q" value="1" if="0"/></node>'
        '<node pkg="p" type="t" name="m"/>'
    )
    node, other = launch.nodes.values()
    assert (node.remaps, node.environment) == ((("a", "/b/c"),), (("A", "1"),))
    assert (other.remaps, other.environment) == ((), ())
    assert launch.parameters == {"/n/p": 1}


def test_later_remap_or_variable_replaces_an_earlier_one(read: Read) -> None:
    launch = read(
        '<remap from="a" to="b"/><remap from="c" to="d"/><env name="A" value="1"/>'
        f'{START}><remap from="a" to="x"/><env name="A" value="2"/></node>'
        '<node pkg="p" type="t" name="m"/>'
    )
    node, other = launch.nodes.values()
    assert (node.remaps, node.environment) == ((("c", "d"), ("a", "x")), (("A", "2"),))
    assert (other.remaps, other.environment) == ((("a", "b"), ("c", "d")), (("A", "1"),))


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<remap from="a"/>', "<remap> requires attribute to"),
        ('<remap to="a"/>', "<remap> requires attribute from"),
        ('<remap from="a b" to="c"/>', "<remap from>: 'a b' is not a legal name"),
        ('<remap from="a" to="1"/>', "<remap to>: '1' is not a legal name"),
        ('<env name="A"/>', "<env> requires attribute value"),
        ('<env value="A"/>', "<env> requires attribute name"),
        ('<env name="A=B" value=""/>', "'A=B'"),
    ],
)
def test_invalid_remap_or_env_is_an_error(text: str, error: str, read: Read) -> None:
    for around in ("{}", f"{START}>{{}}</node>"):
        with pytest.raises(LaunchError) as raised:
            read(around.format(text))
        assert error in str(raised.value)


def test_variable_may_be_empty(read: Read) -> None:
    [node] = read(f'{START}><env name="A" value=""/></node>').nodes.values()
    assert node.environment == (("A", ""),)


def test_node_may_clear_its_parameters(read: Read) -> None:
    assert read(f'{START} ns="a" clear_params="true"/>').cleared == ["/a/n"]


def test_test_is_a_node_that_is_not_run(read: Read) -> None:
    text = '<test pkg="p" type="t" test-name="x" time-limit="5" retry="1"><remap from="a" to="b"/>'
    [node] = read(f"{text}</test>").nodes.values()
    assert node.is_test
    assert (node.test_name, node.time_limit, node.retry) == ("x", 5.0, 1)
    assert (node.name, node.remaps) == ("x", (("a", "b"),))
    [node] = read('<test pkg="p" type="t" test-name="x" name="y"/>').nodes.values()
    assert node.name == "y"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<test pkg="p" type="t" name="y"/>', "<test> requires attribute test-name"),
        ('<test pkg="p" type="t" test-name="x" output="log"/>', "<test> has no attribute output"),
        ('<test pkg="p" type="t" test-name="x" time-limit="a"/>', "got 'a'"),
        ('<test pkg="p" type="t" test-name="x" time-limit="0"/>', "must be a number > 0, got '0'"),
    ],
)
def test_invalid_test_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert error in str(raised.value)
