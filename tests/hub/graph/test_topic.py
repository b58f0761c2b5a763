"""The way of a message through a topic."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.hub.graph.subscription import Subscription
from fibws.hub.outbox import Outbox
from fibws.protocol.operations import Subscribe

from ..fakes import payloads
from .listeners import Listeners, heard_by


def test_all_who_spelled_the_name_alike_share_the_bytes_of_a_message() -> None:
    listeners = Listeners()
    (_, first), (_, second) = listeners.subscribe(), listeners.subscribe()
    listeners.deliver({"data": 1})
    assert list(payloads(first[0])) == [b'{"op":"publish","topic":"/a","msg":{"data":1}}']
    assert first[0] is second[0]


@pytest.mark.parametrize("spelling", ["/a", "a", "~a"])
def test_each_hears_the_name_as_it_was_spelled(spelling: str) -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe(spelling)
    listeners.deliver({})
    assert [json.loads(text)["topic"] for text in payloads(writes[0])] == [spelling]


@pytest.mark.parametrize("size", [0, 50, 1000, 70_000])
def test_a_message_may_have_any_size(size: int) -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    listeners.deliver("x" * size)
    assert [json.loads(text)["msg"] for text in payloads(writes[0])] == ["x" * size]


def test_throttled_subscriptions_hear_what_their_throttle_lets_through() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe(throttle_rate=300)
    for number in range(3):
        listeners.deliver(number)
    assert [json.loads(text)["msg"] for data in writes for text in payloads(data)] == [0]


def test_a_slow_client_keeps_as_many_messages_as_it_asked_for() -> None:
    listeners = Listeners()
    subscription, writes = listeners.subscribe(queue_length=2)
    subscription.outbox.pause()
    for number in range(5):
        listeners.deliver(number)
    subscription.outbox.resume()
    listeners.clock.turn()
    assert [json.loads(text)["msg"] for data in writes for text in payloads(data)] == [3, 4]
    assert subscription.queue.dropped == 3


def test_a_topic_keeps_no_empty_channel() -> None:
    listeners = Listeners()
    (first, _), (second, _) = listeners.subscribe("/a"), listeners.subscribe("a")
    for subscription, left in ((first, ["a"]), (second, [])):
        subscription.cancel(None)
        listeners.topic.update(subscription)
        assert [spelling for spelling, _ in listeners.topic.channels] == left
    assert listeners.topic.idle


def test_a_topic_is_idle_when_nobody_has_to_do_with_it() -> None:
    listeners = Listeners()
    assert listeners.topic.idle
    listeners.subscribe()
    assert not listeners.topic.idle


def test_a_topic_is_held_by_publishers_and_by_subscriptions_that_name_the_type() -> None:
    listeners = Listeners()
    topic = listeners.topic
    held = []
    for spelling, type_ in (("/a", None), ("a", "std_msgs/Int32")):
        listeners.subscribe(spelling, type=type_)
        held.append(topic.held)
    assert held == [False, True]
    assert topic.holder() == "/listener"
    topic.publishers["/talker"] = listeners.publisher()
    assert topic.holder() == "/talker"
    assert len(list(topic.subscriptions())) == 2


def test_what_is_latched_is_replayed_to_one_subscription() -> None:
    listeners = Listeners()
    (first, writes), (_, other) = listeners.subscribe("a"), listeners.subscribe("a")
    listeners.topic.replay(first)
    for node, latch in (("/x", True), ("/y", False), ("/z", True)):
        publisher = listeners.topic.publishers[node] = listeners.publisher(latch=latch)
        listeners.topic.replay(first)
    assert heard_by(listeners, writes) == []
    for number, publisher in enumerate(listeners.topic.publishers.values()):
        publisher.publish({"data": number})
    listeners.clock.turn()
    writes.clear()
    other.clear()
    listeners.topic.replay(first)
    assert heard_by(listeners, writes) == [{"data": 0}, {"data": 2}]
    assert other == []


def test_a_message_for_one_node_is_heard_by_that_under_each_spelling() -> None:
    listeners = Listeners()
    ways: list[tuple[str, dict[str, Any]]] = [
        ("/a", {}),
        ("a", {"headers": True}),
        ("~a", {"compression": "png"}),
        ("~b", {"throttle_rate": 1}),
    ]
    mine = [listeners.subscribe(spelling, node="/mine", **way)[1] for spelling, way in ways]
    others = [listeners.subscribe(spelling, node="/other", **way)[1] for spelling, way in ways]
    publisher = listeners.publisher()
    publisher.publish({"data": 1}, to="/mine")
    listeners.clock.turn()
    assert [len(writes) for writes in mine] == [1, 1, 1, 1]
    assert others == [[], [], [], []]
    assert (publisher.messages, publisher.bytes) == (1, len(b'{"data":1}'))


def test_a_message_for_a_node_that_does_not_listen_is_heard_by_nobody() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    listeners.publisher().publish({"data": 1}, to="/nobody")
    assert heard_by(listeners, writes) == []


def test_a_message_for_one_node_waits_for_its_throttle_and_in_its_queue() -> None:
    listeners = Listeners()
    subscription, writes = listeners.subscribe(throttle_rate=1000)
    slow, late = listeners.subscribe(queue_length=2)
    publisher = listeners.publisher()
    slow.outbox.pause()
    for number in range(3):
        publisher.publish({"data": number}, to="/listener")
    assert heard_by(listeners, writes) == [{"data": 0}]
    slow.outbox.resume()
    assert heard_by(listeners, late) == [{"data": 1}, {"data": 2}]
    assert (subscription.messages, slow.messages) == (1, 3)


def test_a_message_for_one_node_that_cannot_be_encoded_so_is_refused_to_that() -> None:
    complaints: list[tuple[object, str]] = []
    listeners = Listeners()
    outbox = Outbox(print, print, listeners.flusher, max_bytes=1000)
    subscription = Subscription(
        "/listener",
        listeners.topic,
        "/a",
        outbox,
        listeners.clock,
        lambda *complaint: complaints.append(complaint),
        queue_length=10,
    )
    subscription.request(Subscribe(topic="/a", id="s", compression="cbor-raw"))
    listeners.topic.update(subscription)
    listeners.publisher("my_msgs/Thing").publish({}, to="/listener")
    [(id_, text)] = complaints
    assert id_ == "s"
    assert "cbor-raw needs the definition of my_msgs/Thing" in text
