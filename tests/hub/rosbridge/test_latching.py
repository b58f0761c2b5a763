"""Latched messages."""

from __future__ import annotations

import pytest

from fibws.hub.delivery.send_queue import MOST_UNWRITTEN

from ..fakes import INT32, STRING, Client, FakeHub, number, talker_and_listener


def latched(hub: FakeHub, node: str, *messages: int, topic: str = "/fib") -> Client:
    client = hub.client(node)
    client.send("advertise", topic, type=INT32, latch=True)
    for each in messages:
        client.send("publish", topic, msg=number(each))
    return client


def test_late_subscriber_gets_the_last_message_of_each_latching_publisher() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1, 2)
    latched(hub, "/b", 3)
    latched(hub, "/silent")
    listener = hub.client()
    listener.send("subscribe", "/fib")
    assert listener.receive_numbers("/fib") == [2, 3]


def test_latched_message_comes_once_with_each_subscribe() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener, other = hub.client(), hub.client()
    other.send("subscribe", "/fib")
    for times in range(1, 4):
        listener.send("subscribe", "/fib", id=times)
        assert listener.receive_numbers("/fib") == [1]
    assert other.receive_numbers("/fib") == [1]


def test_latched_message_ignores_the_throttle() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener = hub.client()
    for _ in range(2):
        listener.send("subscribe", "/fib", throttle_rate=1000)
    assert listener.receive_numbers("/fib") == [1, 1]


def test_latched_message_has_the_subscribers_spelling() -> None:
    hub = FakeHub()
    latched(hub, "/a", 1)
    listener = hub.client()
    listener.send("subscribe", "fib")
    assert listener.receive_numbers("fib") == [1]


@pytest.mark.parametrize(("latch", "received"), [(True, [1]), (False, [])])
def test_first_advertisement_decides_on_latching(latch: bool, received: list[int]) -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/fib", type=INT32, id="a", latch=latch)
    talker.send("advertise", "/fib", type=INT32, id="b", latch=not latch)
    talker.send("publish", "/fib", msg=number(1), latch=not latch)
    listener.send("subscribe", "/fib")
    assert listener.receive_numbers("/fib") == received


def test_publish_that_advertises_may_latch() -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other, late = hub.client(), hub.client()
    other.send("publish", "/fib", msg=number(5), latch=True)
    late.send("subscribe", "/fib")
    assert late.receive_numbers("/fib") == [5]


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_latched_message_is_forgotten_with_its_publisher(end: str) -> None:
    hub = FakeHub()
    talker = latched(hub, "/a", 1)
    other = latched(hub, "/b", 2)
    if end == "leave":
        talker.disconnect()
    else:
        talker.send("unadvertise", "/fib")
    listener = hub.client()
    listener.send("subscribe", "/fib")
    assert listener.receive_numbers("/fib") == [2]
    assert other.receive() == []


@pytest.mark.long
def test_repeated_subscribes_do_not_fill_the_memory() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type=STRING, latch=True)
    talker.send("publish", "/a", msg={"data": "x" * 10**6})
    for id_ in range(50):
        listener.send("subscribe", "/a", id=id_)
        assert sum(map(len, listener.queue.frames)) <= MOST_UNWRITTEN + 2 * 10**6
    assert listener.writes
    assert len(listener.receive_messages("/a")) == 50


# How much may be latched.

EIGHT = {"data": "x" * 8}
"""A message of 12 bytes in ROS 1's serialization, in which it is kept."""


def test_message_too_large_to_latch_is_delivered_and_reported() -> None:
    hub = FakeHub(max_latched_bytes=11)
    talker, listener, late = hub.client(), hub.client(), hub.client()
    talker.send("advertise", "/a", type=STRING, latch=True)
    listener.send("subscribe", "/a")
    talker.send("publish", "/a", msg=EIGHT, id="p")
    [status] = talker.receive()
    assert (status["level"], status["id"]) == ("error", "p")
    assert status["msg"].startswith("publish: ")
    assert all(each in status["msg"] for each in ("/a", "11 bytes", "--max-latched-bytes"))
    assert listener.receive_messages("/a") == [EIGHT]
    late.send("subscribe", "/a")
    assert late.receive() == []


def test_message_too_large_to_latch_removes_the_older_one() -> None:
    """An old message that is taken for the last one would be worse than none."""
    hub = FakeHub(max_latched_bytes=12)
    talker, late = hub.client(), hub.client()
    talker.send("advertise", "/a", type=STRING, latch=True)
    talker.send("publish", "/a", msg=EIGHT)
    talker.send("publish", "/a", msg={"data": "x" * 9})
    assert len(talker.receive_statuses()) == 1
    late.send("subscribe", "/a")
    assert late.receive() == []
    talker.send("publish", "/a", msg=EIGHT)
    late.send("subscribe", "/a", id="again")
    assert [*late.receive_messages("/a"), *talker.receive()] == [EIGHT, EIGHT]


def test_latched_messages_of_one_client_count_together() -> None:
    hub = FakeHub(max_latched_bytes=25)
    talker, other = hub.client(), hub.client()
    for client, topics in ((talker, ("/a", "/b", "/c")), (other, ("/d",))):
        for topic in topics:
            client.send("advertise", topic, type=STRING, latch=True)
            for _ in range(3):
                client.send("publish", topic, msg=EIGHT)
    assert len(talker.receive_statuses()) == 3
    assert other.receive() == []
    talker.send("unadvertise", "/a")
    talker.send("publish", "/c", msg=EIGHT)
    assert talker.receive() == []
    talker.disconnect()
    assert talker.forgotten


def test_client_is_told_that_its_oldest_messages_are_latched_no_more() -> None:
    hub = FakeHub()
    talker, late = hub.client(), hub.client()
    for topic in ("/a", "/b", "/c"):
        talker.send("advertise", topic, type=STRING, latch=True)
        talker.send("publish", topic, msg=EIGHT)
    [quota] = hub.graph.latched.quotas
    quota.shorten(30, "too many bytes (--max-memory)")
    [text] = talker.receive_statuses()
    assert "/a" in text and "(--max-memory)" in text
    for topic, kept in (("/a", []), ("/b", [EIGHT]), ("/c", [EIGHT])):
        late.send("subscribe", topic)
        assert late.receive_messages(topic) == kept
    assert (hub.graph.latched.used, hub.graph.latched.dropped) == (24, 1)
    talker.disconnect()
    assert (hub.graph.latched.used, hub.graph.latched.quotas) == (0, {})


def test_unlatched_messages_do_not_count() -> None:
    client = FakeHub(max_latched_bytes=0).client()
    client.send("advertise", "/a", type=STRING)
    client.send("publish", "/a", msg=EIGHT)
    assert client.receive() == []


def test_latched_characters_count_as_bytes() -> None:
    client = FakeHub(max_latched_bytes=19).client()
    client.send("advertise", "/a", type=STRING, latch=True)
    client.send("publish", "/a", msg={"data": "ä" * 8})
    assert len(client.receive_statuses()) == 1


def test_latched_message_has_the_header_that_it_was_published_with() -> None:
    hub = FakeHub()
    talker, plain, asking = hub.client("/talker"), hub.client(), hub.client()
    talker.send("advertise", "/fib", type=INT32, latch=True, headers={"user": "ann"})
    talker.send("publish", "/fib", msg=number(1))
    for _ in range(2):
        plain.send("subscribe", "/fib")
        asking.send("subscribe", "/fib", headers=True)
        [received] = asking.receive()
        assert received["header"] == {"callerid": "/talker", "latching": "1", "user": "ann"}
        [received] = plain.receive()
        assert "header" not in received
