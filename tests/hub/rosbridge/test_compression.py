"""Subscriptions with a compression or with fragments."""

from __future__ import annotations

import json
from struct import pack
from typing import Any

import cbor2
import pytest
from protocol.png_reader import read_text
from pydantic_core import to_json

from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment
from fibws.protocol.png import encode_png

from ..fakes import BINARY, INT32, NANOSECONDS, TEXT, Client, FakeHub, number

SECS, NSECS = divmod(NANOSECONDS, 10**9)
WAYS = ["none", "png", "cbor", "cbor-raw"]


def meaning(frame: tuple[int, bytes]) -> dict[str, Any]:
    """Return the operation in a frame."""
    first, payload = frame
    operation: dict[str, Any] = cbor2.loads(payload) if first == BINARY else json.loads(payload)
    if operation["op"] == "png":
        operation = json.loads(read_text(operation["data"]))
    return operation


def talker_and_listeners(*asked: dict[str, Any]) -> tuple[FakeHub, Client, list[Client]]:
    """Return a publisher of /fib, and one subscriber for each set of fields."""
    hub = FakeHub()
    talker = hub.client("/talker")
    talker.send("advertise", "/fib", type=INT32, latch=True)
    listeners = [hub.client() for _ in asked]
    for listener, fields in zip(listeners, asked, strict=True):
        listener.send("subscribe", "/fib", **fields)
    return hub, talker, listeners


def test_each_subscriber_gets_the_message_in_its_compression() -> None:
    _, talker, listeners = talker_and_listeners(*({"compression": each} for each in WAYS))
    talker.send("publish", "/fib", msg=number(8))
    received = [listener.receive_frames() for listener in listeners]
    assert [first for [(first, _)] in received] == [TEXT, TEXT, BINARY, BINARY]
    raw = {"secs": SECS, "nsecs": NSECS, "bytes": pack("<i", 8)}
    assert [meaning(frame) for [frame] in received] == [
        {"op": "publish", "topic": "/fib", "msg": msg}
        for msg in (number(8), number(8), number(8), raw)
    ]


@pytest.mark.parametrize("way", WAYS)
def test_latched_message_comes_in_the_requested_compression(way: str) -> None:
    hub, talker, _ = talker_and_listeners()
    talker.send("publish", "/fib", msg=number(8))
    late, early = hub.client(), hub.client()
    early.send("subscribe", "/fib", compression=way)
    late.send("subscribe", "/fib", compression=way)
    assert late.receive_frames() == early.receive_frames() != []


@pytest.mark.parametrize("compression", ["zip", "PNG", "", "cbor_raw"])
def test_unknown_compression_counts_as_none(compression: str) -> None:
    _, talker, [listener] = talker_and_listeners({"compression": compression})
    talker.send("publish", "/fib", msg=number(8))
    assert listener.receive_numbers("/fib") == [8]


def test_compression_ends_with_the_request_that_asked_for_it() -> None:
    hub, talker, [listener] = talker_and_listeners({"id": "plain"})

    def next_encoding() -> str:
        talker.send("publish", "/fib", msg=number(8))
        [frame] = listener.receive_frames()
        if frame[0] == BINARY:
            return "cbor-raw" if "bytes" in cbor2.loads(frame[1])["msg"] else "cbor"
        op: str = json.loads(frame[1])["op"]
        return op

    listener.receive_frames()
    found = [next_encoding()]
    for way in ("png", "cbor", "cbor-raw"):
        listener.send("subscribe", "/fib", id=way, compression=way)
        listener.receive_frames()
        found.append(next_encoding())
    for way in ("cbor-raw", "png", "cbor"):
        listener.send("unsubscribe", "/fib", id=way)
        found.append(next_encoding())
    assert found == ["publish", "png", "cbor", "cbor-raw", "cbor", "cbor", "publish"]
    assert len(hub.rosbridge.groups) == 1
    listener.send("unsubscribe", "/fib")
    assert hub.rosbridge.groups == {}


def test_fragments_make_up_the_text_that_others_get_whole() -> None:
    _, talker, [pieces, whole] = talker_and_listeners({"fragment_size": 10}, {})
    for each in (1, 2):
        talker.send("publish", "/fib", msg=number(each))
    reassembly = Reassembly(max_size=10**6)
    fragments = [Fragment(**each) for each in pieces.receive()]
    assert all(len(each.data) <= 10 and type(each.id) is str for each in fragments)
    texts = [reassembly.add(each, 0) for each in fragments]
    expected = [payload.decode() for _, payload in whole.receive_frames()]
    assert [text for text in texts if text is not None] == expected


def test_throttle_counts_messages_not_fragments() -> None:
    hub, talker, [listener] = talker_and_listeners({"fragment_size": 10, "throttle_rate": 300})
    for each in range(3):
        talker.send("publish", "/fib", msg=number(each))
    assert len({each["id"] for each in listener.receive()}) == 1
    hub.clock.advance(1)
    assert listener.receive() == []


def test_slow_client_loses_whole_messages_not_fragments() -> None:
    _, talker, [listener] = talker_and_listeners({"fragment_size": 10, "queue_length": 2})
    listener.queue.pause()
    for each in range(5):
        talker.send("publish", "/fib", msg=number(each))
    listener.queue.resume()
    reassembly = Reassembly(max_size=10**6)
    texts = [reassembly.add(Fragment(**each), 0) for each in listener.receive()]
    assert [json.loads(each)["msg"] for each in texts if each] == [number(3), number(4)]


def test_message_is_encoded_once_per_form_for_all_subscribers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = [{"compression": each} for each in WAYS] + [{"fragment_size": 10}]
    hub, talker, listeners = talker_and_listeners(*asked * 10)
    times = {"json": 0, "png": 0, "cbor": 0, "ros1": 0}

    def counting(name: str, function: Any) -> Any:
        def count(*args: Any, **options: Any) -> Any:
            times[name] += 1
            return function(*args, **options)

        return count

    publication, encodings = "fibws.hub.graph.publication", "fibws.hub.rosbridge.encodings"
    monkeypatch.setattr(f"{publication}.to_json", counting("json", to_json))
    monkeypatch.setattr(f"{encodings}.encode_png", counting("png", encode_png))
    type_ = hub.graph.topics["/fib"].sources["/talker"].type
    monkeypatch.setattr(type_, "cbor", counting("cbor", type_.cbor))
    monkeypatch.setattr(type_, "serialize", counting("ros1", type_.serialize))
    for each in (1, 2):
        talker.send("publish", "/fib", msg=number(each))
        assert times == dict.fromkeys(times, each)
    assert all(listener.receive_frames() for listener in listeners)


# Unknown types.


def test_cbor_raw_of_an_unknown_type_is_refused_and_leaves_nothing() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type="my_msgs/Thing")
    listener.send("subscribe", "/a", compression="cbor-raw", id="x")
    [text] = listener.receive_statuses()
    assert text.startswith("subscribe: ")
    assert "definition of my_msgs/Thing" in text
    assert listener.forgotten


@pytest.mark.parametrize("way", ["none", "png", "cbor"])
def test_refused_request_does_not_change_the_subscription(way: str) -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type="my_msgs/Thing")
    listener.send("subscribe", "/a", compression=way, id="x")
    listener.send("subscribe", "/a", compression="cbor-raw", id="y")
    assert len(listener.receive_statuses()) == 1
    talker.send("publish", "/a", msg={"any": [1]})
    [frame] = listener.receive_frames()
    assert meaning(frame) == {"op": "publish", "topic": "/a", "msg": {"any": [1]}}


def test_cbor_raw_subscriber_gets_an_error_when_the_type_is_unknown() -> None:
    hub = FakeHub()
    talker, listener, other = hub.client(), hub.client(), hub.client()
    listener.send("subscribe", "/a", compression="cbor-raw", id="x")
    other.send("subscribe", "/a")
    talker.send("advertise", "/a", type="my_msgs/Thing")
    talker.send("publish", "/a", msg={"any": 1})
    talker.send("publish", "/a", msg={"any": 2})
    assert talker.receive() == []
    assert other.receive_messages("/a") == [{"any": 1}, {"any": 2}]
    [status] = listener.receive_statuses()
    assert "definition of my_msgs/Thing" in status


def test_cbor_raw_subscriber_gets_messages_once_the_type_is_known() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.send("subscribe", "/a", compression="cbor-raw")
    talker.send("advertise", "/a", type="my_msgs/Thing", definition="int8 one\n")
    talker.send("publish", "/a", msg={"one": 5})
    [received] = listener.receive_cbor()
    assert received["msg"]["bytes"] == b"\5"
