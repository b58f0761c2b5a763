"""<node> and <test>."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import LaunchError
from fibws.ros1.launch.model import Node

from .conftest import MAIN, Read

START = '<node pkg="p" type="t" name="n"'


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
def test_a_node_is_as_its_attributes_say(
    attributes: str, expected: dict[str, Any], read: Read
) -> None:
    [node] = read(f"{START} {attributes}/>").nodes.values()
    assert node == Node(package="p", type="t", name="n", file=MAIN, line=2, **expected)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<node type="t" name="n"/>', "<node> has no pkg, which it must have"),
        ('<node pkg="p" name="n"/>', "<node> has no type"),
        ('<node pkg="p" type="t"/>', "<node> has no name"),
        ('<node pkg="" type="t" name="n"/>', "<node pkg>: it is empty"),
        ('<node pkg="p" type="t" name="a/b"/>', "namespaces are not allowed in node names"),
        ('<node pkg="p" type="t" name="a-b"/>', "'a-b' is not a legal name"),
        (f'{START} output="scren"/>', "<node output>: 'scren' is not screen or log"),
        (f'{START} respawn="yes"/>', "<node respawn>: 'yes' is neither true nor false"),
        (f'{START} respawn_delay="-1"/>', "'-1' is no number of 0 or more"),
        (f'{START} respawn_delay="nan"/>', "'nan' is no number of 0 or more"),
        (f'{START} respawn="1" required="1"/>', "both respawn and required"),
        (f'{START} cwd="home"/>', "'home' is not node or ROS_HOME or ros_home"),
        (f'{START} ns=""/>', "<node ns>: it is empty"),
        (f'{START} outptu="screen"/>', "<node> has no attribute outptu; did you mean output?"),
        (f'{START} test-name="x"/>', "<node> has no attribute test-name"),
        (f"{START}><arg/></node>", "<node> has no <arg> in it"),
        (f"{START}><parm/></node>", "<node> has no <parm> in it; did you mean param?"),
        (f'{START} args="$(arg x)"/>', "<node args>: no <arg> is called x here"),
    ],
)
def test_a_node_that_cannot_be_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert str(raised.value).startswith("main.launch:2: ")
    assert error in str(raised.value)


def test_what_is_in_a_node_is_its_own(read: Read) -> None:
    launch = read(
        f'{START}><remap from="a" to="/b//c/"/><env name="A" value="1"/>'
        '<param name="p" value="1" if="1"/><param name="q" value="1" if="0"/></node>'
        '<node pkg="p" type="t" name="m"/>'
    )
    node, other = launch.nodes.values()
    assert (node.remaps, node.environment) == ((("a", "/b/c"),), (("A", "1"),))
    assert (other.remaps, other.environment) == ((), ())
    assert launch.parameters == {"/n/p": 1}


def test_a_later_remap_or_variable_replaces_an_earlier_one(read: Read) -> None:
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
        ('<remap from="a"/>', "<remap> has no to, which it must have"),
        ('<remap to="a"/>', "<remap> has no from"),
        ('<remap from="a b" to="c"/>', "<remap from>: 'a b' is not a legal name"),
        ('<remap from="a" to="1"/>', "<remap to>: '1' is not a legal name"),
        ('<remap from="a" too="b"/>', "did you mean to?"),
        ('<env name="A"/>', "<env> has no value"),
        ('<env value="A"/>', "<env> has no name"),
        ('<env name="A=B" value=""/>', "'A=B' cannot name a variable"),
    ],
)
def test_a_remap_or_a_variable_that_cannot_be_is_an_error(
    text: str, error: str, read: Read
) -> None:
    for around in ("{}", f"{START}>{{}}</node>"):
        with pytest.raises(LaunchError) as raised:
            read(around.format(text))
        assert error in str(raised.value)


def test_an_empty_variable_is_one(read: Read) -> None:
    [node] = read(f'{START}><env name="A" value=""/></node>').nodes.values()
    assert node.environment == (("A", ""),)


def test_a_node_may_clear_its_parameters(read: Read) -> None:
    assert read(f'{START} ns="a" clear_params="true"/>').cleared == ["/a/n"]


def test_a_test_is_a_node_that_does_not_run(read: Read) -> None:
    text = '<test pkg="p" type="t" test-name="x" time-limit="5" retry="1"><remap from="a" to="b"/>'
    [node] = read(f"{text}</test>").nodes.values()
    assert node.is_test
    assert (node.name, node.remaps) == ("x", (("a", "b"),))
    [node] = read('<test pkg="p" type="t" test-name="x" name="y"/>').nodes.values()
    assert node.name == "y"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ('<test pkg="p" type="t" name="y"/>', "<test> has no test-name"),
        ('<test pkg="p" type="t" test-name="x" output="log"/>', "<test> has no attribute output"),
        ('<test pkg="p" type="t" test-name="x" time-limit="a"/>', "'a' is no number"),
        ('<test pkg="p" type="t" test-name="x" nam="a"/>', "did you mean name?"),
    ],
)
def test_a_test_that_cannot_be_is_an_error(text: str, error: str, read: Read) -> None:
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert error in str(raised.value)
