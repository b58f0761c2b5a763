"""Connection headers."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.errors import OperationError
from fibws.protocol.decoding import parse_reply, parse_request
from fibws.protocol.headers import EXPECTED, MOST_BYTES, check_headers
from fibws.protocol.operations import Advertise, Publish, encode

INVALID: dict[str, Any] = {
    "text": "user=ann",
    "list": ["user", "ann"],
    "number as value": {"age": 5},
    "null as value": {"age": None},
    "object as value": {"user": {}},
    "empty name": {"": "x"},
    "name with =": {"a=b": "c"},
    "too long": {"user": "x" * (MOST_BYTES - 3)},
    "too many": {str(number): "" for number in range(2000)},
    "too long in UTF-8": {"user": "ä" * (MOST_BYTES // 2)},
}
VALID: dict[str, dict[str, str]] = {
    "none": {},
    "one": {"user": "ann"},
    "any text as value": {"a": "", "b": "c=d\n", "ä": "\N{ROBOT FACE}"},
    "at the size limit": {"user": "x" * (MOST_BYTES - 4)},
}


@pytest.mark.parametrize("headers", VALID.values(), ids=VALID.keys())
def test_object_of_strings_is_a_valid_header(headers: dict[str, str]) -> None:
    found = check_headers(headers)
    assert found == headers
    assert found is not headers
    fields = {"op": "advertise", "topic": "/a", "type": "a/B", "headers": headers}
    assert parse_request(fields) == Advertise(topic="/a", type="a/B", headers=headers)


@pytest.mark.parametrize("headers", INVALID.values(), ids=INVALID.keys())
def test_invalid_header_is_refused_with_the_rule(headers: Any) -> None:
    with pytest.raises(
        ValueError, match=r"headers must be an object of strings .* at most 4096 bytes"
    ):
        check_headers(headers)
    for fields in (
        {"op": "advertise", "topic": "/a", "type": "a/B"},
        {"op": "call_service", "service": "/a"},
    ):
        with pytest.raises(OperationError, match="Expected field headers to be one of ") as caught:
            parse_request({**fields, "headers": headers})
        assert EXPECTED in str(caught.value)


def test_lone_surrogates_and_other_names_are_refused() -> None:
    with pytest.raises(ValueError, match="headers must be"):
        check_headers({"user": "\ud800"})
    with pytest.raises(ValueError, match="headers must be"):
        check_headers({5: "x"})


@pytest.mark.parametrize("header", [{"callerid": "/talker"}, {}])
def test_header_of_the_hub_is_read(header: dict[str, str]) -> None:
    published = Publish(topic="/a", header=header)
    assert parse_reply(json.loads(encode(published))) == published


@pytest.mark.parametrize("header", [5, "x", [], {"callerid": None}, {"callerid": "/a", "b": 1}])
def test_invalid_header_of_the_hub_counts_as_absent(header: Any) -> None:
    assert parse_reply({"op": "publish", "topic": "/a", "header": header}) == Publish(topic="/a")
