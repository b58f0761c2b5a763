"""Subscriptions that want their messages otherwise than as JSON."""

from __future__ import annotations

import json
from dataclasses import replace
from struct import pack
from typing import Any

import cbor2
import pytest
from protocol.pictures import read_text
from pydantic_core import to_json

from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment
from fibws.protocol.png import encode_png

from ..fakes import BINARY, INT32, NANOSECONDS, TEXT, Client, FakeHub, number

SECS, NSECS = divmod(NANOSECONDS, 10**9)
WAYS = ["none", "png", "cbor", "cbor-raw"]


def meaning(frame: tuple[int, bytes]) -> dict[str, Any]:
    """The operation that a frame comes to."""
    first, payload = frame
    operation: dict[str, Any] = cbor2.loads(payload) if first == BINARY else json.loads(payload)
    if operation["op"] == "png":
        operation = json.loads(read_text(operation["data"]))
    return operation


def talker_and_listeners(*asked: dict[str, Any]) -> tuple[FakeHub, Client, list[Client]]:
    """A talker on /fib, and one listener for each way of asking."""
    hub = FakeHub()
    talker = hub.client("/talker")
    talker.says("advertise", "/fib", type=INT32, latch=True)
    listeners = [hub.client() for _ in asked]
    for listener, fields in zip(listeners, asked, strict=True):
        listener.says("subscribe", "/fib", **fields)
    return hub, talker, listeners


def test_each_hears_the_same_message_in_its_own_way() -> None:
    _, talker, listeners = talker_and_listeners(*({"compression": each} for each in WAYS))
    talker.says("publish", "/fib", msg=number(8))
    heard = [listener.hears_frames() for listener in listeners]
    assert [first for [(first, _)] in heard] == [TEXT, TEXT, BINARY, BINARY]
    raw = {"secs": SECS, "nsecs": NSECS, "bytes": pack("<i", 8)}
    assert [meaning(frame) for [frame] in heard] == [
        {"op": "publish", "topic": "/fib", "msg": msg}
        for msg in (number(8), number(8), number(8), raw)
    ]


@pytest.mark.parametrize("way", WAYS)
def test_what_is_latched_comes_in_the_same_way(way: str) -> None:
    hub, talker, _ = talker_and_listeners()
    talker.says("publish", "/fib", msg=number(8))
    late, early = hub.client(), hub.client()
    early.says("subscribe", "/fib", compression=way)
    late.says("subscribe", "/fib", compression=way)
    assert late.hears_frames() == early.hears_frames() != []


@pytest.mark.parametrize("compression", ["zip", "PNG", "", "cbor_raw"])
def test_what_is_no_compression_counts_as_none(compression: str) -> None:
    _, talker, [listener] = talker_and_listeners({"compression": compression})
    talker.says("publish", "/fib", msg=number(8))
    assert listener.hears_numbers("/fib") == [8]


def test_a_compression_comes_and_goes_with_the_request_that_asked_for_it() -> None:
    hub, talker, [listener] = talker_and_listeners({"id": "plain"})

    def heard() -> str:
        talker.says("publish", "/fib", msg=number(8))
        [frame] = listener.hears_frames()
        if frame[0] == BINARY:
            return "cbor-raw" if "bytes" in cbor2.loads(frame[1])["msg"] else "cbor"
        op: str = json.loads(frame[1])["op"]
        return op

    listener.hears_frames()
    found = [heard()]
    for way in ("png", "cbor", "cbor-raw"):
        listener.says("subscribe", "/fib", id=way, compression=way)
        listener.hears_frames()
        found.append(heard())
    for way in ("cbor-raw", "png", "cbor"):
        listener.says("unsubscribe", "/fib", id=way)
        found.append(heard())
    assert found == ["publish", "png", "cbor", "cbor-raw", "cbor", "cbor", "publish"]
    assert len(hub.graph.topics["/fib"].channels) == 1
    listener.says("unsubscribe", "/fib")
    assert hub.graph.topics["/fib"].channels == {}


def test_pieces_make_up_the_text_that_others_hear_whole() -> None:
    _, talker, [pieces, whole] = talker_and_listeners({"fragment_size": 10}, {})
    for each in (1, 2):
        talker.says("publish", "/fib", msg=number(each))
    reassembly = Reassembly(max_size=10**6)
    fragments = [Fragment(**each) for each in pieces.hears()]
    assert all(len(each.data) <= 10 and type(each.id) is str for each in fragments)
    texts = [reassembly.add(each, 0) for each in fragments]
    expected = [payload.decode() for _, payload in whole.hears_frames()]
    assert [text for text in texts if text is not None] == expected


def test_a_throttle_counts_messages_and_not_their_pieces() -> None:
    hub, talker, [listener] = talker_and_listeners({"fragment_size": 10, "throttle_rate": 300})
    for each in range(3):
        talker.says("publish", "/fib", msg=number(each))
    assert len({each["id"] for each in listener.hears()}) == 1
    hub.clock.advance(1)
    assert listener.hears() == []


def test_a_slow_client_loses_whole_messages_and_not_some_of_their_pieces() -> None:
    _, talker, [listener] = talker_and_listeners({"fragment_size": 10, "queue_length": 2})
    listener.outbox.pause()
    for each in range(5):
        talker.says("publish", "/fib", msg=number(each))
    listener.outbox.resume()
    reassembly = Reassembly(max_size=10**6)
    texts = [reassembly.add(Fragment(**each), 0) for each in listener.hears()]
    assert [json.loads(each)["msg"] for each in texts if each] == [number(3), number(4)]


def test_however_many_listen_a_message_is_encoded_once_in_each_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = [{"compression": each} for each in WAYS] + [{"fragment_size": 10}]
    hub, talker, listeners = talker_and_listeners(*asked * 10)
    times = {"json": 0, "png": 0, "cbor": 0, "binary": 0}

    def counting(name: str, function: Any) -> Any:
        def count(*args: Any, **options: Any) -> Any:
            times[name] += 1
            return function(*args, **options)

        return count

    for name, path, function in (("json", "to_json", to_json), ("png", "encode_png", encode_png)):
        monkeypatch.setattr(f"fibws.hub.graph.encoding.{path}", counting(name, function))
    publisher = hub.graph.topics["/fib"].publishers["/talker"]
    type_ = publisher.type
    publisher.type = replace(
        type_, cbor=counting("cbor", type_.cbor), binary=counting("binary", type_.binary)
    )
    for each in (1, 2):
        talker.says("publish", "/fib", msg=number(each))
        assert times == dict.fromkeys(times, each)
    assert all(listener.hears_frames() for listener in listeners)


# Types that nobody knows.


def test_cbor_raw_of_an_unknown_type_is_refused_and_leaves_nothing_behind() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/a", type="my_msgs/Thing")
    listener.says("subscribe", "/a", compression="cbor-raw", id="x")
    assert listener.hears_statuses() == [
        "subscribe: cbor-raw needs the definition of my_msgs/Thing, which nobody brought"
    ]
    assert listener.forgotten


@pytest.mark.parametrize("way", ["none", "png", "cbor"])
def test_a_refused_request_leaves_the_subscription_as_it_was(way: str) -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/a", type="my_msgs/Thing")
    listener.says("subscribe", "/a", compression=way, id="x")
    listener.says("subscribe", "/a", compression="cbor-raw", id="y")
    assert len(listener.hears_statuses()) == 1
    talker.says("publish", "/a", msg={"any": [1]})
    [frame] = listener.hears_frames()
    assert meaning(frame) == {"op": "publish", "topic": "/a", "msg": {"any": [1]}}


def test_who_waits_for_a_type_in_cbor_raw_is_told_when_that_cannot_be() -> None:
    hub = FakeHub()
    talker, listener, other = hub.client(), hub.client(), hub.client()
    listener.says("subscribe", "/a", compression="cbor-raw", id="x")
    other.says("subscribe", "/a")
    talker.says("advertise", "/a", type="my_msgs/Thing")
    talker.says("publish", "/a", msg={"any": 1})
    talker.says("publish", "/a", msg={"any": 2})
    assert talker.hears() == []
    assert other.hears_messages("/a") == [{"any": 1}, {"any": 2}]
    [told] = listener.hears_statuses()
    assert "cbor-raw needs the definition of my_msgs/Thing, which nobody brought" in told


def test_who_waits_for_a_type_in_cbor_raw_hears_it_once_it_is_known() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.says("subscribe", "/a", compression="cbor-raw")
    talker.says("advertise", "/a", type="my_msgs/Thing", definition="int8 one\n")
    talker.says("publish", "/a", msg={"one": 5})
    [heard] = listener.hears_cbor()
    assert heard["msg"]["bytes"] == b"\5"
