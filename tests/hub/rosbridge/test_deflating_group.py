"""Subscriptions of clients that have negotiated compression."""

from __future__ import annotations

import json
import zlib
from typing import Any

import pytest

from fibws.hub.delivery.deflate import LONG
from fibws.hub.graph.topic import SinkReport
from fibws.protocol.deflate import MOST_BITS
from fibws.protocol.websocket import DEFLATED, TEXT

from ..fakes import STRING, Client, FakeHub, FakeWorkers


class Topic:
    """A hub, and a talker that publishes numbers on /t, in messages of some bytes."""

    def __init__(self, *, latch: bool = False, **settings: Any) -> None:
        self.workers = FakeWorkers()
        self.hub = FakeHub(workers=self.workers, **settings)
        self.talker = self.hub.client("/talker")
        self.talker.send("advertise", "/t", type=STRING, latch=latch)

    def listener(self, name: str = "/listener", bits: int = MOST_BITS, **fields: Any) -> Client:
        client = self.hub.client(name, deflate=bits)
        client.send("subscribe", "/t", **fields)
        return client

    def publish(self, *numbers: int, size: int = 2 * LONG) -> None:
        for each in numbers:
            self.talker.send("publish", "/t", msg={"data": f"{each};{'x' * size}"})

    def report(self, name: str = "/listener") -> SinkReport:
        [sink] = self.hub.graph.topics["/t"].sinks_of(name)
        return sink.report()


def received(client: Client) -> list[str]:
    """The numbers in the messages that a client got, with * behind those that were compressed."""
    found = []
    for first, payload in client.receive_frames():
        assert first & ~DEFLATED == TEXT
        if first & DEFLATED:
            payload = zlib.decompressobj(-MOST_BITS).decompress(payload)
        number = json.loads(payload)["msg"]["data"].partition(";")[0]
        found.append(f"{number}{'*' if first & DEFLATED else ''}")
    return found


def test_frame_is_compressed_once_for_all_members() -> None:
    topic = Topic()
    listeners = [topic.listener(f"/l{number}") for number in range(3)]
    others = [topic.listener("/plain", 0), topic.listener("/small", 10)]
    topic.publish(1)
    assert len(topic.workers.jobs) == 2
    assert received(others[0]) == ["1"]
    topic.workers.finish_all()
    assert [received(each) for each in listeners] == 3 * [["1*"]]
    assert received(others[1]) == ["1*"]
    assert len({id(each.queue) for each in listeners}) == 3


def test_messages_keep_their_order_and_none_is_dropped() -> None:
    topic = Topic()
    listener = topic.listener()
    topic.publish(1, size=10)
    topic.publish(2, size=5000)
    topic.publish(3, 4)
    topic.publish(5, size=10)
    assert received(listener) == ["1", "2*"]
    topic.workers.finish_all()
    assert received(listener) == ["3*", "4*", "5"]
    report = topic.report()
    assert (report.messages, report.dropped, report.throttled) == (5, 0, 0)


def test_subscription_that_comes_later_gets_no_older_message() -> None:
    topic = Topic()
    listener = topic.listener()
    topic.publish(1)
    late = topic.listener("/late")
    topic.publish(2)
    topic.workers.finish_all()
    assert received(listener) == ["1*", "2*"]
    assert received(late) == ["2*"]


def test_subscription_that_changes_gets_what_waits_first() -> None:
    topic = Topic()
    listener, other = topic.listener(), topic.listener("/other")
    topic.publish(1)
    listener.send("subscribe", "/t", compression="cbor", id="b")
    topic.workers.finish_all()
    assert received(listener) == ["1"]
    assert received(other) == ["1*"]


def test_subscription_that_ends_is_forgotten() -> None:
    topic = Topic()
    listener = topic.listener()
    topic.publish(1)
    listener.disconnect()
    topic.workers.finish_all()
    topic.talker.disconnect()
    assert topic.hub.empty
    assert topic.hub.deflater.held == 0


def test_latched_message_is_compressed_once_for_all_who_come() -> None:
    topic = Topic(latch=True)
    topic.publish(1)
    first = [topic.listener(f"/l{number}") for number in range(3)]
    assert len(topic.workers.jobs) == 1
    topic.workers.finish_all()
    late = topic.listener("/late")
    assert not topic.workers.jobs
    assert [received(each) for each in (*first, late)] == 4 * [["1*"]]


def test_throttled_subscription_gets_compressed_frames() -> None:
    topic = Topic()
    listener = topic.listener(throttle_rate=1000)
    topic.publish(1)
    topic.workers.finish_all()
    topic.publish(2, 3)
    assert not topic.workers.jobs
    assert received(listener) == ["1*"]
    assert (topic.report().messages, topic.report().throttled) == (1, 2)


@pytest.mark.parametrize("fields", [{"int64": "string"}, {"headers": True}])
def test_other_texts_are_compressed_too(fields: dict[str, Any]) -> None:
    topic = Topic()
    listener = topic.listener(**fields)
    topic.publish(1)
    topic.workers.finish_all()
    assert received(listener) == ["1*"]


def test_fragments_are_not_compressed() -> None:
    topic = Topic()
    listener = topic.listener(fragment_size=LONG)
    topic.publish(1)
    assert not topic.workers.jobs
    assert {each["op"] for each in listener.receive()} == {"fragment"}


def test_calls_have_compressed_responses() -> None:
    hub = FakeHub()
    server, caller = hub.client("/server"), hub.client("/caller", deflate=MOST_BITS)
    server.send("advertise_service", service="/s", type="std_srvs/Trigger")
    caller.send("call_service", service="/s", id="a")
    values = {"success": True, "message": "x" * LONG}
    id_ = server.receive_one("call_service")["id"]
    server.send("service_response", service="/s", id=id_, result=True, values=values)
    [(first, payload)] = caller.receive_frames()
    assert first == TEXT | DEFLATED
    assert len(payload) < 500
    assert json.loads(zlib.decompressobj(-MOST_BITS).decompress(payload))["values"] == values
