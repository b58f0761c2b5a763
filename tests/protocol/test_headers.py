"""Connection headers."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.errors import OperationError
from fibws.protocol.headers import EXPECTED, MOST_BYTES, check_headers
from fibws.protocol.operations import Advertise, Publish, encode
from fibws.protocol.parsing import parse_reply, parse_request

WRONG: dict[str, Any] = {
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
RIGHT: dict[str, dict[str, str]] = {
    "none": {},
    "one": {"user": "ann"},
    "values of any kind": {"a": "", "b": "c=d\n", "ä": "\N{ROBOT FACE}"},
    "as long as may be": {"user": "x" * (MOST_BYTES - 4)},
}


@pytest.mark.parametrize("headers", RIGHT.values(), ids=RIGHT.keys())
def test_headers_are_an_object_of_strings(headers: dict[str, str]) -> None:
    found = check_headers(headers)
    assert found == headers
    assert found is not headers
    fields = {"op": "advertise", "topic": "/a", "type": "a/B", "headers": headers}
    assert parse_request(fields) == Advertise(topic="/a", type="a/B", headers=headers)


@pytest.mark.parametrize("headers", WRONG.values(), ids=WRONG.keys())
def test_what_is_none_is_refused_by_one_clear_text(headers: Any) -> None:
    with pytest.raises(ValueError, match="headers are an object of strings, of 4096 bytes in all"):
        check_headers(headers)
    for fields in (
        {"op": "advertise", "topic": "/a", "type": "a/B"},
        {"op": "call_service", "service": "/a"},
    ):
        with pytest.raises(OperationError, match="Expected field headers to be one of ") as caught:
            parse_request({**fields, "headers": headers})
        assert EXPECTED in str(caught.value)


def test_a_program_may_have_strings_that_are_no_text() -> None:
    with pytest.raises(ValueError, match="headers are"):
        check_headers({"user": "\ud800"})
    with pytest.raises(ValueError, match="headers are"):
        check_headers({5: "x"})


@pytest.mark.parametrize("header", [{"callerid": "/talker"}, {}])
def test_a_header_of_the_hubs_is_taken_as_it_is(header: dict[str, str]) -> None:
    published = Publish(topic="/a", header=header)
    assert parse_reply(json.loads(encode(published))) == published


@pytest.mark.parametrize("header", [5, "x", [], {"callerid": None}, {"callerid": "/a", "b": 1}])
def test_what_is_no_header_counts_as_absent(header: Any) -> None:
    assert parse_reply({"op": "publish", "topic": "/a", "header": header}) == Publish(topic="/a")
