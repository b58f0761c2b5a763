"""Throttles and queues, as a client gets to know them."""

from __future__ import annotations

import pytest

from ..fakes import INT32, STRING, FakeHub, number, talker_and_listener


def test_a_throttle_passes_over_what_comes_too_early() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.says("subscribe", "/fib", throttle_rate=300)
    for each in range(12):
        hub.clock.advance_to(each / 10)
        talker.says("publish", "/fib", msg=number(each))
    assert listener.hears_numbers("/fib") == [0, 3, 6, 9]


def test_of_two_requests_the_faster_counts() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/fib", type=INT32)
    listener.says("subscribe", "/fib", id="slow", throttle_rate=1000)
    listener.says("subscribe", "/fib", id="fast", throttle_rate=200)
    for each in range(6):
        hub.clock.advance_to(each / 10)
        talker.says("publish", "/fib", msg=number(each))
    assert listener.hears_numbers("/fib") == [0, 2, 4]


def test_a_slow_client_keeps_the_newest_of_what_it_asked_for() -> None:
    hub = FakeHub(queue_length=3)
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/fib", type=INT32)
    talker.says("advertise", "/short", type=INT32)
    listener.says("subscribe", "/fib")
    listener.says("subscribe", "/short", queue_length=1)
    listener.outbox.pause()
    for each in range(9):
        talker.says("publish", "/fib", msg=number(each))
        talker.says("publish", "/short", msg=number(each))
    listener.outbox.resume()
    assert [(each["topic"], each["msg"]["data"]) for each in listener.hears()] == [
        ("/fib", 6),
        ("/fib", 7),
        ("/fib", 8),
        ("/short", 8),
    ]


def test_a_throttle_keeps_no_more_bytes_than_the_client_may_have() -> None:
    hub = FakeHub(max_queued_bytes=2000)
    client = hub.client()
    client.says("advertise", "/a", type=STRING)
    client.says("subscribe", "/a", throttle_rate=1000, queue_length=10**6)
    for _ in range(100):
        client.says("publish", "/a", msg={"data": "x" * 200})
    hub.clock.advance(1000)
    assert len(client.hears()) <= 11


def test_many_throttles_keep_no_more_bytes_than_the_client_may_have() -> None:
    hub = FakeHub(max_queued_bytes=2000)
    client = hub.client()
    for each in range(50):
        client.says("advertise", f"/a{each}", type=STRING)
        client.says("subscribe", f"/a{each}", throttle_rate=1000, queue_length=10)
        for _ in range(2):
            client.says("publish", f"/a{each}", msg={"data": "x" * 200})
            assert client.outbox.budget.used <= 2000
    client.leaves()
    assert client.outbox.budget.used == 0


@pytest.mark.parametrize("queue_length", [-5, 2**31, 2**100])
def test_any_number_is_a_queue_length(queue_length: int) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("advertise", "/fib", type=INT32)
    client.says("subscribe", "/fib", throttle_rate=100, queue_length=queue_length)
    client.says("publish", "/fib", msg=number(1))
    assert client.hears_numbers("/fib") == [1]
    client.leaves()
    assert hub.empty
