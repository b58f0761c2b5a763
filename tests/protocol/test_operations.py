"""The operations of the protocol."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, get_args

import pytest

from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    Advertise,
    AdvertiseAction,
    AdvertiseService,
    Auth,
    CallService,
    CancelActionGoal,
    Fragment,
    Operation,
    Peers,
    Png,
    Publish,
    Reply,
    Request,
    SendActionGoal,
    ServiceResponse,
    SetLevel,
    Status,
    Subscribe,
    Unadvertise,
    UnadvertiseAction,
    UnadvertiseService,
    Unsubscribe,
    encode,
    encode_fields,
    json_of,
)
from fibws.protocol.parsing import REPLIES, REQUESTS, parse_reply, parse_request

VALUES = {"sum": [1, 2.5, "x", None, {"deep": {}}]}
ASKING: list[Request | Reply] = [
    CallService(service="/add"),
    CallService(id="x", service="add#77", args={"a": 1}, fragment_size=10, timeout=0.5),
    CallService(id=1, service="/add", args=[1, 2], timeout=-1),
    CallService(service="/add", headers={"user": "ann"}),
    CallService(service="/add", header={"callerid": "/caller", "user": "ann"}),
    ServiceResponse(service="/add", result=True),
    ServiceResponse(id="service_request:/add:1", service="/add", values=VALUES, result=True),
    ServiceResponse(id=1, service="/add", values="no", result=False),
    SendActionGoal(action="/fib", action_type="a/B"),
    SendActionGoal(
        id="x", action="/fib", action_type="a/B", args={"order": 5}, feedback=True, fragment_size=10
    ),
    CancelActionGoal(action="/fib"),
    CancelActionGoal(id="x", action="/fib"),
    ActionFeedback(action="/fib"),
    ActionFeedback(id="x", action="/fib", values=VALUES),
    ActionResult(action="/fib", result=False),
    ActionResult(id="x", action="/fib", values=VALUES, status=6, result=True),
    Fragment(id="7", data='{"op', num=0, total=2),
    Fragment(id=7, data="", num=1, total=2),
]
"""What either end may send."""
SENT: list[Request | Reply] = [
    *ASKING,
    Advertise(topic="/a", type="std_msgs/Int32"),
    Advertise(id="x", topic="/a", type="a/B", latch=True, queue_size=1, definition="int32 data\n"),
    Advertise(topic="/a", type="a/B", headers={"user": "ann"}, peers=True),
    Unadvertise(topic="/a"),
    Unadvertise(id=1, topic="/a"),
    Publish(topic="/a"),
    Publish(id=1.5, topic="/a", msg={"data": [1, 2.5, "x", None]}, latch=True),
    Subscribe(topic="/a"),
    Publish(topic="/a", to="/listener"),
    Subscribe(topic="/a", headers=True, peers=True),
    Subscribe(
        id="",
        topic="/a",
        type="a/B",
        throttle_rate=12.5,
        queue_length=3,
        fragment_size=2147483647,
        compression="png",
    ),
    Unsubscribe(topic="/a"),
    Unsubscribe(id=0, topic="/a"),
    AdvertiseService(service="/add", type="a/B"),
    AdvertiseService(id="x", service="/add", type="a/B", definition="int32 a\n---\n"),
    AdvertiseService(service="/add", type="a/B", headers=True),
    UnadvertiseService(),
    UnadvertiseService(id=1, service="/add"),
    AdvertiseAction(action="/fib", type="a/B"),
    AdvertiseAction(id=1, action="/fib", type="a/B", definition="---\n---\n"),
    UnadvertiseAction(action="/fib"),
    UnadvertiseAction(id=1, action="/fib"),
    Auth(),
    SetLevel(level="none"),
]
HEARD: list[Request | Reply] = [
    *ASKING,
    Publish(topic="~a", msg={"data": 1}),
    Publish(topic="/a", header={"callerid": "/talker", "latching": "0"}),
    Peers(topic="/a", nodes=[]),
    Peers(id="x", topic="/a", nodes=["/listener", "/talker"]),
    Png(data="iVBORw0KGgo="),
    Status(level="error", msg="no"),
    Status(id=5, level="warning", msg="hm"),
]


@pytest.mark.parametrize(
    ("operations", "parse"), [(SENT, parse_request), (HEARD, parse_reply)], ids=["sent", "heard"]
)
def test_every_operation_is_read_as_it_was_written(
    operations: list[Operation], parse: Callable[[dict[str, Any]], Operation]
) -> None:
    assert [parse(json.loads(encode(each))) for each in operations] == operations


def test_the_tables_above_have_every_operation_and_every_field() -> None:
    assert sorted({each.op for each in SENT}) == REQUESTS
    assert sorted({each.op for each in HEARD}) == REPLIES
    for model in {*get_args(Request), *get_args(Reply)}:
        tables = [each for each in (*SENT, *HEARD) if type(each) is model]
        given = {name for each in tables for name in each.model_fields_set}
        assert given >= model.model_fields.keys() - {"op", "id"}


def test_the_text_begins_with_the_operation_and_leaves_out_what_is_not_there() -> None:
    assert encode(Status(level="error", msg="no")) == b'{"op":"status","level":"error","msg":"no"}'
    assert encode(CallService(id=0, service="/a", args={})) == (
        b'{"op":"call_service","id":0,"service":"/a","args":{}}'
    )


def test_text_that_is_at_hand_is_put_in_as_it_is() -> None:
    fields = {"op": "service_response", "id": None, "service": "/add", "result": True}
    assert encode_fields(fields, values=b'{"sum":9007199254740993}') == (
        b'{"op":"service_response","service":"/add","result":true,'
        b'"values":{"sum":9007199254740993}}'
    )
    assert encode_fields({"op": "x", "id": 0}) == b'{"op":"x","id":0}'


def test_numbers_that_json_does_not_have_are_written_as_null() -> None:
    written = encode(Publish(topic="/a", msg={"data": [float("nan"), float("inf")]}))
    assert json.loads(written)["msg"] == {"data": [None, None]}


def test_bytes_are_no_error_in_json() -> None:
    assert json.loads(json_of({"data": b"\xff\0", "x": [b""]})).keys() == {"data", "x"}


@pytest.mark.parametrize("name", ["topic", "service", "action"])
def test_an_operation_is_never_changed(name: str) -> None:
    for operation in (*SENT, *HEARD):
        if hasattr(operation, name):
            with pytest.raises(ValueError, match="frozen"):
                setattr(operation, name, "/other")
