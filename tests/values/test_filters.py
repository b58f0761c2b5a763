"""Conditions on messages."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import InvalidValue, UnknownField
from fibws.values.filters import Filter
from fibws.values.typedefs import Typedefs

HEADER = {"header": {"seq": 7, "stamp": {"secs": 5, "nsecs": 9}, "frame_id": "map"}}
MESSAGE = {**HEADER, "x": 1.5, "nan": None, "name": "two words", "on": True, "data": "AQID"} | {
    "points": [{"x": 1.0}, {"x": 2.0}]
}


def typedef(type_: str, **fields: str) -> dict[str, Any]:
    return {
        "type": type_,
        "fieldnames": [*fields],
        "fieldtypes": [each.removesuffix("[]") for each in fields.values()],
        "fieldarraylen": [0 if each.endswith("[]") else -1 for each in fields.values()],
        "constnames": [],
        "constvalues": [],
    }


FIELDS = {"header": "std_msgs/Header", "x": "float64", "nan": "float64", "name": "string"}
TYPEDEFS = Typedefs(
    "my_msgs/Mine",
    [
        typedef("my_msgs/Mine", **FIELDS, on="bool", data="uint8[]", points="my_msgs/Point[]"),
        typedef("std_msgs/Header", seq="uint32", stamp="time", frame_id="string"),
        typedef("my_msgs/Point", x="float64"),
    ],
)


def passes(text: str) -> bool:
    filter_ = Filter(text)
    filter_.check(TYPEDEFS)
    return filter_.passes(MESSAGE, TYPEDEFS)


@pytest.mark.parametrize(
    "text",
    [
        "m.x > 1",
        " m.x == 1.5 ",
        "0 < m.x <= 1.5 < 2",
        "not m.x > 2 and m.on",
        "m.x > 2 or m.name == 'two words'",
        "'words' in m.name and 'x' not in m.name",
        "m.header.frame_id in ['map', 'odom']",
        "m.header.stamp.secs * 10 + m.header.seq == 57",
        "-m.x == -3 / 2 and abs(m.x - 2) < 1",
        "m.header.seq % 2",
        "m.data[1] == 2 and m.data[-1] == 3 and len(m.data) == 3",
        "m.points[0].x < m.points[1].x and len(m.points[0:1]) == 1",
        "m.header.seq ** 2 == 49 and m.header.seq & 4",
        "m.name.startswith('two') and max(m.x, 1) == m.x",
        "m.data == [1, 2, 3]",
        "len(m.points) < 2 or m.points[1].x == 2",
        "m.nan != m.nan and not m.nan > 1 and not m.nan < 1",
    ],
)
def test_conditions_that_are_met(text: str) -> None:
    assert passes(text)
    assert not passes(f"not ({text})")


@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("", "syntax"),
        ("m.x >", "syntax"),
        ("x > 1", "name x"),
        ("m", "name m"),
        ("m > 1", "name m"),
        ("m['x'] > 1", "name m"),
        ("__import__('os').system('true')", "system"),
        ("m.x.__class__()", "__class__"),
        ("m.points[m.x]", "points"),
        ("m.f().x", "f"),
        ("[m.x for m in m]", "for m in m"),
        ("lambda: 1", "lambda"),
        ("(m.x := 1)", "m.x"),
        ("m.x > 1\0", "null"),
        ("(" * 1_000 + "1" + ")" * 1_000, "--filter"),
        ("m" + ".x" * 50_000, "limit: 10000"),
        ("m" + ".x" * 4_000, "nested"),
    ],
)
def test_invalid_conditions_are_refused(text: str, fact: str) -> None:
    with pytest.raises(InvalidValue, match=fact):
        Filter(text)


@pytest.mark.parametrize("text", ["m.y > 1", "m.header.x", "m.x.y", "m.points.x", "m.x[0] > 1"])
def test_unknown_fields_are_found_before_the_first_message(text: str) -> None:
    with pytest.raises(UnknownField):
        Filter(text).check(TYPEDEFS)


def test_array_that_is_too_short_is_an_unknown_field() -> None:
    with pytest.raises(UnknownField, match=r"points.*2"):
        passes("m.points[5].x > 1")


@pytest.mark.parametrize(
    "text",
    [
        "m.name > 1",
        "m.x / 0 > 1",
        "len(m.x)",
        "m.x in 1",
        "-" * 900 + "m.x",
        "m.name * 99999999999999 == ''",
        "(1, 2) * 99999999999999",
        "'%99999999999999d' % 5 == m.name",
    ],
)
def test_conditions_that_cannot_be_evaluated_are_invalid(text: str) -> None:
    with pytest.raises(InvalidValue, match="--filter"):
        passes(text)
