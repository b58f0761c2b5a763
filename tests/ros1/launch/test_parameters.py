"""<param> and <rosparam>."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.model import RosparamStep
from fibws.ros1.launch.parameters import convert
from fibws.ros1.launch.scope import boolean

from .conftest import FakeEnvironment, Read


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
def test_value_of_a_param(
    attributes: str, value: Any, environment: FakeEnvironment, read: Read
) -> None:
    environment.files = {"t.txt": b" text\n", "/home/me/n": b"7", "b": b"\x00\xff"}
    environment.commands = {"make it": "made", "count": "3\n"}
    found = read(f'<param name="p" {attributes}/>').parameters["/p"]
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("attributes", "error"),
    [
        ('name="p"', "expected one of value, textfile, binfile, command"),
        ('name="p" value="1" command="x"', "value and command"),
        ('value="1"', "<param> requires attribute name"),
        ('name="p" value="x" type="int"', "<param value>: expected int, got 'x'"),
        ('name="p" value="1" type="float"', "did you mean double?"),
        ('name="p" value="{" type="yaml"', "<param value>: while parsing"),
        ('name="p" value="null" type="yaml"', "/p: null"),
        ('name="p" value="2020-01-01" type="yaml"', "/p: 2020-01-01 is a date"),
        ('name="p" value="inf" type="double"', "/p: inf"),
        ('name="p" value="123456789012345678901"', "/p: number too large"),
        ('name="p" textfile="nope"', "<param textfile>: cannot read nope: No such file"),
        ('name="p" textfile="binary"', "<param textfile>: "),
        ('name="p" binfile="nope"', "<param binfile>: cannot read nope"),
        ('name="p" command="nope"', "<param command>: cannot run nope"),
    ],
)
def test_invalid_param_is_an_error(
    attributes: str, error: str, environment: FakeEnvironment, read: Read
) -> None:
    environment.files = {"binary": b"\xff"}
    with pytest.raises(LaunchError) as raised:
        read(f"\n<param {attributes}/>")
    assert str(raised.value).startswith("main.launch:3: ")
    assert error in str(raised.value)


def test_name_may_be_relative_global_or_private(read: Read) -> None:
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


def test_private_parameter_is_set_for_each_later_node(read: Read) -> None:
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


def test_later_parameter_replaces_an_earlier_one(read: Read) -> None:
    launch = read('<param name="p" value="1"/><param name="/p" value="2"/>')
    assert launch.parameters == {"/p": 2}
    assert launch.warnings == []


def test_conflict_of_value_and_namespace_is_a_warning(read: Read) -> None:
    value, inner = '<param name="p" value="1"/>', '<param name="p/q" value="2"/>'
    for text in (f"\n{value}\n{inner}", f"\n{inner}\n{value}"):
        launch = read(text)
        [warning] = launch.warnings
        assert warning.startswith("main.launch:4: ")
        assert "/p/q" in warning and "/p is a value" in warning
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
def test_rosparam_sets_parameters_from_yaml(
    text: str, parameters: dict[str, Any], environment: FakeEnvironment, read: Read
) -> None:
    environment.files = {"f.yaml": b"x:\n  y: 2\n"}
    assert read(text).parameters == parameters


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("<rosparam>1</rosparam>", "param="),
        ("<rosparam>a: [</rosparam>", "<rosparam>: invalid YAML: while parsing"),
        ("<rosparam>1: 2</rosparam>", "/ has the key 1"),
        ("<rosparam>a: null</rosparam>", "/a: null"),
        ("<rosparam>a: [1, {b: null}]</rosparam>", "/a: null"),
        ("<rosparam>a: [{1: 2}]</rosparam>", "quote numbers"),
        ('<rosparam param="~p">1</rosparam>', "~p is private"),
        ('<rosparam param="/">1</rosparam>', "root namespace"),
        ('<rosparam file="no"/>', "<rosparam file>: no: cannot read it: No such file"),
        ('<rosparam file="">a: 1</rosparam>', "<rosparam file>: must not be empty"),
        ('<rosparam file="binary"/>', "<rosparam file>: binary: invalid UTF-8"),
        ('<rosparam file="bad.yaml"/>', "<rosparam file>: bad.yaml: invalid YAML"),
        ('<rosparam command="lod"/>', "expected load or dump or delete, got 'lod'"),
        ('<rosparam command="dump"/>', "requires attribute file"),
        ('<rosparam command="delete" file="f"/>', "<rosparam file>: "),
        ('<rosparam subst_value="x"/>', "got 'x'"),
        ('<rosparam subst_value="1">a: $(env NOPE)</rosparam>', "variable NOPE is not set"),
    ],
)
def test_invalid_rosparam_is_an_error(
    text: str, error: str, environment: FakeEnvironment, read: Read
) -> None:
    environment.files = {"binary": b"\xff", "bad.yaml": b"]"}
    with pytest.raises(LaunchError) as raised:
        read(text)
    assert str(raised.value).startswith("main.launch:2: ")
    assert error in str(raised.value)


def test_dump_and_delete_are_steps_of_the_launch(read: Read) -> None:
    launch = read(
        '<rosparam command="dump" file="$(env HOME)/d.yaml"/><group ns="g">'
        '<rosparam command="delete" param="p"/><rosparam command="delete" ns="q"/></group>'
    )
    assert launch.steps == [
        RosparamStep("dump", "/", "/home/me/d.yaml"),
        RosparamStep("delete", "/g/p"),
        RosparamStep("delete", "/g/q"),
    ]


# Values of <param>


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        ("-7", -7),
        (" 7 ", 7),
        ("1.0", 1.0),
        (".5", 0.5),
        ("1e5", "1e5"),
        ("1.e5", 100000.0),
        ("1_000", "1_000"),
        ("0x10", "0x10"),
        ("1.2.3", "1.2.3"),
        ("true", True),
        ("FALSE", False),
        ("yes", "yes"),
        ("", ""),
        ("[1, 2]", "[1, 2]"),
    ],
)
def test_automatic_type(text: str, value: object) -> None:
    found = convert(text, "auto", yaml.safe_load)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "type_", "value"),
    [
        ("1", "str", "1"),
        ("true", "string", "true"),
        (" 12 ", "int", 12),
        ("1", "double", 1.0),
        ("1", "bool", True),
        (" False ", "boolean", False),
        ("{a: [1, 2.5]}", "yaml", {"a": [1, 2.5]}),
    ],
)
def test_named_type(text: str, type_: str, value: Any) -> None:
    found = convert(text, type_, yaml.safe_load)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "type_", "error"),
    [
        ("1.5", "int", "expected int, got '1.5'"),
        ("x", "double", "expected double, got 'x'"),
        ("yes", "bool", "got 'yes'"),
        ("1", "float", "double"),
        ("1", "intt", "'intt'; did you mean int"),
        ("1", "qqq", "'qqq'; known are auto, str"),
    ],
)
def test_text_that_does_not_fit_its_type_is_an_error(text: str, type_: str, error: str) -> None:
    with pytest.raises(ValueError, match=error):
        convert(text, type_, yaml.safe_load)


def test_texts_of_bools() -> None:
    assert [boolean(text) for text in ("true", "1", "False", "0 ")] == [True, True, False, False]
