"""Operations that come in binary frames: JSON text, or CBOR."""

from __future__ import annotations

import json
from base64 import b64encode
from struct import pack
from typing import Any

import cbor2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..fakes import INT32, Client, FakeHub, number, talker_and_listener
from .adding import adder_and_caller, calls, hears_failure, hears_sums, is_asked_once
from .pursuing import is_sent, server_and_client

PUBLISH = {"op": "publish", "topic": "/fib", "msg": {"data": 8}}


def says_cbor(client: Client, **fields: Any) -> None:
    client.says_binary(cbor2.dumps(fields))


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
def test_an_operation_may_come_as_text_or_as_cbor(data: bytes) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says_binary(data)
    assert listener.hears_numbers("/fib") == [8]
    assert talker.hears() == []


def test_several_operations_may_come_in_one_binary_text() -> None:
    client = FakeHub().client()
    client.says_binary(
        b'{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}'
        b'{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a"}'
    )
    assert client.hears_numbers("/a") == [0]


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
def test_what_is_neither_is_refused_and_the_client_goes_on(data: bytes) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says_binary(data)
    [status] = talker.hears()
    assert (status["op"], status["level"]) == ("status", "error")
    assert len(status["msg"]) < 2000
    talker.says_binary(cbor2.dumps(PUBLISH))
    assert listener.hears_numbers("/fib") == [8]


@pytest.mark.parametrize(
    "data",
    [pack("<3i", 1, 2, 3), cbor2.CBORTag(78, pack("<3i", 1, 2, 3)), [1, 2, 3]],
    ids=["bytes", "typed array", "list"],
)
def test_arrays_may_be_typed(data: object) -> None:
    client = FakeHub().client()
    client.says("advertise", "/a", type="std_msgs/Int32MultiArray")
    client.says("subscribe", "/a")
    says_cbor(client, op="publish", topic="/a", msg={"data": data}, id=b"\xff" * 3)
    heard = client.hears()[0]
    if isinstance(data, bytes):
        assert "for field data, but got a bytes" in heard["msg"]
    else:
        assert heard["msg"]["data"] == [1, 2, 3]


def test_byte_strings_are_what_images_are_made_of() -> None:
    client = FakeHub().client()
    client.says("advertise", "/a", type="sensor_msgs/CompressedImage")
    client.says("subscribe", "/a")
    says_cbor(client, op="publish", topic="/a", msg={"data": b"\xff\0\1\2"})
    [msg] = client.hears_messages("/a")
    assert msg["data"] == "/wABAg=="


def test_calls_and_goals_may_come_as_cbor_too() -> None:
    _, provider, caller = adder_and_caller()
    says_cbor(caller, op="call_service", service="/add", args=[1, 2], id=b"", type="\xff")
    assert len(caller.hears_statuses()) == 1
    says_cbor(caller, op="call_service", service="/add", args=[1, 2], id="x", type="\xff")
    id_ = is_asked_once(provider)
    values = {"sum": 3}
    says_cbor(provider, op="service_response", service="/add", id=id_, values=values, result=True)
    assert hears_sums(caller) == [3]
    _, pursuer, client = server_and_client()
    says_cbor(
        client,
        op="send_action_goal",
        action="/fib",
        action_type="example_interfaces/Fibonacci",
        args={"order": 5},
    )
    assert len(is_sent(pursuer)) == 1


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
    says_cbor(client, **{**fields, field: value})
    [status] = client.hears_statuses()
    assert field in status
    assert hub.graph.topics == {}


@pytest.mark.parametrize("value", WRONG)
def test_an_id_of_bytes_is_none(value: object) -> None:
    client = FakeHub().client()
    says_cbor(client, op="fly", id=value)
    assert "id" not in client.hears_one("status")


@pytest.mark.parametrize("value", WRONG)
def test_messages_of_an_unknown_type_may_hold_bytes(value: object) -> None:
    hub = FakeHub()
    talker, listener, binary, late = (hub.client() for _ in range(4))
    talker.says("advertise", "/a", type="my_msgs/Thing", latch=True)
    listener.says("subscribe", "/a")
    binary.says("subscribe", "/a", compression="cbor")
    says_cbor(talker, op="publish", topic="/a", msg={"any": value}, x=b"\xff")
    late.says("subscribe", "/a")
    assert listener.hears_messages("/a") == late.hears_messages("/a") == [{"any": as_json(value)}]
    assert [each["msg"] for each in binary.hears_cbor()] == [{"any": as_json(value)}]
    assert talker.hears() == []


def as_json(value: object) -> object:
    """What there is in place of bytes where only text can be: their base64."""
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
    provider, caller = hub.client(), hub.client()
    provider.says("advertise_service", service="/do", type="my_srvs/Do")
    provider.says("advertise_action", action="/do", type="my_actions/Do")
    asking = {"service": "/do", "action": "/do", "args": {"any": value}, "x": b"\xff"}
    says_cbor(caller, op="call_service", **asking)
    says_cbor(caller, op="send_action_goal", action_type="my_actions/Do", **asking)
    ops = {"call_service": "service_response", "send_action_goal": "action_result"}
    asked = provider.hears()
    assert [each["op"] for each in asked] == [*ops]
    answering = {"service": "/do", "action": "/do", "values": {"any": value}, "result": True}
    for each in asked:
        assert each["args"] == {"any": as_json(value)}
        says_cbor(provider, op=ops[each["op"]], id=each["id"], x=b"\xff", **answering)
    heard = caller.hears()
    assert [each["op"] for each in heard] == [*ops.values()]
    assert all(each["values"] == {"any": as_json(value)} for each in heard)
    assert provider.hears() == []
    assert caller.forgotten


@pytest.mark.parametrize("value", WRONG)
def test_bytes_in_a_failure_are_no_text(value: object) -> None:
    _, provider, caller = adder_and_caller(strict_responses=True)
    calls(caller)
    id_ = is_asked_once(provider)
    says_cbor(
        provider,
        op="service_response",
        service="/add",
        id=id_,
        values=value,
        result=False,
        x=b"\xff",
    )
    assert hears_failure(caller) == "service [/add] responded with an error"


JSON_OR_BYTES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


@settings(deadline=None)
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
def test_whatever_the_bytes_nothing_is_raised_and_nothing_left(data: bytes) -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    talker.says_binary(data)
    talker.hears_frames()
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib")[-1] == 1
    for each in (talker, listener):
        each.leaves()
        assert each.forgotten
    assert hub.empty
