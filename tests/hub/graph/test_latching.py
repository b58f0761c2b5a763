"""What those who come later still hear."""

from __future__ import annotations

import pytest

from fibws.hub.outbox import MOST_UNWRITTEN

from ..fakes import INT32, STRING, Client, FakeHub, number, talker_and_listener


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


def test_who_asks_again_and_again_does_not_fill_the_memory() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/a", type=STRING, latch=True)
    talker.says("publish", "/a", msg={"data": "x" * 10**6})
    for id_ in range(50):
        listener.says("subscribe", "/a", id=id_)
        assert sum(map(len, listener.outbox.frames)) <= MOST_UNWRITTEN + 2 * 10**6
    assert listener.writes
    assert len(listener.hears_messages("/a")) == 50


# How much may be latched.

EIGHT = {"data": "x" * 8}
"""A message whose JSON has 19 bytes."""


def test_what_is_too_large_to_be_kept_is_sent_all_the_same_and_its_talker_told() -> None:
    hub = FakeHub(max_latched_bytes=18)
    talker, listener, late = hub.client(), hub.client(), hub.client()
    talker.says("advertise", "/a", type=STRING, latch=True)
    listener.says("subscribe", "/a")
    talker.says("publish", "/a", msg=EIGHT, id="p")
    [told] = talker.hears()
    assert (told["level"], told["id"]) == ("error", "p")
    assert told["msg"] == (
        "publish: a latched message of /a was sent but not kept: those of one client may have "
        "18 bytes together (--max-latched-bytes)"
    )
    assert listener.hears_messages("/a") == [EIGHT]
    late.says("subscribe", "/a")
    assert late.hears() == []


def test_what_cannot_be_kept_takes_the_older_message_along() -> None:
    """An old message that is taken for the last one would be worse than none."""
    hub = FakeHub(max_latched_bytes=19)
    talker, late = hub.client(), hub.client()
    talker.says("advertise", "/a", type=STRING, latch=True)
    talker.says("publish", "/a", msg=EIGHT)
    talker.says("publish", "/a", msg={"data": "x" * 9})
    assert len(talker.hears_statuses()) == 1
    late.says("subscribe", "/a")
    assert late.hears() == []
    talker.says("publish", "/a", msg=EIGHT)
    late.says("subscribe", "/a", id="again")
    assert [*late.hears_messages("/a"), *talker.hears()] == [EIGHT, EIGHT]


def test_all_that_one_client_latches_counts_together() -> None:
    hub = FakeHub(max_latched_bytes=40)
    talker, other = hub.client(), hub.client()
    for client, topics in ((talker, ("/a", "/b", "/c")), (other, ("/d",))):
        for topic in topics:
            client.says("advertise", topic, type=STRING, latch=True)
            for _ in range(3):
                client.says("publish", topic, msg=EIGHT)
    assert len(talker.hears_statuses()) == 3
    assert other.hears() == []
    talker.says("unadvertise", "/a")
    talker.says("publish", "/c", msg=EIGHT)
    assert talker.hears() == []
    talker.leaves()
    assert talker.forgotten


def test_what_is_not_latched_does_not_count() -> None:
    client = FakeHub(max_latched_bytes=0).client()
    client.says("advertise", "/a", type=STRING)
    client.says("publish", "/a", msg=EIGHT)
    assert client.hears() == []


def test_characters_count_as_the_bytes_that_they_take() -> None:
    client = FakeHub(max_latched_bytes=19).client()
    client.says("advertise", "/a", type=STRING, latch=True)
    client.says("publish", "/a", msg={"data": "ä" * 8})
    assert len(client.hears_statuses()) == 1


def test_a_latched_message_has_the_header_that_it_was_published_with() -> None:
    hub = FakeHub()
    talker, plain, asking = hub.client("/talker"), hub.client(), hub.client()
    talker.says("advertise", "/fib", type=INT32, latch=True, headers={"user": "ann"})
    talker.says("publish", "/fib", msg=number(1))
    for _ in range(2):
        plain.says("subscribe", "/fib")
        asking.says("subscribe", "/fib", headers=True)
        [heard] = asking.hears()
        assert heard["header"] == {"callerid": "/talker", "latching": "1", "user": "ann"}
        [heard] = plain.hears()
        assert "header" not in heard
