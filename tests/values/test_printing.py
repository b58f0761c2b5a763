"""Messages as YAML; what genpy prints is asked of it in `test_side_by_side`."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import pytest

from fibws.values import printing
from fibws.values.printing import Style
from fibws.values.typedefs import Field, Typedefs

MINE = "my_msgs/Mine"
HEADER = "std_msgs/Header"


def typedef(type_: str, fields: list[tuple[str, str, int]]) -> dict[str, Any]:
    return {
        "type": type_,
        "fieldnames": [name for name, _, _ in fields],
        "fieldtypes": [type_ for _, type_, _ in fields],
        "fieldarraylen": [length for _, _, length in fields],
        "constnames": [],
        "constvalues": [],
    }


def with_fields(*fields: tuple[str, str, int]) -> Typedefs:
    header = typedef(HEADER, [("seq", "uint32", -1), ("stamp", "time", -1)])
    return Typedefs(MINE, [typedef(MINE, list(fields)), header])


def printed(type_: str, value: Any, length: int = -1, style: Style = printing.PLAIN) -> str:
    typedefs = with_fields(("data", type_, length))
    text = printing.value({"data": value}, Field("", MINE), typedefs, style)
    assert text.startswith("data: ")
    return text.removeprefix("data: ")


@pytest.mark.parametrize(
    ("type_", "value", "text"),
    [
        ("int32", 8, "8"),
        ("bool", True, "True"),
        ("float64", 1.5, "1.5"),
        ("float64", 3, "3.0"),
        ("float64", None, "nan"),
        ("string", "hello", '"hello"'),
        ("string", "", "''"),
        ("string", 'a "b"\n\x1b', r'"a \"b\"\n\e"'),
        ("string", "ü€🤖", r'"\xFC\u20AC\U0001F916"'),
        ("time", {"secs": 5, "nsecs": 7}, "\n  secs: 5\n  nsecs:         7"),
        ("duration", {"secs": -1, "nsecs": 999999999}, "\n  secs: -1\n  nsecs: 999999999"),
    ],
)
def test_a_value_is_printed_as_by_genpy(type_: str, value: Any, text: str) -> None:
    assert printed(type_, value) == text


@pytest.mark.parametrize(
    ("type_", "value", "text"),
    [
        ("int32", [], "[]"),
        ("int32", [1, 2], "[1, 2]"),
        ("float32", [1.5, None], "[1.5, nan]"),
        ("bool", [True, False], "[True, False]"),
        ("uint8", b64encode(b"\x01\xff").decode(), "[1, 255]"),
        ("char", b64encode(b"a").decode(), "[97]"),
        ("string", ["joint_1", "yes", "a: b"], "\n  - joint_1\n  - 'yes'\n  - 'a: b'"),
        ("time", [{"secs": 1, "nsecs": 0}], "\n  - \n    secs: 1\n    nsecs:         0"),
    ],
)
def test_an_array_is_printed_as_by_genpy(type_: str, value: Any, text: str) -> None:
    assert printed(type_, value, 0) == text


def test_messages_in_messages_are_indented() -> None:
    header = {"seq": 1, "stamp": {"secs": 2, "nsecs": 3}}
    typedefs = with_fields(("header", HEADER, -1), ("several", HEADER, 0))
    assert printing.text({"header": header, "several": [header]}, typedefs) == (
        "header: \n  seq: 1\n  stamp: \n    secs: 2\n    nsecs:         3\n"
        "several: \n  - \n    seq: 1\n    stamp: \n      secs: 2\n      nsecs:         3"
    )


def test_a_long_text_is_broken_as_by_yaml() -> None:
    assert printed("string", "long " * 20).count("\n") == 1


@pytest.mark.parametrize(
    ("type_", "length", "value", "text"),
    [
        ("int32", 0, [1, 2], '"<array type: int32, length: 2>"'),
        ("float64", 3, [1.0, 2.0, 3.0], '"<array type: float64, length: 3>"'),
        ("uint8", 0, b64encode(b"abc").decode(), '"<array type: uint8, length: 3>"'),
        ("string", -1, "hello", '"<string length: 5>"'),
        ("string", 0, ["a"], '"<array type: string, length: 1>"'),
        ("int32", -1, 8, "8"),
    ],
)
def test_lengths_stand_for_arrays_and_texts(type_: str, length: int, value: Any, text: str) -> None:
    assert printed(type_, value, length, Style(noarr=True, nostr=True)) == text


@pytest.mark.parametrize(
    ("type_", "value", "text"),
    [
        ("int32", 8, "    8"),
        ("float64", 1.23456, "1.234"),
        ("float64", 123456.7, "123456"),
        ("bool", True, "True"),
        ("time", {"secs": 5, "nsecs": 7}, "\n  secs:     5\n  nsecs:     7"),
    ],
)
def test_numbers_can_have_one_width(type_: str, value: Any, text: str) -> None:
    assert printed(type_, value, style=Style(width=5)) == text


def test_times_can_count_from_a_moment() -> None:
    style = Style(offset=10_500_000_000)
    time = {"secs": 10, "nsecs": 0}
    assert printed("time", time, style=style) == "\n  secs: -1\n  nsecs: 500000000"
    assert printed("duration", time, style=style) == "\n  secs: 10\n  nsecs:         0"


def test_lines_can_be_indented() -> None:
    typedefs = with_fields(("a", "int32", -1), ("b", "int32", -1))
    assert printing.text({"a": 1, "b": 2}, typedefs, indent=2) == "  a: 1\n  b: 2"


def test_what_is_left_out_has_its_default() -> None:
    typedefs = with_fields(("a", "int32", -1), ("b", "string", -1), ("c", "float64", 2))
    assert printing.text({}, typedefs) == "a: 0\nb: ''\nc: [0.0, 0.0]"


def test_a_message_that_nobody_defined_is_printed_by_its_looks() -> None:
    message = {"a": 1, "b": {"c": "x", "d": None}, "e": [1, 2], "f": [{"g": True}], "h": ["i"]}
    assert printing.text(message, Typedefs("nobodys_msgs/Type")) == (
        'a: 1\nb: \n  c: "x"\n  d: null\ne: [1, 2]\nf: \n  - \n    g: True\nh: \n  - i'
    )
