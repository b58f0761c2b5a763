"""What one client wants of one topic."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import OperationError
from fibws.hub.graph.subscription import MAX_REGISTRATIONS, Subscription
from fibws.hub.graph.topic import Topic
from fibws.hub.outbox import Flusher, Outbox
from fibws.protocol.operations import Id, Subscribe

from ..fakes import FakeClock

DEFAULT = 1000


class Subscriber:
    """A subscription, and the frames that its client was sent."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.writes: list[bytes] = []
        self.outbox = Outbox(
            self.writes.append, print, Flusher(self.clock.call_soon), max_bytes=1000
        )
        self.complaints: list[tuple[Id, str]] = []
        self.subscription = Subscription(
            "/listener",
            Topic("/a"),
            "/a",
            self.outbox,
            self.clock,
            lambda id_, text: self.complaints.append((id_, text)),
            queue_length=DEFAULT,
        )

    def request(self, id_: Id = None, **fields: Any) -> None:
        self.subscription.request(Subscribe(id=id_, topic="/a", **fields))

    def offer(self, *numbers: int) -> None:
        for number in numbers:
            self.subscription.offer(b"%d," % number)

    def hears(self, after: float = 0) -> bytes:
        self.clock.advance(after)
        self.clock.turn()
        heard = b"".join(self.writes)
        self.writes.clear()
        return heard


def subscribed(**fields: Any) -> Subscriber:
    it = Subscriber()
    it.request(**fields)
    return it


def test_without_a_throttle_all_messages_go_straight_out() -> None:
    it = subscribed(queue_length=1)
    it.offer(1, 2, 3)
    assert it.subscription.direct
    assert it.hears() == b"1,2,3,"


def test_a_throttle_lets_one_pass_in_a_period() -> None:
    it = subscribed(throttle_rate=300)
    it.offer(1, 2, 3)
    assert not it.subscription.direct
    assert it.hears(after=10) == b"1,"


def test_throttled_messages_may_wait_in_the_queue() -> None:
    it = subscribed(throttle_rate=300, queue_length=2)
    it.offer(1, 2, 3, 4)
    assert [it.hears(after) for after in (0, 0.3, 0.3, 0.3)] == [b"1,", b"3,", b"4,", b""]


def test_what_is_sent_at_once_passes_by_the_throttle() -> None:
    it = subscribed(throttle_rate=300)
    it.offer(1)
    it.subscription.send(b"latched,")
    assert it.hears() == b"1,latched,"


@pytest.mark.parametrize(
    ("asked", "limit"), [(0, DEFAULT), (1, 1), (5, 5), (-1, DEFAULT), (10**30, 10**30)]
)
def test_the_queue_is_as_long_as_asked_for(asked: int, limit: int) -> None:
    assert subscribed(queue_length=asked).subscription.queue.limit == limit


@pytest.mark.parametrize(
    ("rates", "period"), [((300, 100), 0.1), ((100, 300), 0.1), ((250.5, 300), 0.2505)]
)
def test_of_several_requests_the_shortest_throttle_counts(
    rates: tuple[float, float], period: float
) -> None:
    it = Subscriber()
    for id_, rate in enumerate(rates):
        it.request(id_, throttle_rate=rate, queue_length=5)
    it.offer(1, 2)
    assert it.hears(after=period - 0.01) == b"1,"
    assert it.hears(after=0.01) == b"2,"


def test_one_request_without_a_throttle_frees_them_all() -> None:
    it = subscribed(throttle_rate=300)
    it.request("other", throttle_rate=-1)
    assert it.subscription.direct


def test_of_several_requests_the_shortest_queue_counts() -> None:
    it = Subscriber()
    for id_, length in enumerate((5, 2, 7)):
        it.request(id_, queue_length=length)
    assert it.subscription.queue.limit == 2


def test_a_request_that_names_no_queue_has_the_default_for_all() -> None:
    it = subscribed(queue_length=5)
    it.request("other")
    assert it.subscription.queue.limit == DEFAULT


def test_a_request_of_the_same_id_replaces_the_older() -> None:
    it = Subscriber()
    it.request("a", queue_length=2)
    it.request("a", queue_length=7)
    assert it.subscription.queue.limit == 7


def test_what_remains_counts_once_a_request_is_taken_back() -> None:
    it = Subscriber()
    it.request("fast", queue_length=1)
    it.request("slow", throttle_rate=300, queue_length=5)
    it.subscription.cancel("fast")
    assert not it.subscription.direct
    assert it.subscription.queue.limit == 5


def test_without_an_id_all_requests_are_taken_back() -> None:
    it = Subscriber()
    for id_ in (None, "a", 5):
        it.request(id_)
    it.subscription.cancel(None)
    assert not it.subscription.requests


def test_an_unknown_id_changes_nothing() -> None:
    it = subscribed(throttle_rate=300, queue_length=5)
    it.offer(1, 2, 3)
    it.subscription.cancel("unknown")
    assert it.hears(after=1) == b"1,2,3,"


def test_nothing_waits_for_a_client_that_wants_no_more() -> None:
    it = subscribed(throttle_rate=300, queue_length=5)
    it.offer(1, 2, 3)
    it.subscription.cancel(None)
    assert it.hears(after=10) == b"1,"
    assert it.clock.timers == 0


def test_nothing_is_kept_for_a_slow_client_that_wants_no_more() -> None:
    it = subscribed()
    it.outbox.pause()
    it.offer(1, 2)
    it.subscription.cancel(None)
    it.outbox.resume()
    assert it.hears() == b""


def test_another_request_does_not_lose_what_waits() -> None:
    it = subscribed(throttle_rate=300, queue_length=5)
    it.offer(1, 2, 3)
    it.request("other", throttle_rate=300, queue_length=5)
    assert it.hears(after=1) == b"1,2,3,"


def test_it_holds_the_type_if_any_request_names_one() -> None:
    it = subscribed()
    typed = [it.subscription.typed]
    it.request("typed", type="std_msgs/Int32")
    typed.append(it.subscription.typed)
    it.subscription.cancel("typed")
    typed.append(it.subscription.typed)
    it.request("typed", type="std_msgs/Int32")
    it.subscription.cancel(None)
    typed.append(it.subscription.typed)
    assert typed == [False, True, False, False]


def test_it_complains_once_of_what_it_cannot_have_to_who_asked_for_that() -> None:
    it = Subscriber()
    for id_, compression in (("a", "none"), ("b", "png"), ("c", "cbor-raw"), ("d", "cbor")):
        it.request(id_, compression=compression)
    for _ in range(3):
        it.subscription.refuse(OperationError("no such encoding"))
    assert it.complaints == [("c", "subscribe: no such encoding")]


def test_so_many_requests_are_enough() -> None:
    it = Subscriber()
    for id_ in range(MAX_REGISTRATIONS):
        it.request(id_)
    it.request(5, queue_length=7)
    with pytest.raises(OperationError, match="100 subscriptions to one topic are enough"):
        it.request("another")
    assert list(it.subscription.requests) == list(range(MAX_REGISTRATIONS))
    it.subscription.cancel(5)
    it.request("another")
