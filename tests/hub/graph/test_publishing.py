"""Who hears what is published, and until when."""

from __future__ import annotations

import pytest

from ..fakes import INT32, NANOSECONDS, STRING, FakeHub, number, talker_and_listener

# Publishing and subscribing.


def test_a_message_goes_to_who_subscribed() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    stranger = hub.client()
    talker.says("publish", "/fib", msg=number(8))
    assert listener.hears() == [{"op": "publish", "topic": "/fib", "msg": number(8)}]
    assert talker.hears() == stranger.hears() == []


def test_messages_come_in_order_and_none_is_lost() -> None:
    talker, listener = talker_and_listener(FakeHub())
    for each in range(20):
        talker.says("publish", "/fib", msg=number(each))
    assert listener.hears_numbers("/fib") == list(range(20))


def test_a_client_hears_its_own_messages() -> None:
    client = FakeHub().client()
    client.says("advertise", "/fib", type=INT32)
    client.says("subscribe", "/fib")
    client.says("publish", "/fib", msg=number(1))
    assert client.hears_numbers("/fib") == [1]


def test_several_subscriptions_of_one_client_bring_a_message_once() -> None:
    talker, listener = talker_and_listener(FakeHub())
    for id_ in ("a", "b", 5):
        listener.says("subscribe", "/fib", id=id_)
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]


def test_several_operations_may_come_in_one_text() -> None:
    hub = FakeHub()
    client = hub.client()
    client.says_text(
        '{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}\n'
        '{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a","msg":{"data":1}}'
    )
    assert client.hears_numbers("/a") == [1]


@pytest.mark.parametrize("msg", [{}, None])
def test_a_message_that_is_left_out_is_the_default(msg: object) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says("publish", "/fib", msg=msg)
    talker.says_text('{"op":"publish","topic":"/fib"}')
    assert listener.hears_numbers("/fib") == [0, 0]


def test_a_message_that_is_left_out_is_the_default_of_the_first_publish_too() -> None:
    hub = FakeHub()
    listener, other = hub.client(), hub.client()
    listener.says("subscribe", "/fib", type=INT32)
    other.says_text('{"op":"publish","topic":"/fib"}')
    assert listener.hears_numbers("/fib") == [0]


def test_fields_that_are_left_out_have_their_defaults() -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("advertise", "/cmd_vel", type="geometry_msgs/Twist")
    client.says("subscribe", "/cmd_vel")
    client.says("publish", "/cmd_vel", msg={"linear": {"x": 1.5}})
    zeros = {"x": 0.0, "y": 0.0, "z": 0.0}
    assert client.hears_messages("/cmd_vel") == [{"linear": {**zeros, "x": 1.5}, "angular": zeros}]


def test_a_header_is_stamped_and_counted() -> None:
    client = FakeHub().client()
    client.says("advertise", "/a", type="rospy_tutorials/HeaderString")
    client.says("subscribe", "/a")
    for data in "ab":
        client.says("publish", "/a", msg={"data": data})
    stamp = dict(zip(("secs", "nsecs"), divmod(NANOSECONDS, 10**9), strict=True))
    assert client.hears_messages("/a") == [
        {"header": {"seq": seq, "stamp": stamp, "frame_id": ""}, "data": data}
        for seq, data in [(1, "a"), (2, "b")]
    ]


@pytest.mark.parametrize(
    ("msg", "fault"),
    [
        ({"data": "8"}, "std_msgs/Int32 message requires a int32 for field data, but got a str"),
        ({"data": 2**31}, "2147483648 is not in -2147483648..2147483647"),
        ({"date": 8}, "Message type std_msgs/Int32 does not have a field date"),
        (8, "Expected a JSON object for type std_msgs/Int32 but received a int"),
        ([], "Expected a JSON object for type std_msgs/Int32 but received a list"),
    ],
)
def test_a_message_that_does_not_fit_is_refused(msg: object, fault: str) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says("publish", "/fib", msg=msg, id="p")
    [status] = talker.hears()
    assert status["id"] == "p"
    assert status["msg"].startswith("publish: ")
    assert fault in status["msg"]
    assert listener.hears() == []


def test_a_publish_advertises_if_the_type_is_known() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client("/other")
    other.says("publish", "/fib", msg=number(1))
    talker.leaves()
    other.says("publish", "/fib", msg=number(2))
    assert listener.hears_numbers("/fib") == [1, 2]
    assert list(hub.graph.topics["/fib"].publishers) == ["/other"]


def test_a_publish_of_an_unknown_topic_is_refused_and_leaves_nothing_behind() -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("publish", "/fib", msg=number(1), id=7)
    hub.clock.advance(3)
    assert client.hears() == [
        {
            "op": "status",
            "id": 7,
            "level": "error",
            "msg": "publish: Cannot infer topic type for topic /fib as it is not yet advertised",
        }
    ]
    assert hub.graph.topics == {}


def test_who_waits_for_a_type_does_not_make_one() -> None:
    hub = FakeHub()
    listener, talker = hub.client(), hub.client()
    listener.says("subscribe", "/fib")
    talker.says("publish", "/fib", msg=number(1))
    hub.clock.advance(3)
    assert "Cannot infer topic type" in talker.hears_statuses()[0]
    assert listener.hears() == []


def test_a_subscription_without_a_type_waits_for_one() -> None:
    hub = FakeHub()
    listener, talker = hub.client(), hub.client()
    listener.says("subscribe", "/fib")
    talker.says("advertise", "/fib", type=INT32)
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]


def test_a_subscription_outlives_its_publishers() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    talker.leaves()
    other = hub.client()
    other.says("advertise", "/fib", type=STRING)
    other.says("publish", "/fib", msg={"data": "now text"})
    assert listener.hears_messages("/fib") == [{"data": "now text"}]


# Unadvertising and unsubscribing.


def test_an_advertisement_is_taken_back_by_its_id() -> None:
    hub = FakeHub()
    client = hub.client()
    for id_ in ("a", 5, None):
        client.says("advertise", "/fib", type=INT32, id=id_)
    for id_ in ("a", 5, "unknown"):
        client.says("unadvertise", "/fib", id=id_)
    assert "/fib" in hub.graph.topics
    client.says("unadvertise", "/fib")
    assert hub.graph.topics == {}


def test_the_last_id_ends_the_publisher() -> None:
    hub = FakeHub()
    client = hub.client()
    for id_ in ("a", "b"):
        client.says("advertise", "/fib", type=INT32, id=id_)
    for id_ in ("b", "a"):
        client.says("unadvertise", "/fib", id=id_)
    assert hub.graph.topics == {}


def test_without_an_id_all_advertisements_of_the_topic_are_taken_back() -> None:
    hub = FakeHub()
    client = hub.client()
    for spelling in ("/fib", "fib"):
        client.says("advertise", spelling, type=INT32, id=spelling)
    client.says("unadvertise", "fib")
    assert not hub.graph.topics
    assert not client.session.topics.publishers


def test_a_publish_is_no_advertisement() -> None:
    hub = FakeHub()
    _, listener = talker_and_listener(hub)
    other = hub.client("/other")
    other.says("publish", "/fib", msg=number(1), id="P")
    other.says("advertise", "/fib", type=INT32, id="A")
    assert list(hub.graph.topics["/fib"].publishers) == ["/talker", "/other"]
    other.says("unadvertise", "/fib", id="A")
    assert list(hub.graph.topics["/fib"].publishers) == ["/talker"]
    assert not other.session.topics.publishers
    assert listener.hears_numbers("/fib") == [1]


def test_who_only_published_may_unadvertise() -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other = hub.client("/other")
    other.says("publish", "/fib", msg=number(1))
    other.says("unadvertise", "/fib", id="any")
    assert list(hub.graph.topics["/fib"].publishers) == ["/talker"]


def test_other_topics_of_the_client_are_left_as_they_are() -> None:
    hub = FakeHub()
    client = hub.client()
    for topic in ("/a", "/b"):
        client.says("advertise", topic, type=INT32)
    client.says("unadvertise", "/a")
    assert list(hub.graph.topics) == list(client.session.topics.publishers) == ["/b"]


def test_a_client_takes_back_only_what_is_its_own() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client("/other")
    other.says("advertise", "/fib", type=INT32)
    other.says("subscribe", "/fib")
    other.says("unadvertise", "/fib")
    other.says("unsubscribe", "/fib")
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]
    assert other.hears() == []


@pytest.mark.parametrize("op", ["unadvertise", "unsubscribe"])
@pytest.mark.parametrize("id_", [None, "a"])
def test_what_was_never_there_may_be_taken_back(op: str, id_: str | None) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says(op, "/fib", id=id_)
    assert client.hears() == []
    assert hub.graph.topics == {}


@pytest.mark.parametrize(
    ("ids", "hears"),
    [
        (["a"], [1]),
        (["a", "b"], []),
        ([None], []),
        (["unknown"], [1]),
        (["a", "a"], [1]),
    ],
)
def test_a_subscription_is_taken_back_by_its_id_or_with_all_others(
    ids: list[str | None], hears: list[int]
) -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.says("advertise", "/fib", type=INT32)
    for subscribed in ("a", "b"):
        listener.says("subscribe", "/fib", id=subscribed)
    for unsubscribed in ids:
        listener.says("unsubscribe", "/fib", id=unsubscribed)
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == hears


def test_who_unsubscribed_may_subscribe_again() -> None:
    talker, listener = talker_and_listener(FakeHub())
    listener.says("unsubscribe", "/fib")
    talker.says("publish", "/fib", msg=number(1))
    listener.says("subscribe", "/fib")
    talker.says("publish", "/fib", msg=number(2))
    assert listener.hears_numbers("/fib") == [2]


# How much one client may have.


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_a_topic_has_so_many_ids_of_one_client_and_no_more(op: str) -> None:
    hub = FakeHub()
    client = hub.client()
    for id_ in range(102):
        client.says(op, "/fib", type=INT32, id=id_)
    statuses = client.hears()
    assert [each["id"] for each in statuses] == [100, 101]
    assert all(
        "of one topic are enough" in each["msg"] or "to one topic" in each["msg"]
        for each in statuses
    )
    client.leaves()
    assert hub.empty
