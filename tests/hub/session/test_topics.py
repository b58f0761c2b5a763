"""The topics that one client publishes and subscribes to."""

from __future__ import annotations

import pytest

from ..fakes import INT32, STRING, FakeHub, number, talker_and_listener


def test_a_client_may_advertise_so_many_topics_and_no_more() -> None:
    hub = FakeHub(max_advertisements=2)
    other, client = hub.client(), hub.client()
    other.says("advertise", "/d", type=INT32)
    for topic in ("/a", "/b", "/c", "a", "/a"):
        client.says("advertise", topic, type=INT32, id=topic)
    client.says("publish", "/d", msg=number(1))
    fault = "One client may have 2 advertisements, not more (--max-advertisements of the hub)"
    assert client.hears_statuses() == [
        f"advertise: {fault}",
        f"advertise: {fault}",
        f"publish: {fault}",
    ]
    assert sorted(hub.graph.topics) == ["/a", "/b", "/d"]
    client.says("unadvertise", "/a")
    client.says("publish", "/d", msg=number(1))
    assert client.hears() == []


def test_a_client_may_subscribe_to_so_many_topics_and_no_more() -> None:
    hub = FakeHub(max_subscriptions=2)
    client = hub.client()
    for topic in ("/a", "/b", "/c", "a", "/a"):
        client.says("subscribe", topic, id="s")
    fault = "One client may have 2 subscriptions, not more (--max-subscriptions of the hub)"
    assert client.hears_statuses() == [f"subscribe: {fault}"] * 2
    assert sorted(hub.graph.topics) == ["/a", "/b"]
    client.says("unsubscribe", "/a")
    client.says("subscribe", "/c")
    assert client.hears() == []


def test_what_is_published_does_not_count_as_subscribed() -> None:
    client = FakeHub(max_advertisements=1, max_subscriptions=1).client()
    client.says("advertise", "/a", type=INT32)
    client.says("subscribe", "/b")
    client.says("advertise_service", service="/c", type="std_srvs/Empty")
    client.says("advertise_action", action="/d", type="example_interfaces/Fibonacci")
    assert client.hears() == []


def test_the_session_tells_which_topics_its_client_has_to_do_with() -> None:
    client = FakeHub().client("/talker")
    for topic in ("/a", "a", "~b"):
        client.says("advertise", topic, type=INT32)
    for topic in ("/c", "c", "~d"):
        client.says("subscribe", topic)
    assert client.session.publishing() == {"/a", "/talker/b"}
    assert client.session.subscribing() == {"/c", "/talker/d"}
    client.leaves()
    assert client.session.publishing() == client.session.subscribing() == set()


def test_both_spellings_are_one_publisher_that_stands_while_either_does() -> None:
    hub = FakeHub()
    client = hub.client("/talker")
    for spelling in ("/a", "a"):
        client.says("advertise", spelling, type=INT32, id=spelling)
    publishers = client.session.topics.publishers
    assert publishers["/a"] is publishers["a"]
    client.says("unadvertise", "/a", id="/a")
    assert list(hub.graph.topics["/a"].publishers) == ["/talker"]
    client.says("unadvertise", "/a", id="a")
    assert client.forgotten
    assert hub.graph.topics == {}


def test_a_client_that_leaves_takes_its_own_and_nothing_else() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub, latch=True)
    talker.says("publish", "/fib", msg=number(1))
    talker.says("subscribe", "/fib", throttle_rate=100, queue_length=10)
    talker.leaves()
    assert talker.forgotten
    assert [each.node for each in hub.graph.topics["/fib"].subscriptions()] == ["/listener"]
    assert hub.clock.timers == 0
    listener.leaves()
    assert hub.empty


@pytest.mark.parametrize("op", ["advertise", "subscribe", "publish"])
def test_what_is_refused_is_not_kept(op: str) -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    client = hub.client()
    client.says(op, "/fib", type=STRING, msg={"data": "x"})
    assert len(client.hears_statuses()) == 1
    client.says("unadvertise", "/fib")
    assert client.forgotten


def test_a_publish_of_another_type_than_the_field_says_is_an_ordinary_publish() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says("publish", "/fib", msg=number(1), type=STRING, latch=True, queue_size="many")
    assert listener.hears_numbers("/fib") == [1]
    assert talker.hears() == []
