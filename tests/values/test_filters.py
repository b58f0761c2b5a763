"""Conditions on messages."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import InvalidValue
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
        "m.nan != m.nan and not m.nan > 1 and not m.nan < 1",
    ],
)
def test_a_condition_that_is_met_is_no_longer_so_if_it_is_turned_around(text: str) -> None:
    assert passes(text)
    assert not passes(f"not ({text})")


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "is no condition"),
        ("m.x >", "invalid syntax"),
        ("x > 1", "no room for x"),
        ("m", "no room for m"),
        ("m > 1", "no room for m"),
        ("m['x'] > 1", r"no room for m\['x'\]"),
        ("__import__('os').system('true')", "no room for __import__"),
        ("m.x.__class__()", r"no room for m.x.__class__\(\)"),
        ("m.points[m.x]", "is no field"),
        ("m.f().x", "is no field"),
        ("[m.x for m in m]", "no room for"),
        ("lambda: 1", "no room for"),
        ("(m.x := 1)", "invalid syntax|assignment|cannot use"),
        ("2 ** 2", "no room for"),
        ("len(m.name, 1)", "no room for"),
        ("m.x if m.x else 1", "no room for"),
        ("None", "no room for"),
        ("m.x > 1\0", "null bytes"),
        ("(" * 1_000 + "1" + ")" * 1_000, "is no condition"),
        ("m" + ".x" * 50_000, "is no condition"),
    ],
)
def test_what_is_no_condition_is_wrong_usage(text: str, fault: str) -> None:
    with pytest.raises(InvalidValue, match=fault):
        Filter(text)


@pytest.mark.parametrize("text", ["m.y > 1", "m.header.x", "m.x.y", "m.points.x", "m.x[0] > 1"])
def test_fields_that_there_are_not_are_known_before_there_is_a_message(text: str) -> None:
    with pytest.raises(LookupError):
        Filter(text).check(TYPEDEFS)


def test_an_array_may_turn_out_too_short() -> None:
    with pytest.raises(LookupError, match="points has only 2 elements"):
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
def test_what_cannot_be_calculated_is_wrong_usage(text: str) -> None:
    with pytest.raises(InvalidValue, match="--filter"):
        passes(text)
