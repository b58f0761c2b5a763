"""The bounds for the values of one operation."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import cbor2
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fibws.errors import OperationError
from fibws.protocol import value_limits
from fibws.protocol.decoding import decode_cbor
from fibws.protocol.value_limits import (
    MOST_CONTAINERS,
    MOST_MEMBERS,
    MOST_VALUES,
    check_cbor,
    check_json,
)

KINDS = {
    "values": MOST_VALUES,
    "arrays and objects": MOST_CONTAINERS,
    "members of objects": MOST_MEMBERS,
}


@pytest.mark.parametrize(
    ("unit", "count", "kind"),
    [
        (b"0,", MOST_VALUES, "values"),
        (b'"",', MOST_VALUES, "values"),
        (b"[],", MOST_CONTAINERS, "arrays and objects"),
        (b"{},", MOST_CONTAINERS, "arrays and objects"),
        (b'{"a":0,"b":0,"c":0},', MOST_MEMBERS // 3 + 1, "members of objects"),
    ],
)
@pytest.mark.parametrize("front", [b"", b"{}", b'{"op":"fly"}'])
def test_json_with_too_many_values_is_refused(
    front: bytes, unit: bytes, count: int, kind: str
) -> None:
    with pytest.raises(OperationError, match=rf"too many {kind} .*limit is {KINDS[kind]}\)"):
        check_json(front + b'{"data":[' + unit * count + b"0]}")


@pytest.mark.parametrize(
    ("unit", "count"),
    [
        (b"0,", MOST_VALUES - 3),
        (b"[],", MOST_CONTAINERS - 2),
        (b'{"a":0,"b":0,"c":0},', MOST_MEMBERS // 3 - 1),
    ],
)
def test_json_at_the_bound_is_accepted(unit: bytes, count: int) -> None:
    check_json(b'{"data":[' + unit * count + b"0]}")


@pytest.mark.parametrize("unit", [b",[{:", rb"{\"a\":1},", b"\\\\\\\\,,,,", rb"\\\"[[[["])
def test_separators_within_strings_do_not_count(unit: bytes) -> None:
    check_json(b'{"data":"' + unit * MOST_VALUES + b'"}')


def test_text_that_is_nothing_but_strings_is_refused() -> None:
    with pytest.raises(OperationError, match="too many values"):
        check_json(b'{"data":"' + b"," * MOST_VALUES + b'"' + b'""' * (MOST_VALUES + 1))


@pytest.mark.parametrize(
    ("unit", "count", "kind"),
    [
        (b"\x00", MOST_VALUES, "values"),
        (b"\x60", MOST_VALUES, "values"),
        (b"\x80", MOST_CONTAINERS, "arrays and objects"),
        (b"\xa0", MOST_CONTAINERS, "arrays and objects"),
        (b"\x9f\xff", MOST_CONTAINERS, "arrays and objects"),
        (b"\xa3\x61a\x00\x61b\x00\x61c\x00", MOST_MEMBERS // 3 + 1, "members of objects"),
        (b"\xb8\x03\x61a\x00\x61b\x00\x61c\x00", MOST_MEMBERS // 3 + 1, "members of objects"),
        (b"\xbf" + b"\x61a\x00" * 3 + b"\xff", MOST_MEMBERS // 3 + 1, "members of objects"),
        (b"\xd8\x56\x5a\x00\x00\x80\x00" + bytes(2**15), MOST_VALUES // 2**12, "values"),
    ],
)
def test_cbor_with_too_many_values_is_refused(unit: bytes, count: int, kind: str) -> None:
    with pytest.raises(OperationError, match=rf"too many {kind} .*limit is {KINDS[kind]}\)"):
        decode_cbor(b"\xa1\x61a\x9f" + unit * count + b"\xff")


@pytest.mark.parametrize(
    ("unit", "count"),
    [
        (b"\x00", MOST_VALUES - 4),
        (b"\x80", MOST_CONTAINERS - 2),
        (b"\xa3\x61a\x00\x61b\x00\x61c\x00", MOST_MEMBERS // 3 - 1),
        (b"\xd8\x55\x5a\x00\x00\x80\x00" + b"\x80" * 2**15, MOST_VALUES // 2**14),
    ],
)
def test_cbor_at_the_bound_is_accepted(unit: bytes, count: int) -> None:
    check_cbor(b"\xa1\x61a\x9f" + unit * count + b"\xff")


@pytest.mark.parametrize("head", [b"\x5a", b"\x7a", b"\xd8\x40\x5a", b"\xd8\x44\x5a"])
def test_long_strings_in_cbor_are_one_value(head: bytes) -> None:
    check_cbor(b"\xa1\x61a" + head + b"\x00\x80\x00\x00" + b"\x80" * 2**23)


# Small bounds, which random values reach.

VALUES = st.recursive(
    st.integers(-10, 1000)
    | st.floats()
    | st.booleans()
    | st.none()
    | st.text(r'a,:[{"\ä', max_size=5),
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=30,
)


def _walk(value: Any) -> Iterator[Any]:
    yield value
    if isinstance(value, list | dict):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _walk(each)


@pytest.fixture
def small_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FEWEST_BYTES", "_FEWEST_CBOR"):
        monkeypatch.setattr(value_limits, name, 0)
    monkeypatch.setattr(value_limits, "_SLICE", 7)
    monkeypatch.setattr(value_limits, "MOST_VALUES", 20)
    monkeypatch.setattr(value_limits, "MOST_CONTAINERS", 6)
    monkeypatch.setattr(value_limits, "MOST_MEMBERS", 8)


@pytest.mark.usefixtures("small_bounds")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.dictionaries(st.text(max_size=3), VALUES), st.booleans())
def test_values_are_counted_as_they_are(value: dict[str, Any], ascii_only: bool) -> None:
    everything = list(_walk(value))
    containers = [each for each in everything if isinstance(each, list | dict)]
    members = sum(len(each) for each in containers if isinstance(each, dict))
    few = len(containers) <= 6 and members <= 8
    empty = sum(not each for each in containers)
    # The separators count one value for each empty array, and none for the text as a whole.
    in_json = len(everything) - 1 + empty
    keys = members  # which are values in CBOR
    text = json.dumps(value, ensure_ascii=ascii_only).encode()
    assert _accepted(check_json, text) == (few and in_json <= 20)
    assert _accepted(check_cbor, cbor2.dumps(value)) == (few and len(everything) + keys <= 20)


def _accepted(check: Any, data: bytes) -> bool:
    try:
        check(data)
    except OperationError:
        return False
    return True
