"""JSON text to operations' fields."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import InvalidUtf8, OperationError
from fibws.protocol.text import objects

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)
OBJECTS = st.lists(st.dictionaries(st.text(), JSON, max_size=3), max_size=4)
SPACE = st.text(" \t\r\n", max_size=3)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (b'{"op":"x"}', [{"op": "x"}]),
        (b' {"a":1} ', [{"a": 1}]),
        (b'{"a":1}{"b":2}', [{"a": 1}, {"b": 2}]),
        (b'\n{"a":{"b":[]}} \t\r\n {"b":"}{"} ', [{"a": {"b": []}}, {"b": "}{"}]),
        (b"{}{}{}", [{}, {}, {}]),
        ('{"ä":"\N{ROBOT FACE}"}{}'.encode(), [{"ä": "\N{ROBOT FACE}"}, {}]),
        (b'{"a":18446744073709551616}', [{"a": 2**64}]),
    ],
)
def test_objects_stand_one_behind_another(text: bytes, found: list[dict[str, Any]]) -> None:
    assert list(objects(text)) == found


@pytest.mark.parametrize("text", [b"", b" ", b"\r\n\t "])
def test_an_empty_text_asks_for_nothing(text: bytes) -> None:
    assert list(objects(text)) == []


@pytest.mark.parametrize("value", [b"1", b"true", b"null", b'"a"', b'[{"op":"x"}]', b"NaN"])
def test_what_is_no_object_is_refused(value: bytes) -> None:
    with pytest.raises(OperationError, match=r"Expected a JSON object\. Original message was"):
        list(objects(value))


@pytest.mark.parametrize(
    "text",
    [b"{", b'{"a":}', b"x", b"{'a':1}", b"{]", b'{"a":1,}', b"\xef\xbb\xbf{}", b"[" * 100_000],
)
def test_what_is_no_json_is_refused(text: bytes) -> None:
    with pytest.raises(OperationError, match="Expected JSON objects"):
        list(objects(text))


@pytest.mark.parametrize("garbage", [b"x", b'{"c"', b"3", b"[]", b"\x00"])
def test_the_objects_before_garbage_count(garbage: bytes) -> None:
    found = iter(objects(b'{"a":1} {"b":2} ' + garbage))
    assert [next(found), next(found)] == [{"a": 1}, {"b": 2}]
    with pytest.raises(OperationError):
        next(found)


@pytest.mark.parametrize("text", [b"\xff", b'{"a":"\xff"}', b"{}\xff", b'{"a":"\xed\xa0\x80"}'])
def test_bytes_that_are_not_utf8_are_no_text(text: bytes) -> None:
    with pytest.raises(InvalidUtf8):
        list(objects(text))


@pytest.mark.parametrize("text", [rb'{"a":"\ud800"}', rb'{}{"a":"\udc00"}'])
def test_half_of_a_surrogate_pair_is_refused(text: bytes) -> None:
    with pytest.raises(OperationError):
        list(objects(text))


def test_a_whole_surrogate_pair_is_one_character() -> None:
    assert list(objects(rb'{"a":"\ud83e\udd16"}')) == [{"a": "\N{ROBOT FACE}"}]


def test_numbers_that_python_writes_but_json_does_not_have_are_read() -> None:
    [found] = objects(b'{"a":NaN,"b":Infinity,"c":-Infinity,"d":1e400}')
    assert math.isnan(found["a"])
    assert (found["b"], found["c"], found["d"]) == (math.inf, -math.inf, math.inf)


@pytest.mark.parametrize("deep", [b'{"a":%b1%b}' % (b"[" * 150, b"]" * 150)])
def test_nesting_may_be_deep(deep: bytes) -> None:
    assert len(list(objects(deep + deep))) == 2


@pytest.mark.parametrize("depth", [300, 5_000, 100_000])
@pytest.mark.parametrize("before", [b"", b"{}"])
def test_nesting_may_not_be_deeper_than_the_stack(depth: int, before: bytes) -> None:
    with pytest.raises(OperationError):
        list(objects(before + b'{"a":' + b"[" * depth + b"]" * depth + b"}"))


def test_an_error_repeats_only_the_beginning_of_a_long_text() -> None:
    with pytest.raises(OperationError) as caught:
        list(objects(b"x" * 10_000))
    assert len(str(caught.value)) < 400


@given(OBJECTS, SPACE)
def test_any_objects_are_read_however_far_they_stand_apart(
    values: list[dict[str, Any]], space: str
) -> None:
    text = space.join(["", *map(json.dumps, values), ""])
    assert list(objects(text.encode("utf-8"))) == values


@given(st.binary() | st.text().map(str.encode) | st.text('{}[]":,0e-\\ud8a ').map(str.encode))
def test_whatever_the_bytes_nothing_else_is_raised(text: bytes) -> None:
    try:
        assert all(isinstance(each, dict) for each in objects(text))
    except (OperationError, InvalidUtf8):
        pass
