"""Exact JSON, which clients can request."""

from __future__ import annotations

import json
from math import inf, nan
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic_core import from_json

from fibws.interfaces.json_text import exact_json_of, json_of

VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.text()
    | st.floats(allow_nan=False),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=20,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ({"data": inf}, b'{"data":1e999}'),
        ([-inf, nan, 1.5], b"[-1e999,null,1.5]"),
        ({"text": "Infinity, NaN"}, b'{"text":"Infinity, NaN"}'),
        ([inf, 'a "NaN" \\', -inf], rb'[1e999,"a \"NaN\" \\",-1e999]'),
        ({"Infinity": inf, "NaN": nan}, b'{"Infinity":1e999,"NaN":null}'),
    ],
)
def test_infinity_is_written_as_a_number_above_the_float_range(value: object, text: bytes) -> None:
    assert exact_json_of(value) == text


@given(VALUES)
def test_json_parsers_read_infinity_back(value: Any) -> None:
    text = exact_json_of(value)
    assert from_json(text) == json.loads(text) == value


@given(VALUES)
def test_finite_values_are_equal_in_both_forms(value: Any) -> None:
    text = exact_json_of(value)
    if b"1e999" not in text:
        assert text == json_of(value) == exact_json_of(value, has_floats=False)
