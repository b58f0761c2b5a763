"""<param> and <rosparam>."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import LaunchError
from fibws.ros1.launch.model import Step

from .conftest import MadeUp, Read


@pytest.mark.parametrize(
    ("attributes", "value"),
    [
        ('value=" 1 "', 1),
        ('value="1.5"', 1.5),
        ('value="true"', True),
        ('value="x y"', "x y"),
        ('value=""', ""),
        ('value="1" type="str"', "1"),
        ('value="1" type=" Double "', 1.0),
        ('value="1" type=""', 1),
        ('value="{a: [1]}" type="yaml"', {"a": [1]}),
        ('textfile="t.txt"', " text\n"),
        ('textfile="$(env HOME)/n"', 7),
        ('binfile="b"', b"\x00\xff"),
        ('command="make it"', "made"),
        ('command="count" type="int"', 3),
    ],
)
def test_a_parameter_has_a_value(attributes: str, value: Any, world: MadeUp, read: Read) -> None:
    world.files = {"t.txt": b" text\n", "/home/me/n": b"7", "b": b"\x00\xff"}
    world.commands = {"make it": "made", "count": "3\n"}
    found = read(f'<param name="p" {attributes}/>').parameters["/p"]
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("attributes", "error"),
    [
        ('name="p"', "<param> has no value: give one of value, textfile, binfile, command"),
        ('name="p" value="1" command="x"', "<param> has value and command: give one of"),
        ('value="1"', "<param> has no name"),
        ('name="p" value="x" type="int"', "<param value>: 'x' is no int"),
        ('name="p" value="1" type="float"', "did you mean double?"),
        ('name="p" value="{" type="yaml"', "<param value>: while parsing"),
        ('name="p" value="null" type="yaml"', "/p: null is no value that a parameter can have"),
        ('name="p" value="2020-01-01" type="yaml"', "/p: 2020-01-01 is a date to YAML"),
        ('name="p" value="inf" type="double"', "/p: inf is no number that JSON has"),
        ('name="p" value="123456789012345678901"', "/p: this number is too large"),
        ('name="p" textfile="nope"', "<param textfile>: cannot read nope: No such file"),
        ('name="p" textfile="binary"', "<param textfile>: "),
        ('name="p" binfile="nope"', "<param binfile>: cannot read nope"),
        ('name="p" command="nope"', "<param command>: cannot run nope"),
        ('name="p" vlaue="1"', "<param> has no attribute vlaue; did you mean value?"),
    ],
)
def test_a_parameter_that_cannot_be_is_an_error(
    attributes: str, error: str, world: MadeUp, read: Read
) -> None:
    world.files = {"binary": b"\xff"}
    with pytest.raises(LaunchError) as raised:
        read(f"\n<param {attributes}/>")
    assert str(raised.value).startswith("main.launch:3: ")
    assert error in str(raised.value)


def test_a_name_is_relative_global_or_private(read: Read) -> None:
    launch = read(
        '<group ns="g"><param name="a/b" value="1"/><param name="/c//d/" value="2"/>'
        '<param name="~e" value="3"/><node pkg="p" type="t" name="n"><param name="f" value="4"/>'
        '<param name="~g" value="5"/><param name="/h" value="6"/></node></group>'
    )
    assert launch.parameters == {
        "/g/a/b": 1,
        "/c/d": 2,
        "/g/n/e": 3,
        "/g/n/f": 4,
        "/g/n/g": 5,
        "/g/n/h": 6,
    }


def test_a_private_parameter_is_that_of_each_node_that_follows(read: Read) -> None:
    node = '<node pkg="p" type="t" name="{}"/>'
    launch = read(
        node.format("a")
        + '<param name="~p" value="1"/>'
        + node.format("b")
        + '<param name="~p" value="2"/>'
        + '<node pkg="p" type="t" name="c"><param name="p" value="3"/></node>'
        + node.format("d")
    )
    assert launch.parameters == {"/b/p": 1, "/c/p": 3, "/d/p": 2}


def test_a_later_parameter_replaces_an_earlier_one(read: Read) -> None:
    launch = read('<param name="p" value="1"/><param name="/p" value="2"/>')
    assert launch.parameters == {"/p": 2}
    assert launch.warnings == []


def test_a_parameter_beside_its_namespace_is_told(read: Read) -> None:
    value, inner = '<param name="p" value="1"/>', '<param name="p/q" value="2"/>'
    for text in (f"\n{value}\n{inner}", f"\n{inner}\n{value}"):
        launch = read(text)
        assert launch.warnings == ["main.launch:4: /p/q cannot be beside /p, which is no namespace"]
    assert read(f'<param name="p" type="yaml" value="{{}}"/>{inner}').warnings == []


# rosparam


@pytest.mark.parametrize(
    ("text", "parameters"),
    [
        ("<rosparam>a: 1\nb: {c: [1, x], d: {}}</rosparam>", {"/a": 1, "/b/c": [1, "x"]}),
        ('<rosparam param="p">[1, 2]</rosparam>', {"/p": [1, 2]}),
        ('<rosparam param="p">{a: 1}</rosparam>', {"/p/a": 1}),
        ('<rosparam ns="n">a: 1</rosparam>', {"/n/a": 1}),
        ('<rosparam ns="n" param="p">1</rosparam>', {"/n/p": 1}),
        ('<rosparam ns="n" param="/p">1</rosparam>', {"/p": 1}),
        ('<group ns="g"><rosparam>a: 1</rosparam></group>', {"/g/a": 1}),
        ('<group ns="g"><rosparam>/a: 1</rosparam></group>', {"/a": 1}),
        ('<group ns="g"><rosparam param="/p">x</rosparam></group>', {"/p": "x"}),
        ("<rosparam/>", {}),
        ("<rosparam><!-- none --></rosparam>", {}),
        ('<rosparam file="f.yaml"/>', {"/x/y": 2}),
        ('<rosparam command="load" file="f.yaml" ns="n"/>', {"/n/x/y": 2}),
        (
            '<rosparam subst_value="true">a: $(env HOME)/$(find robot)</rosparam>',
            {"/a": "/home/me//ws/src/robot"},
        ),
        ("<rosparam>a: $(env HOME)</rosparam>", {"/a": "$(env HOME)"}),
        (
            '<node pkg="p" type="t" name="n"><rosparam>a: 1</rosparam>'
            '<rosparam param="b">2</rosparam><rosparam param="/c">3</rosparam></node>',
            {"/n/a": 1, "/n/b": 2, "/c": 3},
        ),
    ],
)
def test_parameters_are_written_in_yaml(
    text: str, parameters: dict[str, Any], world: MadeUp, read: Read
) -> None:
    world.files = {"f.yaml": b"x:\n  y: 2\n"}
    assert read(text).parameters == parameters


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("<rosparam>1</rosparam>", "say by param= what it is called"),
        ("<rosparam>a: [</rosparam>", "<rosparam>: this is no YAML: while parsing"),
        ("<rosparam>1: 2</rosparam>", "/ has the key 1, which is no text to YAML"),
        ("<rosparam>a: null</rosparam>", "/a: null is no value"),
        ("<rosparam>a: [1, {b: null}]</rosparam>", "/a: null is no value"),
        ("<rosparam>a: [{1: 2}]</rosparam>", "put numbers in quotation marks"),
        ('<rosparam param="~p">1</rosparam>', "private to a node: write it within <node>"),
        ('<rosparam param="/">1</rosparam>', "/ is the namespace of all"),
        ('<rosparam file="no"/>', "<rosparam file>: no: cannot read it: No such file"),
        ('<rosparam file="binary"/>', "<rosparam file>: binary is no text in UTF-8"),
        ('<rosparam file="bad.yaml"/>', "<rosparam file>: bad.yaml: this is no YAML"),
        ('<rosparam command="lod"/>', "'lod' is none of load, dump, delete"),
        ('<rosparam command="dump"/>', "has no file to write to"),
        ('<rosparam command="delete" file="f"/>', 'command="delete" has no use for one'),
        ('<rosparam subst_value="x"/>', "'x' is neither true nor false"),
        ('<rosparam subst_value="1">a: $(env NOPE)</rosparam>', "variable NOPE is not set"),
        ('<rosparam fil="f"/>', "<rosparam> has no attribute fil; did you mean file?"),
    ],
)
def test_a_rosparam_that_cannot_be_is_an_error(
    text: str, error: str, world: MadeUp, read: Read
) -> None:
    world.files = {"binary": b"\xff", "bad.yaml": b"]"}
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert str(raised.value).startswith("main.launch:2: ")
    assert error in str(raised.value)


def test_dumps_and_deletes_are_kept_for_the_start(read: Read) -> None:
    launch = read(
        '<rosparam command="dump" file="$(env HOME)/d.yaml"/><group ns="g">'
        '<rosparam command="delete" param="p"/><rosparam command="delete" ns="q"/></group>'
    )
    assert launch.steps == [
        Step("dump", "/", "/home/me/d.yaml"),
        Step("delete", "/g/p"),
        Step("delete", "/g/q"),
    ]
