"""Credit: a bound of the messages on the way that the client has not acknowledged."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.hub.graph.topic import SinkReport
from fibws.protocol.serialized import read_delivery

from ..fakes import BINARY, INT32, STRING, FakeHub, number


class Viewer:
    """A client that publishes /fib, and one that subscribes to it with credit."""

    def __init__(self, *, latch: bool = False, **settings: Any) -> None:
        self.hub = FakeHub(**settings)
        self.talker = self.hub.client("/talker")
        self.talker.send("advertise", "/fib", type=INT32, latch=latch)
        self.client = self.hub.client("/viewer", serialized=True)

    def request(self, id_: object = None, *, credit: int | None = 2, **fields: Any) -> None:
        self.client.send("subscribe", "/fib", id=id_, compression="ros1", credit=credit, **fields)

    def publish(self, *numbers: int) -> None:
        for each in numbers:
            self.talker.send("publish", "/fib", msg=number(each))

    def acknowledge(self, count: int = 1) -> None:
        self.client.send("acknowledge", "/fib", count=count)

    def received(self, after: float = 0) -> list[int]:
        """Return the numbers that have come, once some seconds have passed."""
        self.hub.clock.advance(after)
        return [
            int.from_bytes(read_delivery(data).message, "little")
            for first, data in self.client.receive_frames()
            if first == BINARY
        ]

    @property
    def report(self) -> SinkReport:
        [sink] = self.hub.graph.topics["/fib"].sinks_of("/viewer")
        return sink.report()


def viewer(credit: int = 2, *, latch: bool = False, **fields: Any) -> Viewer:
    """A viewer that has subscribed."""
    viewer = Viewer(latch=latch)
    viewer.request(credit=credit, **fields)
    return viewer


def test_newest_message_waits_for_the_acknowledgement() -> None:
    one = viewer()
    one.publish(1, 2, 3, 4, 5)
    assert one.received() == [1, 2]
    one.acknowledge()
    assert one.received() == [5]
    one.acknowledge(2)
    assert one.received() == []
    one.publish(6, 7, 8)
    assert one.received() == [6, 7]


def test_replaced_messages_count_as_throttled() -> None:
    one = viewer()
    one.publish(1, 2, 3, 4, 5)
    report = one.report
    assert (report.messages, report.dropped, report.throttled) == (2, 0, 2)
    assert one.client.queue.dropped == 0
    one.acknowledge()
    assert (one.report.messages, one.report.dropped, one.report.throttled) == (3, 0, 2)


def test_as_many_messages_wait_for_credit_as_the_queue_is_long() -> None:
    one = viewer(queue_length=3)
    one.publish(*range(5))
    assert one.received() == [0, 1]
    one.acknowledge(2)
    assert one.received() == [2, 3]
    one.acknowledge()
    assert one.received() == [4]
    report = one.report
    assert (report.messages, report.dropped, report.throttled) == (5, 0, 0)


def test_oldest_message_is_dropped_when_more_wait_for_credit_than_the_queue_holds() -> None:
    one = viewer(queue_length=3)
    one.publish(*range(9))
    report = one.report
    assert (report.messages, report.dropped, report.throttled) == (2, 4, 0)
    assert one.received() == [0, 1]
    one.acknowledge(2)
    assert one.received() == [6, 7]
    one.acknowledge(2)
    assert one.received() == [8]
    assert one.client.queue.dropped == 4
    assert one.client.queue.kept_bytes == 0


def test_reply_to_the_subscription_has_its_credit() -> None:
    one = viewer(credit=3)
    [(_, reply)] = one.client.receive_frames()
    assert json.loads(reply)["credit"] == 3
    one.client.send("subscribe", "/fib", id="other", compression="ros1")
    [(_, reply)] = one.client.receive_frames()
    assert "credit" not in json.loads(reply)


def test_client_that_acknowledges_nothing_gets_no_more_and_keeps_nothing_back() -> None:
    one = viewer()
    listener = one.hub.client("/listener")
    listener.send("subscribe", "/fib")
    one.publish(*range(1000))
    assert one.received(after=3600) == [0, 1]
    assert listener.receive_numbers("/fib") == [*range(1000)]
    assert one.client.queue.kept_bytes < 100
    one.client.disconnect()
    assert one.client.queue.kept_bytes == 0
    assert one.client.forgotten


def test_more_acknowledgements_than_messages_are_no_credit() -> None:
    one = viewer()
    one.acknowledge(10**9)
    one.publish(1, 2, 3)
    assert one.received() == [1, 2]
    one.acknowledge(10**9)
    assert one.received() == [3]
    one.publish(4, 5, 6)
    assert one.received() == [4]


def test_acknowledgements_without_credit_or_subscription_mean_nothing() -> None:
    one = Viewer()
    one.acknowledge()
    one.client.send("subscribe", "/fib")
    one.acknowledge()
    one.publish(1, 2, 3)
    assert one.client.receive_numbers("/fib") == [1, 2, 3]


@pytest.mark.parametrize("fields", [{}, {"compression": "cbor"}, {"compression": "cbor-raw"}])
def test_credit_is_refused_without_serialized_messages(fields: dict[str, str]) -> None:
    one = Viewer()
    one.client.send("subscribe", "/fib", credit=2, **fields)
    [refusal] = one.client.receive()
    assert (refusal["level"], refusal["code"]) == ("error", "invalid_operation")
    assert "fibws.v1" in refusal["msg"]
    assert not one.client.kept["subscriptions"]


def test_credit_is_refused_on_a_connection_of_rosbridge() -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("subscribe", "/fib", type=INT32, compression="ros1", credit=2)
    assert "fibws.v1" in client.receive()[-1]["msg"]


def test_most_credit_of_several_requests_counts_and_none_is_no_limit() -> None:
    one = viewer(credit=1)
    one.request("more", credit=3)
    one.publish(1, 2, 3, 4)
    assert one.received() == [1, 2, 3]
    one.request("all", credit=None)
    one.publish(5, 6, 7)
    assert one.received() == [5, 6, 7]
    one.client.send("unsubscribe", "/fib", id="all")
    one.publish(8, 9)
    assert one.received() == []  # Three of the first four are still unacknowledged.
    one.acknowledge(2)
    assert one.received() == [9]


def test_throttle_and_credit_both_hold_messages_back() -> None:
    one = viewer(throttle_rate=300, queue_length=1)
    one.publish(1, 2, 3)
    assert one.received() == [1]
    assert one.received(after=0.3) == [3]
    one.publish(4, 5)
    assert one.received(after=10) == []
    one.acknowledge()
    assert one.received() == [5]
    one.acknowledge(2)
    one.publish(6, 7)
    assert one.received() == []
    assert one.received(after=0.3) == [7]
    report = one.report
    assert (report.messages, report.throttled, report.dropped) == (4, 3, 0)
    assert report.throttle_rate == 300
    assert one.hub.clock.timers == 0


def test_unsubscribing_ends_what_waits_for_its_time() -> None:
    one = viewer(throttle_rate=300)
    one.publish(1, 2)
    one.client.send("unsubscribe", "/fib")
    assert (one.hub.clock.timers, one.client.queue.kept_bytes) == (0, 0)
    assert one.received(after=1) == [1]


def test_latched_messages_wait_for_credit_and_are_not_replaced() -> None:
    one = Viewer(latch=True)
    one.publish(1)
    for each in (2, 3, 4):
        other = one.hub.client(f"/talker{each}")
        other.send("advertise", "/fib", type=INT32, latch=True)
        other.send("publish", "/fib", msg=number(each))
    one.request(throttle_rate=1000)
    one.publish(5, 6)
    assert one.received() == [1, 2]
    one.acknowledge()
    assert one.received() == [3]
    one.acknowledge(2)
    assert one.received() == [4, 6]


def test_message_for_one_node_needs_credit() -> None:
    one = viewer(credit=1)
    for each in (1, 2, 3):
        one.talker.send("publish", "/fib", msg=number(each), to="/viewer")
    assert one.received() == [1]
    one.acknowledge()
    assert one.received() == [3]
    assert (one.report.messages, one.report.dropped, one.report.throttled) == (2, 0, 1)


def test_full_socket_gets_the_newest_message_when_it_takes_data_again() -> None:
    one = viewer()
    one.client.queue.pause()
    one.publish(1, 2, 3)
    assert one.received() == []
    one.client.queue.resume()
    assert one.received() == [3]
    one.publish(4, 5)
    assert one.received() == [4]
    assert one.report.throttled == 2


def test_client_without_room_loses_what_waits() -> None:
    one = Viewer(max_queued_bytes=200)
    one.request(credit=1)
    one.client.send("subscribe", "/other", type=STRING)
    one.publish(1, 2)
    one.client.queue.pause()
    talker = one.hub.client()
    talker.send("advertise", "/other", type=STRING)
    talker.send("publish", "/other", msg={"data": "x" * 150})
    one.publish(3)
    assert (one.report.dropped, one.report.throttled) == (1, 1)
    one.client.queue.resume()
    one.acknowledge()
    assert one.received() == [1]


@pytest.mark.parametrize("paused", [False, True])
def test_message_larger_than_the_queue_waits_for_credit_like_any_other(paused: bool) -> None:
    """Otherwise a picture that exceeds the limit would never arrive."""
    one = Viewer(max_queued_bytes=10)
    one.request(credit=1)
    assert one.received() == []
    if paused:
        one.client.queue.pause()
    one.publish(1, 2)
    one.client.queue.resume()
    assert one.received() == [2 if paused else 1]
    one.publish(3)
    one.acknowledge()
    assert one.received() == [3]
    assert one.report.dropped == 0


def test_new_type_is_reported_before_its_messages() -> None:
    one = viewer(credit=1)
    one.publish(1)
    one.client.receive_frames()
    one.acknowledge()
    one.talker.send("unadvertise", "/fib")
    one.talker.send("advertise", "/fib", type=STRING)
    one.talker.send("publish", "/fib", msg={"data": "x"})
    (_, reply), (first, _) = one.client.receive_frames()
    assert (json.loads(reply)["type"], json.loads(reply)["credit"], first) == (STRING, 1, BINARY)


EVENTS = ["publish", "publish", "publish", "acknowledge", "pause", "resume", "wait", "request"]


@given(
    credit=st.integers(1, 3),
    period=st.sampled_from([0, 0, 100, 300]),
    events=st.lists(st.sampled_from(EVENTS), max_size=60),
)
def test_messages_on_the_way_never_exceed_the_credit_and_the_last_one_arrives(
    credit: int, period: int, events: list[str]
) -> None:
    one = viewer(credit, throttle_rate=period)
    received: list[int] = []
    published = acknowledged = 0
    for event in events:
        if event == "publish":
            published += 1
            one.publish(published)
        elif event == "acknowledge" and acknowledged < len(received):
            acknowledged += 1
            one.acknowledge()
        elif event == "wait":
            one.hub.clock.advance(0.1)
        elif event == "request":
            one.request("other", credit=credit)  # It has no throttle.
        elif event in ("pause", "resume"):
            getattr(one.client.queue, event)()
        received += one.received()
        assert len(received) - acknowledged <= credit
        report = one.report
        counted = report.messages + report.dropped + report.throttled
        assert published - counted in (0, 1)
    published += 1
    one.publish(published)  # A changed request may have dropped what waited.
    one.client.queue.resume()
    received += one.received(after=1)
    while acknowledged < len(received):
        acknowledged += 1
        one.acknowledge()
        received += one.received(after=1)
    assert received == sorted(set(received))
    assert received[-1] == published
    assert one.client.queue.kept_bytes == 0
