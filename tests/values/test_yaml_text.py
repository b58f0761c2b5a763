"""YAML text of messages; compared with genpy's in `test_side_by_side`."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import pytest
import yaml

from fibws.values.typedefs import TypedefField, Typedefs
from fibws.values.yaml_text import PLAIN, Style, listed, message_text, quoted, value_text

MINE = "my_msgs/Mine"
HEADER = "std_msgs/Header"
TEXTS = [
    *("hello", "two words", "  spaces ", 'a "quoted" word', "back\\slash", "it's", "yes", "12"),
    *("line\nbreak", "tab\there", "\x1b[31mred", "\0", "\x85\xa0", "grüße", "€", "🤖", "\u2028"),
    *("- item", "x" * 100, "long " * 40, "ü" * 50, "/base_link", "joint_1", "~", ""),
]


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


def printed(type_: str, value: Any, length: int = -1, style: Style = PLAIN) -> str:
    typedefs = with_fields(("data", type_, length))
    text = value_text({"data": value}, TypedefField("", MINE), typedefs, style)
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
def test_values_are_printed_as_by_genpy(type_: str, value: Any, text: str) -> None:
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
def test_arrays_are_printed_as_by_genpy(type_: str, value: Any, text: str) -> None:
    assert printed(type_, value, 0) == text


def test_nested_messages_are_indented() -> None:
    header = {"seq": 1, "stamp": {"secs": 2, "nsecs": 3}}
    typedefs = with_fields(("header", HEADER, -1), ("several", HEADER, 0))
    assert message_text({"header": header, "several": [header]}, typedefs) == (
        "header: \n  seq: 1\n  stamp: \n    secs: 2\n    nsecs:         3\n"
        "several: \n  - \n    seq: 1\n    stamp: \n      secs: 2\n      nsecs:         3"
    )


def test_long_strings_are_broken_as_by_yaml() -> None:
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
def test_noarr_and_nostr_print_lengths(type_: str, length: int, value: Any, text: str) -> None:
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
def test_numbers_may_have_a_width(type_: str, value: Any, text: str) -> None:
    assert printed(type_, value, style=Style(width=5)) == text


def test_offset_is_subtracted_from_times() -> None:
    style = Style(offset=10_500_000_000)
    time = {"secs": 10, "nsecs": 0}
    assert printed("time", time, style=style) == "\n  secs: -1\n  nsecs: 500000000"
    assert printed("duration", time, style=style) == "\n  secs: 10\n  nsecs:         0"


def test_missing_fields_are_printed_with_their_defaults() -> None:
    typedefs = with_fields(("a", "int32", -1), ("b", "string", -1), ("c", "float64", 2))
    assert message_text({}, typedefs) == "a: 0\nb: ''\nc: [0.0, 0.0]"


def test_message_of_an_unknown_type_is_printed_by_its_values() -> None:
    message = {"a": 1, "b": {"c": "x", "d": None}, "e": [1, 2], "f": [{"g": True}], "h": ["i"]}
    assert message_text(message, Typedefs("unknown_msgs/Type")) == (
        'a: 1\nb: \n  c: "x"\n  d: null\ne: [1, 2]\nf: \n  - \n    g: True\nh: \n  - i'
    )


@pytest.mark.parametrize("text", TEXTS)
def test_strings_are_quoted_as_by_yaml(text: str) -> None:
    expected = yaml.safe_dump(text, default_style='"').rstrip("\n") if text else "''"
    assert quoted(text) == expected


def test_strings_are_listed_as_by_yaml() -> None:
    assert listed(["a", "b_1"], "  ") == "\n  - a\n  - b_1"
    assert listed(TEXTS, "").lstrip("\n") == yaml.safe_dump(TEXTS).rstrip("\n")
    assert listed(["yes"], " ") == "\n - 'yes'"
