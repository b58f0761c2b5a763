"""Texts as values."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from fibws.ros1.launch.value import boolean, convert


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
def test_a_text_is_what_it_looks_like(text: str, value: object) -> None:
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
def test_a_text_has_the_type_that_is_named(text: str, type_: str, value: Any) -> None:
    found = convert(text, type_, yaml.safe_load)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "type_", "error"),
    [
        ("1.5", "int", "'1.5' is no int"),
        ("x", "double", "'x' is no double"),
        ("yes", "bool", "'yes' is neither true nor false"),
        ("1", "float", "there is no type 'float': did you mean double?"),
        ("1", "intt", "there is no type 'intt': did you mean int?"),
        ("1", "qqq", "there is no type 'qqq': it is one of auto, str"),
    ],
)
def test_a_text_that_is_none_of_its_type_is_an_error(text: str, type_: str, error: str) -> None:
    with pytest.raises(ValueError, match=error.replace("[", r"\[")):
        convert(text, type_, yaml.safe_load)


def test_a_bool_is_said_in_four_ways() -> None:
    assert [boolean(text) for text in ("true", "1", "False", "0 ")] == [True, True, False, False]
