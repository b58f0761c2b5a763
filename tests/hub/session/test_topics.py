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


def test_who_asks_for_headers_is_told_what_the_publisher_says_of_itself() -> None:
    hub = FakeHub()
    talker, plain, asking = hub.client("/talker"), hub.client(), hub.client()
    asking.says("subscribe", "/fib", headers=True)
    plain.says("subscribe", "/fib")
    own = {"callerid": "/talker", "latching": "0"}
    for headers in (None, {"user": "ann"}, None, {"team": "red"}, {}):
        talker.says("advertise", "/fib", type=INT32, headers=headers)
        talker.says("publish", "/fib", msg=number(1), header={"callerid": "/liar"})
    assert [each["header"] for each in asking.hears()] == [
        own,
        {**own, "user": "ann"},
        {**own, "user": "ann"},
        {**own, "team": "red"},
        own,
    ]
    assert all(each.keys() == {"op", "topic", "msg"} for each in plain.hears())


def test_of_two_publishers_each_has_its_own_header() -> None:
    hub = FakeHub()
    asking = hub.client()
    asking.says("subscribe", "/fib", headers=True)
    for name in ("/a", "/b"):
        talker = hub.client(name)
        talker.says("advertise", "/fib", type=INT32, headers={"name": name[1:]})
        talker.says("publish", "/fib", msg=number(1))
    headers = [each["header"] for each in asking.hears()]
    assert [(each["callerid"], each["name"]) for each in headers] == [("/a", "a"), ("/b", "b")]


def test_a_message_may_be_for_one_node_alone() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub, latch=True)
    other = hub.client("/other")
    other.says("subscribe", "/fib")
    talker.says("publish", "/fib", msg=number(1), to="/listener")
    talker.says("publish", "/fib", msg=number(2), to=None)
    talker.says("publish", "/fib", msg=number(3), to="other")
    talker.says("publish", "/fib", msg=number(4), to="/nobody")
    assert listener.hears_numbers("/fib") == [1, 2]
    assert other.hears_numbers("/fib") == [2, 3]
    late = hub.client("/late")
    late.says("subscribe", "/fib")
    assert late.hears_numbers("/fib") == [2]
    assert talker.hears() == []


def test_a_message_for_one_node_need_not_be_announced() -> None:
    hub = FakeHub()
    talker, listener, early = (hub.client(name) for name in ("/talker", "/listener", "/early"))
    early.says("publish", "/fib", msg=number(1), to="/listener")
    talker.says("subscribe", "/fib", type=INT32)
    listener.says("subscribe", "/fib", type=INT32)
    early.says("publish", "/fib", msg=number(2), to="/talker")
    assert listener.hears_numbers("/fib") == [1]
    assert talker.hears_numbers("/fib") == [2]


@pytest.mark.parametrize(
    ("to", "fault"), [(5, "Expected field to to be one of str"), ("a b", "'a b' is not")]
)
@pytest.mark.parametrize("advertised", [True, False])
def test_a_message_for_what_is_no_node_is_refused(to: object, fault: str, advertised: bool) -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    publisher = talker if advertised else hub.client()
    publisher.says("publish", "/fib", msg=number(1), to=to)
    [status] = publisher.hears_statuses()
    assert fault in status
    assert listener.hears() == []
