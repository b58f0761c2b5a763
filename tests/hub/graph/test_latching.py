"""What those who come later still hear."""

from __future__ import annotations

import pytest

from ..fakes import INT32, Client, FakeHub, number, talker_and_listener


def latched(hub: FakeHub, node: str, *messages: int, topic: str = "/fib") -> Client:
    client = hub.client(node)
    client.says("advertise", topic, type=INT32, latch=True)
    for each in messages:
        client.says("publish", topic, msg=number(each))
    return client


def test_a_later_subscriber_hears_the_last_message_of_each_latching_publisher() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1, 2)
    latched(hub, "/b", 3)
    latched(hub, "/silent")
    listener = hub.client()
    listener.says("subscribe", "/fib")
    assert listener.hears_numbers("/fib") == [2, 3]


def test_a_latched_message_comes_once_with_each_subscribe() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener, other = hub.client(), hub.client()
    other.says("subscribe", "/fib")
    for times in range(1, 4):
        listener.says("subscribe", "/fib", id=times)
        assert listener.hears_numbers("/fib") == [1]
    assert other.hears_numbers("/fib") == [1]


def test_a_latched_message_passes_by_the_throttle() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener = hub.client()
    for _ in range(2):
        listener.says("subscribe", "/fib", throttle_rate=1000)
    assert listener.hears_numbers("/fib") == [1, 1]


def test_a_latched_message_is_heard_under_the_name_as_it_was_spelled() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener = hub.client()
    listener.says("subscribe", "fib")
    assert listener.hears_numbers("fib") == [1]


@pytest.mark.parametrize(("latch", "heard"), [(True, [1]), (False, [])])
def test_the_first_registration_decides_on_latching(latch: bool, heard: list[int]) -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/fib", type=INT32, id="a", latch=latch)
    talker.says("advertise", "/fib", type=INT32, id="b", latch=not latch)
    talker.says("publish", "/fib", msg=number(1), latch=not latch)
    listener.says("subscribe", "/fib")
    assert listener.hears_numbers("/fib") == heard


def test_the_publish_that_advertises_may_latch() -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other, late = hub.client(), hub.client()
    other.says("publish", "/fib", msg=number(5), latch=True)
    late.says("subscribe", "/fib")
    assert late.hears_numbers("/fib") == [5]


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_a_latched_message_goes_with_its_publisher(end: str) -> None:
    hub = FakeHub()
    talker = latched(hub, "/a", 1)
    other = latched(hub, "/b", 2)
    if end == "leave":
        talker.leaves()
    else:
        talker.says("unadvertise", "/fib")
    listener = hub.client()
    listener.says("subscribe", "/fib")
    assert listener.hears_numbers("/fib") == [2]
    assert other.hears() == []


def test_a_latched_message_leaves_at_once() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener = hub.client()
    listener.says("subscribe", "/fib")
    assert len(listener.writes) == 1
    listener.says("subscribe", "/other")
    assert len(listener.writes) == 1
