"""Operations that come in binary frames: JSON text, or CBOR."""

from __future__ import annotations

import json
from base64 import b64encode
from struct import pack
from typing import Any

import cbor2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ..fakes import INT32, Client, FakeHub, number, talker_and_listener
from .action_clients import received_goals, server_and_client
from .service_clients import (
    adder_and_caller,
    call_add,
    received_call,
    received_failure,
    received_sums,
)

PUBLISH = {"op": "publish", "topic": "/fib", "msg": {"data": 8}}


def send_cbor(client: Client, **fields: Any) -> None:
    client.send_binary(cbor2.dumps(fields))


@pytest.mark.parametrize(
    "data",
    [
        json.dumps(PUBLISH).encode(),
        b" \n" + json.dumps(PUBLISH).encode(),
        cbor2.dumps(PUBLISH),
        cbor2.dumps({**PUBLISH, "id": "\N{ROBOT FACE}" * 100}),
        b"\xd9\xd9\xf7" + cbor2.dumps(PUBLISH),
    ],
)
def test_operation_may_come_as_text_or_as_cbor(data: bytes) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send_binary(data)
    assert listener.receive_numbers("/fib") == [8]
    assert talker.receive() == []


def test_one_binary_message_may_hold_several_json_operations() -> None:
    client = FakeHub().client()
    client.send_binary(
        b'{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}'
        b'{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a"}'
    )
    assert client.receive_numbers("/a") == [0]


@pytest.mark.parametrize(
    "data",
    [
        b"\xff",
        b"\x80",
        b"\xa1",
        b"\xa1\x61a",
        bytes(range(128, 256)),
        b"\x89PNG\r\n\x1a\n",
        cbor2.dumps([PUBLISH]) + b"\xff",
        cbor2.dumps([b"\xff"]),
        cbor2.dumps(b"\xff"),
        cbor2.dumps({**PUBLISH, "id": b"\xff"}) + b"more",
        cbor2.dumps({"op": "publish", b"\xff": 1}),
        b"\xbb" + b"\xff" * 8,
        b"\x9b" + b"\xff" * 8,
        b"\xdb" + b"\xff" * 9,
        b"\x81" * 100_000,
        b"\xa1\x61a" * 100_000,
        b"\xc1" * 100_000,
    ],
    ids=lambda data: f"{data[:8].hex()}*{len(data)}",
)
def test_binary_that_is_neither_json_nor_cbor_is_refused(data: bytes) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send_binary(data)
    [status] = talker.receive()
    assert (status["op"], status["level"]) == ("status", "error")
    assert len(status["msg"]) < 2000
    talker.send_binary(cbor2.dumps(PUBLISH))
    assert listener.receive_numbers("/fib") == [8]


@pytest.mark.parametrize(
    "data",
    [pack("<3i", 1, 2, 3), cbor2.CBORTag(78, pack("<3i", 1, 2, 3)), [1, 2, 3]],
    ids=["bytes", "typed array", "list"],
)
def test_arrays_may_be_typed(data: object) -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type="std_msgs/Int32MultiArray")
    client.send("subscribe", "/a")
    send_cbor(client, op="publish", topic="/a", msg={"data": data}, id=b"\xff" * 3)
    received = client.receive()[0]
    if isinstance(data, bytes):
        assert "for field data, but got a bytes" in received["msg"]
    else:
        assert received["msg"]["data"] == [1, 2, 3]


def test_byte_strings_are_accepted_for_uint8_arrays() -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type="sensor_msgs/CompressedImage")
    client.send("subscribe", "/a")
    send_cbor(client, op="publish", topic="/a", msg={"data": b"\xff\0\1\2"})
    [msg] = client.receive_messages("/a")
    assert msg["data"] == "/wABAg=="


def test_calls_and_goals_may_come_as_cbor_too() -> None:
    _, service_server, caller = adder_and_caller()
    send_cbor(caller, op="call_service", service="/add", args=[1, 2], id=b"", type="\xff")
    assert len(caller.receive_statuses()) == 1
    send_cbor(caller, op="call_service", service="/add", args=[1, 2], id="x", type="\xff")
    id_ = received_call(service_server)
    values = {"sum": 3}
    send_cbor(
        service_server, op="service_response", service="/add", id=id_, values=values, result=True
    )
    assert received_sums(caller) == [3]
    _, action_server, client = server_and_client()
    send_cbor(
        client,
        op="send_action_goal",
        action="/fib",
        action_type="example_interfaces/Fibonacci",
        args={"order": 5},
    )
    assert len(received_goals(action_server)) == 1


# Bytes where they have no place.

WRONG = [b"\xff", b"text", [b"\xff"], {"deep": [b"\xff"]}]


@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize("field", ["op", "topic", "type", "latch", "level", "fragment_size"])
def test_bytes_in_a_field_are_refused_by_its_name(field: str, value: object) -> None:
    hub = FakeHub()
    client = hub.client()
    fields: dict[str, Any] = {"op": "subscribe", "topic": "/a", "x": b"\xff"}
    if field == "latch":
        fields = {**fields, "op": "advertise", "type": INT32}
    elif field == "level":
        fields["op"] = "set_level"
    send_cbor(client, **{**fields, field: value})
    [status] = client.receive_statuses()
    assert field in status
    assert hub.graph.topics == {}


@pytest.mark.parametrize("value", WRONG)
def test_id_of_bytes_is_ignored(value: object) -> None:
    client = FakeHub().client()
    send_cbor(client, op="fly", id=value)
    assert "id" not in client.receive_one("status")


@pytest.mark.parametrize("value", WRONG)
def test_messages_of_an_unknown_type_may_hold_bytes(value: object) -> None:
    hub = FakeHub()
    talker, listener, binary, late = (hub.client() for _ in range(4))
    talker.send("advertise", "/a", type="my_msgs/Thing", latch=True)
    listener.send("subscribe", "/a")
    binary.send("subscribe", "/a", compression="cbor")
    send_cbor(talker, op="publish", topic="/a", msg={"any": value}, x=b"\xff")
    late.send("subscribe", "/a")
    assert (
        listener.receive_messages("/a") == late.receive_messages("/a") == [{"any": as_json(value)}]
    )
    assert [each["msg"] for each in binary.receive_cbor()] == [{"any": as_json(value)}]
    assert talker.receive() == []


def as_json(value: object) -> object:
    """Bytes in JSON are base64."""
    if isinstance(value, bytes):
        return b64encode(value).decode()
    if isinstance(value, list):
        return [as_json(each) for each in value]
    if isinstance(value, dict):
        return {name: as_json(each) for name, each in value.items()}
    return value


@pytest.mark.parametrize("value", WRONG)
def test_calls_and_goals_of_an_unknown_type_may_hold_bytes(value: object) -> None:
    hub = FakeHub()
    service_server, caller = hub.client(), hub.client()
    service_server.send("advertise_service", service="/do", type="my_srvs/Do")
    service_server.send("advertise_action", action="/do", type="my_actions/Do")
    asking = {"service": "/do", "action": "/do", "args": {"any": value}, "x": b"\xff"}
    send_cbor(caller, op="call_service", **asking)
    send_cbor(caller, op="send_action_goal", action_type="my_actions/Do", **asking)
    ops = {"call_service": "service_response", "send_action_goal": "action_result"}
    asked = service_server.receive()
    assert [each["op"] for each in asked] == [*ops]
    answering = {"service": "/do", "action": "/do", "values": {"any": value}, "result": True}
    for each in asked:
        assert each["args"] == {"any": as_json(value)}
        send_cbor(service_server, op=ops[each["op"]], id=each["id"], x=b"\xff", **answering)
    received = caller.receive()
    assert [each["op"] for each in received] == [*ops.values()]
    assert all(each["values"] == {"any": as_json(value)} for each in received)
    assert service_server.receive() == []
    assert caller.forgotten


@pytest.mark.parametrize("value", WRONG)
def test_bytes_in_a_failure_are_not_its_text(value: object) -> None:
    _, service_server, caller = adder_and_caller(strict_responses=True)
    call_add(caller)
    id_ = received_call(service_server)
    send_cbor(
        service_server,
        op="service_response",
        service="/add",
        id=id_,
        values=value,
        result=False,
        x=b"\xff",
    )
    assert received_failure(caller) == "service [/add] responded with an error"


JSON_OR_BYTES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


@given(
    st.binary()
    | st.builds(
        lambda fields, op: cbor2.dumps({**fields, "op": op, "b": b"\xff"}),
        st.dictionaries(
            st.sampled_from(["topic", "service", "id", "msg", "args", "type", "values", "data"]),
            JSON_OR_BYTES | st.sampled_from(["/a", INT32, "my_msgs/Thing"]),
        ),
        st.sampled_from(["publish", "subscribe", "advertise", "call_service", "fragment"]),
    )
)
def test_random_binary_raises_nothing_and_leaves_nothing(data: bytes) -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    talker.send_binary(data)
    talker.receive_frames()
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib")[-1] == 1
    for each in (talker, listener):
        each.disconnect()
        assert each.forgotten
    assert hub.empty
