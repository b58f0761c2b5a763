"""The topics that one client publishes and subscribes to."""

from __future__ import annotations

import json

import pytest

from ..fakes import ADD, FIBONACCI, INT32, STRING, FakeHub, number, talker_and_listener


def test_number_of_advertised_topics_is_limited() -> None:
    hub = FakeHub(max_advertisements=2)
    other, client = hub.client(), hub.client()
    other.send("advertise", "/d", type=INT32)
    for topic in ("/a", "/b", "/c", "a", "/a"):
        client.send("advertise", topic, type=INT32, id=topic)
    client.send("publish", "/d", msg=number(1))
    statuses = client.receive_statuses()
    assert [text.partition(":")[0] for text in statuses] == ["advertise", "advertise", "publish"]
    assert all("limit 2, --max-advertisements" in text for text in statuses)
    assert sorted(hub.graph.topics) == ["/a", "/b", "/d"]
    client.send("unadvertise", "/a")
    client.send("publish", "/d", msg=number(1))
    assert client.receive() == []


def test_number_of_subscribed_topics_is_limited() -> None:
    hub = FakeHub(max_subscriptions=2)
    client = hub.client()
    for topic in ("/a", "/b", "/c", "a", "/a"):
        client.send("subscribe", topic, id="s")
    statuses = client.receive_statuses()
    assert [text.partition(":")[0] for text in statuses] == ["subscribe"] * 2
    assert all("limit 2, --max-subscriptions" in text for text in statuses)
    assert sorted(hub.graph.topics) == ["/a", "/b"]
    client.send("unsubscribe", "/a")
    client.send("subscribe", "/c")
    assert client.receive() == []


def test_advertisements_and_subscriptions_are_limited_separately() -> None:
    client = FakeHub(max_advertisements=1, max_subscriptions=1).client()
    client.send("advertise", "/a", type=INT32)
    client.send("subscribe", "/b")
    client.send("advertise_service", service="/c", type="std_srvs/Empty")
    client.send("advertise_action", action="/d", type="example_interfaces/Fibonacci")
    assert client.receive() == []


def test_session_lists_the_topics_of_its_client() -> None:
    client = FakeHub().client("/talker")
    for topic in ("/a", "a", "~b"):
        client.send("advertise", topic, type=INT32)
    for topic in ("/c", "c", "~d"):
        client.send("subscribe", topic)
    assert client.session.publishing() == {"/a", "/talker/b"}
    assert client.session.subscribing() == {"/c", "/talker/d"}
    client.disconnect()
    assert client.session.publishing() == client.session.subscribing() == set()


def test_both_spellings_share_one_publisher() -> None:
    hub = FakeHub()
    client = hub.client("/talker")
    for spelling in ("/a", "a"):
        client.send("advertise", spelling, type=INT32, id=spelling)
    publishers = client.session.topics.sources
    assert publishers["/a"] is publishers["a"]
    client.send("unadvertise", "/a", id="/a")
    assert list(hub.graph.topics["/a"].sources) == ["/talker"]
    client.send("unadvertise", "/a", id="a")
    assert client.forgotten
    assert hub.graph.topics == {}


def test_leaving_client_removes_only_its_own_registrations() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub, latch=True)
    talker.send("publish", "/fib", msg=number(1))
    talker.send("subscribe", "/fib", throttle_rate=100, queue_length=10)
    talker.disconnect()
    assert talker.forgotten
    assert list(hub.graph.topics["/fib"].subscribers()) == ["/listener"]
    assert hub.clock.timers == 0
    listener.disconnect()
    assert hub.empty


@pytest.mark.parametrize("op", ["advertise", "subscribe", "publish"])
def test_refused_operations_leave_nothing(op: str) -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    client = hub.client()
    client.send(op, "/fib", type="std_msgs/Strin", msg={"data": "x"})
    assert len(client.receive_statuses()) == 1
    client.send("unadvertise", "/fib")
    assert client.forgotten


def test_unknown_fields_of_a_publish_are_ignored() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send("publish", "/fib", msg=number(1), type=STRING, latch=True, queue_size="many")
    assert listener.receive_numbers("/fib") == [1]
    assert talker.receive() == []


def test_subscriber_that_asks_for_headers_gets_the_publishers_header() -> None:
    hub = FakeHub()
    talker, plain, asking = hub.client("/talker"), hub.client(), hub.client()
    asking.send("subscribe", "/fib", headers=True)
    plain.send("subscribe", "/fib")
    own = {"callerid": "/talker", "latching": "0"}
    for headers in (None, {"user": "ann"}, None, {"team": "red"}, {}):
        talker.send("advertise", "/fib", type=INT32, headers=headers)
        talker.send("publish", "/fib", msg=number(1), header={"callerid": "/liar"})
    assert [each["header"] for each in asking.receive()] == [
        own,
        {**own, "user": "ann"},
        {**own, "user": "ann"},
        {**own, "team": "red"},
        own,
    ]
    assert all(each.keys() == {"op", "topic", "msg"} for each in plain.receive())


def test_each_publisher_has_its_own_header() -> None:
    hub = FakeHub()
    asking = hub.client()
    asking.send("subscribe", "/fib", headers=True)
    for name in ("/a", "/b"):
        talker = hub.client(name)
        talker.send("advertise", "/fib", type=INT32, headers={"name": name[1:]})
        talker.send("publish", "/fib", msg=number(1))
    headers = [each["header"] for each in asking.receive()]
    assert [(each["callerid"], each["name"]) for each in headers] == [("/a", "a"), ("/b", "b")]


def test_message_for_one_node_reaches_only_that_node() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub, latch=True)
    other = hub.client("/other")
    other.send("subscribe", "/fib")
    talker.send("publish", "/fib", msg=number(1), to="/listener")
    talker.send("publish", "/fib", msg=number(2), to=None)
    talker.send("publish", "/fib", msg=number(3), to="other")
    talker.send("publish", "/fib", msg=number(4), to="/nobody")
    assert listener.receive_numbers("/fib") == [1, 2]
    assert other.receive_numbers("/fib") == [2, 3]
    late = hub.client("/late")
    late.send("subscribe", "/fib")
    assert late.receive_numbers("/fib") == [2]
    assert talker.receive() == []


def test_message_for_one_node_needs_no_advertisement() -> None:
    hub = FakeHub()
    talker, listener, early = (hub.client(name) for name in ("/talker", "/listener", "/early"))
    early.send("publish", "/fib", msg=number(1), to="/listener")
    talker.send("subscribe", "/fib", type=INT32)
    listener.send("subscribe", "/fib", type=INT32)
    early.send("publish", "/fib", msg=number(2), to="/talker")
    assert listener.receive_numbers("/fib") == [1]
    assert talker.receive_numbers("/fib") == [2]


@pytest.mark.parametrize(
    ("to", "fault"), [(5, "Expected field to to be one of str"), ("a b", "'a b' is not")]
)
@pytest.mark.parametrize("advertised", [True, False])
def test_message_for_an_invalid_node_name_is_refused(
    to: object, fault: str, advertised: bool
) -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    publisher = talker if advertised else hub.client()
    publisher.send("publish", "/fib", msg=number(1), to=to)
    [status] = publisher.receive_statuses()
    assert fault in status
    assert listener.receive() == []


# Spellings of names.


@pytest.mark.parametrize(
    ("node", "spelling", "name"),
    [
        ("/talker", "fib", "/fib"),
        ("/talker", "/fib", "/fib"),
        ("/talker", "~fib", "/talker/fib"),
        ("/robot/arm", "~pid/gain", "/robot/arm/pid/gain"),
        (None, "~fib", "/rosbridge_websocket/fib"),
        ("/talker", "/a-b", "/a-b"),
        ("/talker", "a.b", "/a.b"),
        ("/talker", "1st", "/1st"),
        ("/talker", "/x//y", "/x/y"),
        ("/talker", "/tr/", "/tr"),
        ("/talker", "/übung", "/übung"),
        ("/talker", "/uuid/3f2a-77", "/uuid/3f2a-77"),
        ("/talker", "~/fib-1", "/talker/fib-1"),
    ],
)
def test_names_resolve_under_the_clients_node(node: str | None, spelling: str, name: str) -> None:
    hub = FakeHub()
    hub.client(node).send("advertise", spelling, type=INT32)
    assert list(hub.graph.topics) == [name]


def test_each_subscriber_gets_its_own_spelling() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client()
    other.send("subscribe", "fib")
    talker.send("publish", "fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]
    assert other.receive_numbers("fib") == [1]


def test_client_may_use_both_spellings_at_once() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.send("subscribe", "fib", throttle_rate=1000)
    for each in range(2):
        talker.send("publish", "/fib", msg=number(each))
    received = [(each["topic"], each["msg"]["data"]) for each in listener.receive()]
    assert sorted(received) == [("/fib", 0), ("/fib", 1), ("fib", 0)]
    listener.send("unsubscribe", "/fib")
    hub.clock.advance(1)
    talker.send("publish", "/fib", msg=number(2))
    assert listener.receive_numbers("fib") == [2]


def test_sequence_numbers_are_shared_by_both_spellings() -> None:
    client = FakeHub().client()
    client.send("subscribe", "/a", type="rospy_tutorials/HeaderString")
    for spelling in ("/a", "a", "/a"):
        client.send("publish", spelling)
    assert [msg["header"]["seq"] for msg in client.receive_messages("/a")] == [1, 2, 3]


def test_private_names_of_clients_without_a_name_are_the_same() -> None:
    hub = FakeHub()
    talker, listener, named = hub.client(), hub.client(), hub.client("/named")
    for client in (listener, named):
        client.send("subscribe", "~priv", type=INT32)
    talker.send("publish", "~priv", msg=number(1))
    assert listener.receive_numbers("~priv") == [1]
    assert named.receive() == []


def test_name_that_a_client_has_chosen_is_no_longer_without_a_name() -> None:
    hub = FakeHub()
    older = hub.client()
    hub.client(older.session.node).send("advertise", "~a", type=INT32)
    assert older.closings
    assert list(hub.graph.topics) == [f"{older.session.node}/a"]


def test_spellings_with_empty_parts_are_one_topic() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    spellings = ["/x/y", "/x//y", "/x/y/", "//x/y"]
    for spelling in spellings:
        listener.send("subscribe", spelling)
    talker.send("advertise", "/x//y", type=INT32)
    talker.send("publish", "/x//y", msg=number(1))
    assert [each["topic"] for each in listener.receive()] == spellings
    assert list(hub.graph.topics) == ["/x/y"]


@pytest.mark.parametrize(
    "fields",
    [
        {"op": "advertise", "topic": "/a-b", "type": INT32},
        {"op": "subscribe", "topic": "/a-b", "type": INT32},
        {"op": "advertise_service", "service": "/a-b", "type": ADD},
        {"op": "advertise_action", "action": "/a-b", "type": FIBONACCI},
    ],
)
def test_name_that_is_not_legal_gives_a_warning(fields: dict[str, str]) -> None:
    client = FakeHub().client()
    client.send("set_level", level="warning")
    client.send_text(json.dumps({**fields, "id": "x"}))
    status = client.receive_one("status")
    assert (status["id"], status["level"]) == ("x", "warning")
    assert "'/a-b' is not a legal ROS graph name" in status["msg"]


def test_publishing_a_name_that_is_not_legal_gives_one_warning() -> None:
    client = FakeHub().client()
    client.send("set_level", level="warning")
    client.send("subscribe", "/tr", type=INT32)
    for _ in range(3):
        client.send("publish", "/tr/", msg=number(1))
    assert [each["op"] for each in client.receive()].count("status") == 1


@pytest.mark.parametrize(
    "name", ["", "/", "//", "~", "a b", "/a\n", "a\x1b[0m", "\u202ea", "/a\u00a0b", "a" * 1025]
)
@pytest.mark.parametrize("op", ["advertise", "publish", "subscribe"])
def test_invalid_name_is_refused(op: str, name: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.send(op, name, type=INT32, id="x")
    [status] = client.receive()
    assert (status["id"], status["level"]) == ("x", "error")
    shown = name if len(name) < 100 else f"{name[:40]}..."
    assert status["msg"].startswith(f"{op}: {shown!r} is not a legal name")
    assert hub.graph.topics == {}
