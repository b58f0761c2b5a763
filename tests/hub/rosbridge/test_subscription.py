"""Subscriptions: throttles, queues, and the merged requests of one client for one topic."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.graph.topic import SinkReport
from fibws.hub.rosbridge.subscription import MAX_REGISTRATIONS

from ..fakes import INT32, STRING, Client, FakeHub, number, talker_and_listener

DEFAULT = 1000
"""The queue length of a subscription that names none."""


class Subscriber:
    """A client that publishes /fib, and one that subscribes to it."""

    def __init__(self, **settings: Any) -> None:
        self.hub = FakeHub(**settings)
        self.talker = self.hub.client("/talker")
        self.talker.send("advertise", "/fib", type=INT32)
        self.client = self.hub.client("/listener")

    def request(self, id_: object = None, **fields: Any) -> None:
        self.client.send("subscribe", "/fib", id=id_, **fields)

    def cancel(self, id_: object = None) -> None:
        self.client.send("unsubscribe", "/fib", id=id_)

    def publish(self, *numbers: int) -> None:
        for each in numbers:
            self.talker.send("publish", "/fib", msg=number(each))

    def received(self, after: float = 0) -> list[int]:
        """Return the numbers that have come, once some seconds have passed."""
        self.hub.clock.advance(after)
        return self.client.receive_numbers("/fib")

    @property
    def report(self) -> SinkReport:
        [sink] = self.hub.graph.topics["/fib"].sinks_of("/listener")
        return sink.report()


def subscribed(**fields: Any) -> Subscriber:
    subscriber = Subscriber()
    subscriber.request(**fields)
    return subscriber


# Throttles.


def test_all_messages_are_sent_without_a_throttle() -> None:
    subscriber = subscribed(queue_length=1)
    subscriber.publish(1, 2, 3)
    assert subscriber.received() == [1, 2, 3]
    assert subscriber.report.throttle_rate == 0


def test_throttle_sends_one_message_per_period() -> None:
    subscriber = subscribed(throttle_rate=300)
    subscriber.publish(1, 2, 3)
    assert subscriber.received(after=10) == [1]
    assert subscriber.report.throttle_rate == 300


def test_throttled_messages_wait_in_the_queue() -> None:
    subscriber = subscribed(throttle_rate=300, queue_length=2)
    subscriber.publish(1, 2, 3, 4)
    assert [subscriber.received(after) for after in (0, 0.3, 0.3, 0.3)] == [[1], [3], [4], []]


def test_throttle_drops_messages_that_come_too_early() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.send("subscribe", "/fib", throttle_rate=300)
    for each in range(12):
        hub.clock.advance_to(each / 10)
        talker.send("publish", "/fib", msg=number(each))
    assert listener.receive_numbers("/fib") == [0, 3, 6, 9]


@pytest.mark.parametrize(
    ("rates", "period"), [((300, 100), 0.1), ((100, 300), 0.1), ((250.5, 300), 0.2505)]
)
def test_shortest_throttle_of_several_requests_counts(
    rates: tuple[float, float], period: float
) -> None:
    subscriber = Subscriber()
    for id_, rate in enumerate(rates):
        subscriber.request(id_, throttle_rate=rate, queue_length=5)
    subscriber.publish(1, 2)
    assert subscriber.received(after=period - 0.01) == [1]
    assert subscriber.received(after=0.01) == [2]


def test_one_request_without_a_throttle_ends_the_throttle() -> None:
    subscriber = subscribed(throttle_rate=300)
    subscriber.request("other", throttle_rate=-1)
    subscriber.publish(1, 2, 3)
    assert subscriber.received() == [1, 2, 3]


@pytest.mark.parametrize("queue_length", [-5, 2**31, 2**100])
def test_any_integer_is_a_valid_queue_length(queue_length: int) -> None:
    subscriber = subscribed(throttle_rate=100, queue_length=queue_length)
    subscriber.publish(1)
    assert subscriber.received() == [1]
    for client in (subscriber.client, subscriber.talker):
        client.disconnect()
    assert subscriber.hub.empty


# Queues.


@pytest.mark.parametrize(
    ("asked", "limit"), [(0, DEFAULT), (1, 1), (5, 5), (-1, DEFAULT), (10**30, 10**30)]
)
def test_queue_has_the_requested_length(asked: int, limit: int) -> None:
    assert subscribed(queue_length=asked).report.queue_length == limit


def test_longest_queue_of_several_requests_counts() -> None:
    subscriber = Subscriber()
    for id_, length in enumerate((5, 7, 2)):
        subscriber.request(id_, queue_length=length)
    assert subscriber.report.queue_length == 7
    subscriber.cancel(1)
    assert subscriber.report.queue_length == 5


@pytest.mark.parametrize(("length", "limit"), [(5, DEFAULT), (DEFAULT + 1, DEFAULT + 1)])
def test_request_without_a_queue_length_asks_for_the_default(length: int, limit: int) -> None:
    subscriber = subscribed(queue_length=length)
    subscriber.request("other")
    assert subscriber.report.queue_length == limit


def test_short_queue_of_one_request_loses_no_message_of_another() -> None:
    subscriber = subscribed(queue_length=10)
    subscriber.request("other", queue_length=1)
    subscriber.client.queue.pause()
    subscriber.publish(*range(10))
    subscriber.client.queue.resume()
    assert subscriber.received() == list(range(10))


def test_longest_throttle_queue_of_several_requests_counts() -> None:
    subscriber = Subscriber()
    for id_, length in enumerate((0, 2, 1)):
        subscriber.request(id_, throttle_rate=300, queue_length=length)
    subscriber.publish(1, 2, 3, 4)
    assert subscriber.received(after=10) == [1, 3, 4]


def test_slow_client_keeps_the_newest_messages_of_each_subscription() -> None:
    hub = FakeHub(queue_length=3)
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/fib", type=INT32)
    talker.send("advertise", "/short", type=INT32)
    listener.send("subscribe", "/fib")
    listener.send("subscribe", "/short", queue_length=1)
    listener.queue.pause()
    for each in range(9):
        talker.send("publish", "/fib", msg=number(each))
        talker.send("publish", "/short", msg=number(each))
    listener.queue.resume()
    assert [(each["topic"], each["msg"]["data"]) for each in listener.receive()] == [
        ("/fib", 6),
        ("/fib", 7),
        ("/fib", 8),
        ("/short", 8),
    ]


def test_throttle_queue_is_bounded_by_max_queued_bytes() -> None:
    hub = FakeHub(max_queued_bytes=2000)
    client = hub.client()
    client.send("advertise", "/a", type=STRING)
    client.send("subscribe", "/a", throttle_rate=1000, queue_length=10**6)
    for _ in range(100):
        client.send("publish", "/a", msg={"data": "x" * 200})
    hub.clock.advance(1000)
    assert len(client.receive()) <= 11


def test_many_throttle_queues_are_bounded_together() -> None:
    hub = FakeHub(max_queued_bytes=2000)
    client = hub.client()
    for each in range(50):
        client.send("advertise", f"/a{each}", type=STRING)
        client.send("subscribe", f"/a{each}", throttle_rate=1000, queue_length=10)
        for _ in range(2):
            client.send("publish", f"/a{each}", msg={"data": "x" * 200})
            assert client.queue.kept_bytes <= 2000
    client.disconnect()
    assert client.queue.kept_bytes == 0


# Several requests.


def test_request_of_the_same_id_replaces_the_older() -> None:
    subscriber = Subscriber()
    subscriber.request("a", queue_length=2)
    subscriber.request("a", queue_length=7)
    assert subscriber.report.queue_length == 7


def test_remaining_requests_count_after_one_is_taken_back() -> None:
    subscriber = Subscriber()
    subscriber.request("fast", queue_length=1)
    subscriber.request("slow", throttle_rate=300, queue_length=5)
    subscriber.cancel("fast")
    assert (subscriber.report.throttle_rate, subscriber.report.queue_length) == (300, 5)


def test_unsubscribe_without_id_takes_all_requests_back() -> None:
    subscriber = Subscriber()
    for id_ in (None, "a", 5):
        subscriber.request(id_)
    subscriber.cancel()
    assert subscriber.client.forgotten
    assert not subscriber.hub.graph.topics["/fib"].sinks()


def test_unsubscribe_with_unknown_id_changes_nothing() -> None:
    subscriber = subscribed(throttle_rate=300, queue_length=5)
    subscriber.publish(1, 2, 3)
    subscriber.cancel("unknown")
    assert subscriber.received(after=1) == [1, 2, 3]


def test_throttled_messages_are_forgotten_after_unsubscribe() -> None:
    subscriber = subscribed(throttle_rate=300, queue_length=5)
    subscriber.publish(1, 2, 3)
    subscriber.cancel()
    assert subscriber.received(after=10) == [1]
    assert subscriber.hub.clock.timers == 0


def test_kept_messages_of_a_slow_client_are_forgotten_after_unsubscribe() -> None:
    subscriber = subscribed()
    subscriber.client.queue.pause()
    subscriber.publish(1, 2)
    subscriber.cancel()
    subscriber.client.queue.resume()
    assert subscriber.received() == []


def test_another_equal_request_does_not_lose_throttled_messages() -> None:
    subscriber = subscribed(throttle_rate=300, queue_length=5)
    subscriber.publish(1, 2, 3)
    subscriber.request("other", throttle_rate=300, queue_length=5)
    assert subscriber.received(after=1) == [1, 2, 3]


def test_report_counts_messages_across_throttles_and_encodings() -> None:
    subscriber = subscribed()
    subscriber.publish(1, 2)
    subscriber.request("cbor", compression="cbor")
    subscriber.publish(3)
    subscriber.cancel("cbor")
    subscriber.request(throttle_rate=300)
    subscriber.publish(4, 5)
    subscriber.client.receive_frames()
    assert subscriber.report.messages == 4


@pytest.mark.parametrize(("queue_length", "left_out"), [(0, 4), (1, 3), (3, 1)])
def test_messages_left_out_by_the_throttle_are_counted(queue_length: int, left_out: int) -> None:
    subscriber = subscribed(throttle_rate=300, queue_length=queue_length)
    subscriber.publish(1, 2, 3, 4, 5)
    assert subscriber.report.throttled == left_out
    received = subscriber.received(after=10)
    report = subscriber.report
    assert (report.messages, report.throttled, report.dropped) == (len(received), left_out, 0)
    assert len(received) == 5 - left_out


def test_throttled_messages_are_counted_across_throttles_and_encodings() -> None:
    subscriber = subscribed(throttle_rate=300)
    subscriber.publish(1, 2)
    assert subscriber.report.throttled == 1
    subscriber.request(throttle_rate=200, queue_length=1)
    subscriber.publish(1, 2, 3)  # One is sent, and one waits.
    assert subscriber.report.throttled == 2
    subscriber.request(compression="cbor")
    subscriber.publish(1, 2)
    assert subscriber.report.throttled == 3
    subscriber.request(throttle_rate=300)
    subscriber.publish(1, 2)
    assert (subscriber.report.messages, subscriber.report.throttled) == (5, 4)


def test_messages_for_one_node_and_latched_ones_count_once() -> None:
    subscriber = Subscriber()
    subscriber.talker.send("unadvertise", "/fib")
    subscriber.talker.send("advertise", "/fib", type=INT32, latch=True)
    subscriber.publish(0)
    subscriber.request(throttle_rate=300, queue_length=1)
    for _ in range(4):  # One is sent, one waits, and two are left out.
        subscriber.talker.send("publish", "/fib", msg=number(1), to="/listener")
    report = subscriber.report
    assert (report.messages, report.throttled) == (2, 2)
    subscriber.publish(2, 3)
    assert subscriber.received(after=10) == [0, 1, 3]
    assert (subscriber.report.messages, subscriber.report.throttled) == (3, 4)


def test_throttled_messages_that_exceed_the_byte_limit_count_as_dropped() -> None:
    subscriber = Subscriber(max_queued_bytes=200)
    subscriber.request(throttle_rate=300, queue_length=100)
    subscriber.publish(*range(11))
    report = subscriber.report
    assert 0 < report.dropped == subscriber.client.queue.dropped
    assert subscriber.client.queue.kept_bytes <= 200
    assert len(subscriber.received(after=100)) == 11 - report.dropped
    assert (subscriber.report.throttled, subscriber.report.messages) == (0, 11 - report.dropped)


def test_topic_keeps_its_type_while_a_request_names_one() -> None:
    hub = FakeHub()
    client = hub.client()

    def type_() -> str | None:
        topic = hub.graph.topics.get("/a")
        return topic.type.name if topic is not None and topic.type is not None else None

    client.send("subscribe", "/a", id="plain")
    types = [type_()]
    for op, fields in (("subscribe", {"type": INT32}), ("unsubscribe", {})) * 2:
        client.send(op, "/a", id="typed", **fields)
        types.append(type_())
    assert types == [None, INT32, None, INT32, None]


@pytest.mark.parametrize("field", ["definition", "md5sum"])
def test_texts_about_the_type_are_not_kept_with_a_request(field: str) -> None:
    """A client may have 100 requests for each of its topics."""
    hub = FakeHub()
    client = hub.client("/listener")
    text = "int32 data\n#" + "x" * 10_000
    client.send("subscribe", "/a", type="my_package/Number", **{field: text})
    assert client.receive() == []
    (subscription,) = client.session.topics.subscriptions.values()
    assert len(repr(subscription.requests)) < 1000


def test_impossible_encoding_is_reported_once_to_the_request_that_asked_for_it() -> None:
    hub = FakeHub()
    talker, client = hub.client(), hub.client()
    for id_, compression in (("a", "none"), ("b", "png"), ("c", "cbor-raw"), ("d", "cbor")):
        client.send("subscribe", "/a", id=id_, compression=compression)
    talker.send("advertise", "/a", type="my_msgs/Thing")
    for _ in range(3):
        talker.send("publish", "/a", msg={})
    status = client.receive_one("status")
    assert (status["level"], status["id"]) == ("error", "c")


def test_number_of_requests_is_limited() -> None:
    subscriber = Subscriber()
    for id_ in range(MAX_REGISTRATIONS):
        subscriber.request(id_)
    subscriber.request(5, queue_length=7)
    assert subscriber.client.receive() == []
    subscriber.request("another")
    [text] = subscriber.client.receive_statuses()
    assert "/fib" in text
    assert f"limit {MAX_REGISTRATIONS}" in text
    subscription = subscriber.client.session.topics.subscriptions["/fib"]
    assert list(subscription.requests) == list(range(MAX_REGISTRATIONS))
    subscriber.cancel(5)
    subscriber.request("another")
    assert subscriber.client.receive() == []


def test_faster_of_two_requests_counts() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/fib", type=INT32)
    listener.send("subscribe", "/fib", id="slow", throttle_rate=1000)
    listener.send("subscribe", "/fib", id="fast", throttle_rate=200)
    for each in range(6):
        hub.clock.advance_to(each / 10)
        talker.send("publish", "/fib", msg=number(each))
    assert listener.receive_numbers("/fib") == [0, 2, 4]


def test_sinks_of_one_client_are_reported_for_each_spelling() -> None:
    hub = FakeHub()
    client: Client = hub.client("/listener")
    client.send("subscribe", "/fib", queue_length=5)
    client.send("subscribe", "fib", queue_length=7)
    lengths = [sink.report().queue_length for sink in hub.graph.topics["/fib"].sinks()]
    assert sorted(lengths) == [5, 7]
