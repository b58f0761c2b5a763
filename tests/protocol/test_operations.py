"""The operations of the protocol."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, get_args

import pytest

from fibws.protocol.decoding import REPLIES, REQUESTS, parse_reply, parse_request
from fibws.protocol.operations import (
    Acknowledge,
    ActionFeedback,
    ActionResult,
    Advertise,
    AdvertiseAction,
    AdvertiseService,
    Auth,
    CallService,
    CancelActionGoal,
    ClearWill,
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
    SetWill,
    Status,
    Subscribe,
    Subscribed,
    Unadvertise,
    UnadvertiseAction,
    UnadvertiseService,
    Unsubscribe,
    encode,
    encode_fields,
    json_of,
)

VALUES = {"sum": [1, 2.5, "x", None, {"deep": {}}]}
BOTH: list[Request | Reply] = [
    CallService(service="/add"),
    CallService(id="x", service="add#77", args={"a": 1}, fragment_size=10, timeout=0.5),
    CallService(id=1, service="/add", args=[1, 2], timeout=-1),
    CallService(service="/add", headers={"user": "ann"}),
    CallService(service="/add", header={"callerid": "/caller", "user": "ann"}),
    ServiceResponse(service="/add", result=True),
    ServiceResponse(id="service_request:/add:1", service="/add", values=VALUES, result=True),
    ServiceResponse(id=1, service="/add", values="no", result=False),
    ServiceResponse(service="/add", values="no", result=False, code="unknown_service"),
    SendActionGoal(action="/fib", action_type="a/B"),
    SendActionGoal(
        id="x", action="/fib", action_type="a/B", args={"order": 5}, feedback=True, fragment_size=10
    ),
    CancelActionGoal(action="/fib"),
    CancelActionGoal(id="x", action="/fib"),
    ActionFeedback(action="/fib"),
    ActionFeedback(id="x", action="/fib", values=VALUES),
    ActionResult(action="/fib", result=False),
    ActionResult(action="/fib", values="no", result=False, code="unknown_action"),
    ActionResult(id="x", action="/fib", values=VALUES, status=6, result=True),
    Fragment(id="7", data='{"op', num=0, total=2),
    Fragment(id=7, data="", num=1, total=2),
]
"""Operations that both clients and the hub send."""
FROM_CLIENT: list[Request | Reply] = [
    *BOTH,
    Advertise(topic="/a", type="std_msgs/Int32"),
    Advertise(id="x", topic="/a", type="a/B", latch=True, queue_size=1, definition="int32 data\n"),
    Advertise(topic="/a", type="a/B", headers={"user": "ann"}, peers=True, peer_changes=True),
    Advertise(topic="/a", type="a/B", publisher=1, keep_seq=True),
    Advertise(topic="/a", type="a/B", publisher=2**32 - 1, md5sum="0" * 32),
    Unadvertise(topic="/a"),
    Unadvertise(id=1, topic="/a"),
    Publish(topic="/a"),
    Publish(id=1.5, topic="/a", msg={"data": [1, 2.5, "x", None]}, latch=True),
    Subscribe(topic="/a"),
    Publish(topic="/a", to="/listener"),
    Subscribe(topic="/a", headers=True, peers=True, peer_changes=True),
    Subscribe(topic="/a", compression="ros1", send_definition=True),
    Subscribe(topic="/a", int64="string"),
    Subscribe(topic="/a", compression="ros1", credit=2),
    Subscribe(topic="/a", compression="ros1", definition="int32 data\n", md5sum="0" * 32),
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
    Acknowledge(topic="/a"),
    Acknowledge(topic="/a", count=3),
    AdvertiseService(service="/add", type="a/B"),
    AdvertiseService(id="x", service="/add", type="a/B", definition="int32 a\n---\n"),
    AdvertiseService(service="/add", type="a/B", headers=True),
    AdvertiseService(service="/add", type="a/B", compression="ros1", md5sum="0" * 32),
    UnadvertiseService(),
    UnadvertiseService(id=1, service="/add"),
    AdvertiseAction(action="/fib", type="a/B"),
    AdvertiseAction(action="/fib", type="a/B", compression="ros1", md5sum="0,1,2"),
    AdvertiseAction(id=1, action="/fib", type="a/B", definition="---\n---\n"),
    UnadvertiseAction(action="/fib"),
    UnadvertiseAction(id=1, action="/fib"),
    Auth(),
    Auth(token="fibws_abc"),
    SetWill(topic="/a"),
    SetWill(id="x", topic="/a", type="a/B", msg={"data": 0}, timeout=0.5),
    ClearWill(topic="/a"),
    SetLevel(level="none"),
]
FROM_HUB: list[Request | Reply] = [
    *BOTH,
    Publish(topic="~a", msg={"data": 1}),
    Publish(topic="/a", header={"callerid": "/talker", "latching": "0"}),
    ServiceResponse(id=1, service="/add", result=True, header={"callerid": "/adder"}),
    Peers(topic="/a", nodes=[]),
    Peers(id="x", topic="/a", nodes=["/listener", "/talker"]),
    Peers(id="x", removed=["/talker"], added=["/listener", "/talker"]),
    Png(data="iVBORw0KGgo="),
    Status(level="error", msg="no"),
    Status(id=5, level="warning", msg="hm"),
    Status(level="error", msg="no", operation="publish:/chatter:3"),
    Status(id=5, level="error", msg="no", code="not_allowed"),
    Subscribed(topic="/a", topic_id=1, type="a/B", md5sum="0" * 32, definition="int32 data"),
    Subscribed(id="x", topic="/a", topic_id=1, type="a/B", md5sum="0" * 32),
    Subscribed(topic="/a", topic_id=1, type="a/B", md5sum="0" * 32, credit=2),
]


@pytest.mark.parametrize(
    ("operations", "parse"),
    [(FROM_CLIENT, parse_request), (FROM_HUB, parse_reply)],
    ids=["from client", "from hub"],
)
def test_every_operation_is_the_same_after_encoding_and_parsing(
    operations: list[Operation], parse: Callable[[dict[str, Any]], Operation]
) -> None:
    assert [parse(json.loads(encode(each))) for each in operations] == operations


def test_tables_have_every_operation_and_every_field() -> None:
    assert sorted({each.op for each in FROM_CLIENT}) == REQUESTS
    assert sorted({each.op for each in FROM_HUB}) == REPLIES
    for model in {*get_args(Request), *get_args(Reply)}:
        tables = [each for each in (*FROM_CLIENT, *FROM_HUB) if type(each) is model]
        given = {name for each in tables for name in each.model_fields_set}
        assert given >= model.model_fields.keys() - {"op", "id"}


def test_text_begins_with_op_and_omits_absent_fields() -> None:
    assert encode(Status(level="error", msg="no")) == b'{"op":"status","level":"error","msg":"no"}'
    assert encode(CallService(id=0, service="/a", args={})) == (
        b'{"op":"call_service","id":0,"service":"/a","args":{}}'
    )


def test_encoded_fields_are_inserted_unchanged() -> None:
    fields = {"op": "service_response", "id": None, "service": "/add", "result": True}
    assert encode_fields(fields, values=b'{"sum":9007199254740993}') == (
        b'{"op":"service_response","service":"/add","result":true,'
        b'"values":{"sum":9007199254740993}}'
    )
    assert encode_fields({"op": "x", "id": 0}) == b'{"op":"x","id":0}'


def test_nan_and_infinity_are_written_as_null() -> None:
    written = encode(Publish(topic="/a", msg={"data": [float("nan"), float("inf")]}))
    assert json.loads(written)["msg"] == {"data": [None, None]}


def test_bytes_can_be_written_as_json() -> None:
    assert json.loads(json_of({"data": b"\xff\0", "x": [b""]})).keys() == {"data", "x"}


@pytest.mark.parametrize("name", ["topic", "service", "action"])
def test_operations_are_frozen(name: str) -> None:
    for operation in (*FROM_CLIENT, *FROM_HUB):
        if hasattr(operation, name):
            with pytest.raises(ValueError, match="frozen"):
                setattr(operation, name, "/other")
