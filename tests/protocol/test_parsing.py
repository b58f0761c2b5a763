"""From JSON objects to operations."""

from __future__ import annotations

import json
from typing import Any, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import OperationError
from fibws.protocol.operations import LONGEST_ID, Request, Status, Subscribe, encode
from fibws.protocol.parsing import REPLIES, REQUESTS, parse_reply, parse_request, quoted

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)
FIELDS = {name for model in get_args(Request) for name in model.model_fields}


def test_what_is_absent_has_its_default() -> None:
    read = parse_request({"op": "subscribe", "topic": "/a"})
    assert read == Subscribe(
        id=None,
        topic="/a",
        type=None,
        throttle_rate=0,
        queue_length=0,
        fragment_size=None,
        compression="none",
    )


@pytest.mark.parametrize("field", sorted(Subscribe.model_fields.keys() - {"op", "topic"}))
def test_what_is_null_counts_as_absent(field: str) -> None:
    absent = {"op": "subscribe", "topic": "/a"}
    assert parse_request({**absent, field: None}) == parse_request(absent)


def test_a_required_field_that_is_null_is_missing() -> None:
    with pytest.raises(OperationError, match="Expected a topic field but none was"):
        parse_request({"op": "subscribe", "topic": None})


def test_unknown_fields_are_ignored() -> None:
    known = {"op": "publish", "topic": "/a", "msg": {}}
    assert parse_request({**known, "type": "a/B", "queue_size": "many"}) == parse_request(known)


@pytest.mark.parametrize("id_", ["subscribe:/t:1", "", "5", 5, 0, -1, 2**70, 1.5, True, False])
def test_an_id_is_given_back_as_it_was_sent(id_: object) -> None:
    request = parse_request({"op": "unsubscribe", "topic": "/a", "id": id_})
    answer = json.loads(encode(Status(id=request.id, level="info", msg="")))["id"]
    assert (answer, type(answer)) == (id_, type(id_))


def test_an_id_is_of_a_length_that_may_be_kept() -> None:
    fields = {"op": "unsubscribe", "topic": "/a"}
    assert parse_request({**fields, "id": "x" * LONGEST_ID}).id == "x" * LONGEST_ID
    with pytest.raises(OperationError, match="Expected field id to be one of") as caught:
        parse_request({**fields, "id": "x" * (LONGEST_ID + 1)})
    assert str(LONGEST_ID) in str(caught.value)


NO_OP = (
    "Received a message without an op.  "
    f"All messages require 'op' field with value one of: {REQUESTS}.  "
    "Original message was: "
)


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({}, NO_OP + "{}"),
        ({"a": 1, "op": None}, NO_OP + '{"a":1}'),
        ({"op": 5}, NO_OP + '{"op":5}'),
        ({"op": ["publish"]}, NO_OP + '{"op":["publish"]}'),
        ({"op": "fly"}, f"Unknown operation: fly.  Allowed operations: {REQUESTS}"),
        ({"op": "status"}, f"Unknown operation: status.  Allowed operations: {REQUESTS}"),
        ({"op": "publish"}, "Expected a topic field but none was found."),
        (
            {"op": "advertise", "topic": "/a"},
            "Expected a type field but none was found.",
        ),
        (
            {"op": "publish", "topic": 5},
            "Expected field topic to be one of str. Invalid value: 5",
        ),
        (
            {"op": "advertise", "topic": "/a", "type": "a/B", "latch": "yes"},
            'Expected field latch to be one of bool. Invalid value: "yes"',
        ),
        (
            {"op": "subscribe", "topic": "/a", "queue_length": 1.5},
            "Expected field queue_length to be one of int. Invalid value: 1.5",
        ),
        (
            {"op": "subscribe", "topic": "/a", "queue_length": "1"},
            'Expected field queue_length to be one of int. Invalid value: "1"',
        ),
        (
            {"op": "subscribe", "topic": "/a", "throttle_rate": "1"},
            'Expected field throttle_rate to be one of int, float. Invalid value: "1"',
        ),
        (
            {"op": "subscribe", "topic": "/a", "throttle_rate": float("nan")},
            "Expected field throttle_rate to be one of a finite number. Invalid value: NaN",
        ),
        (
            {"op": "unsubscribe", "topic": "/a", "id": [1]},
            "Expected field id to be one of str, int. Invalid value: [1]",
        ),
        (
            {"op": "fragment", "id": {}, "data": "", "num": 0, "total": 1},
            "Expected field id to be one of str, int. Invalid value: {}",
        ),
        (
            {"op": "set_level", "level": "loud"},
            "Expected field level to be one of "
            "'error', 'warning', 'info' or 'none'. Invalid value: \"loud\"",
        ),
    ],
)
def test_a_wrong_operation_is_refused_in_the_real_servers_words(
    fields: dict[str, Any], text: str
) -> None:
    with pytest.raises(OperationError) as caught:
        parse_request(fields)
    assert str(caught.value) == text


def test_a_wrong_reply_is_refused_too() -> None:
    with pytest.raises(OperationError) as caught:
        parse_reply({"op": "subscribe", "topic": "/a"})
    assert str(caught.value) == f"Unknown operation: subscribe.  Allowed operations: {REPLIES}"


@pytest.mark.parametrize(
    "fields",
    [
        {"a": "x" * 10_000},
        {"op": "publish", "topic": ["x"] * 10_000},
    ],
    ids=["no operation", "field"],
)
def test_an_error_repeats_only_the_beginning_of_what_is_wrong(fields: dict[str, Any]) -> None:
    with pytest.raises(OperationError) as caught:
        parse_request(fields)
    assert len(str(caught.value)) < 700


def test_a_short_value_is_quoted_whole_and_a_long_one_cut() -> None:
    assert quoted(["ä", 1]) == '["ä",1]'
    assert quoted("x" * 300) == '"' + "x" * 199 + "..."


@given(
    st.dictionaries(st.sampled_from(sorted(FIELDS)) | st.text(max_size=3), JSON, max_size=6),
    st.sampled_from([*REQUESTS, "fly"]) | JSON,
)
def test_whatever_the_fields_nothing_else_is_raised(fields: dict[str, Any], op: object) -> None:
    try:
        request = parse_request({**fields, "op": op})
    except OperationError:
        return
    assert request.op == op
