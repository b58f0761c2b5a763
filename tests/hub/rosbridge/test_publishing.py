"""Publishing, advertising and subscribing."""

from __future__ import annotations

import pytest

from ..fakes import INT32, NANOSECONDS, STRING, FakeHub, number, talker_and_listener

# Publishing and subscribing.


def test_message_reaches_its_subscribers() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    stranger = hub.client()
    talker.send("publish", "/fib", msg=number(8))
    assert listener.receive() == [{"op": "publish", "topic": "/fib", "msg": number(8)}]
    assert talker.receive() == stranger.receive() == []


def test_messages_arrive_in_order_without_loss() -> None:
    talker, listener = talker_and_listener(FakeHub())
    for each in range(20):
        talker.send("publish", "/fib", msg=number(each))
    assert listener.receive_numbers("/fib") == list(range(20))


def test_client_receives_its_own_messages() -> None:
    client = FakeHub().client()
    client.send("advertise", "/fib", type=INT32)
    client.send("subscribe", "/fib")
    client.send("publish", "/fib", msg=number(1))
    assert client.receive_numbers("/fib") == [1]


def test_several_requests_of_one_client_get_a_message_once() -> None:
    talker, listener = talker_and_listener(FakeHub())
    for id_ in ("a", "b", 5):
        listener.send("subscribe", "/fib", id=id_)
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]


def test_one_text_may_hold_several_operations() -> None:
    hub = FakeHub()
    client = hub.client()
    client.send_text(
        '{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}\n'
        '{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a","msg":{"data":1}}'
    )
    assert client.receive_numbers("/a") == [1]


@pytest.mark.parametrize("msg", [{}, None])
def test_missing_message_is_the_types_default(msg: object) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send("publish", "/fib", msg=msg)
    talker.send_text('{"op":"publish","topic":"/fib"}')
    assert listener.receive_numbers("/fib") == [0, 0]


def test_missing_message_of_the_first_publish_is_the_default() -> None:
    hub = FakeHub()
    listener, other = hub.client(), hub.client()
    listener.send("subscribe", "/fib", type=INT32)
    other.send_text('{"op":"publish","topic":"/fib"}')
    assert listener.receive_numbers("/fib") == [0]


def test_missing_fields_get_their_defaults() -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("advertise", "/cmd_vel", type="geometry_msgs/Twist")
    client.send("subscribe", "/cmd_vel")
    client.send("publish", "/cmd_vel", msg={"linear": {"x": 1.5}})
    zeros = {"x": 0.0, "y": 0.0, "z": 0.0}
    assert client.receive_messages("/cmd_vel") == [
        {"linear": {**zeros, "x": 1.5}, "angular": zeros}
    ]


def test_header_is_stamped_and_counted() -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type="rospy_tutorials/HeaderString")
    client.send("subscribe", "/a")
    for data in "ab":
        client.send("publish", "/a", msg={"data": data})
    stamp = dict(zip(("secs", "nsecs"), divmod(NANOSECONDS, 10**9), strict=True))
    assert client.receive_messages("/a") == [
        {"header": {"seq": seq, "stamp": stamp, "frame_id": ""}, "data": data}
        for seq, data in [(1, "a"), (2, "b")]
    ]


@pytest.mark.parametrize(
    ("msg", "fault"),
    [
        ({"data": "8"}, "std_msgs/Int32 message requires an int32 for field data, but got a str"),
        ({"data": 2**31}, "2147483648 is not in -2147483648..2147483647"),
        ({"date": 8}, "Message type std_msgs/Int32 does not have a field date"),
        (8, "Expected a JSON object for type std_msgs/Int32 but received a int"),
        ([], "Expected a JSON object for type std_msgs/Int32 but received a list"),
    ],
)
def test_invalid_message_is_refused(msg: object, fault: str) -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send("publish", "/fib", msg=msg, id="p")
    [status] = talker.receive()
    assert status["id"] == "p"
    assert status["msg"].startswith("publish: ")
    assert fault in status["msg"]
    assert listener.receive() == []


def test_publish_advertises_if_the_type_is_known() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client("/other")
    other.send("publish", "/fib", msg=number(1))
    talker.disconnect()
    other.send("publish", "/fib", msg=number(2))
    assert listener.receive_numbers("/fib") == [1, 2]
    assert list(hub.graph.topics["/fib"].sources) == ["/other"]


def test_publish_to_an_unknown_topic_is_refused_and_leaves_nothing() -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("publish", "/fib", msg=number(1), id=7)
    hub.clock.advance(3)
    assert client.receive() == [
        {
            "op": "status",
            "id": 7,
            "level": "error",
            "msg": "publish: Cannot infer topic type for topic /fib as it is not yet advertised",
        }
    ]
    assert hub.graph.topics == {}


def test_subscription_without_a_type_gives_the_topic_none() -> None:
    hub = FakeHub()
    listener, talker = hub.client(), hub.client()
    listener.send("subscribe", "/fib")
    talker.send("publish", "/fib", msg=number(1))
    hub.clock.advance(3)
    assert "Cannot infer topic type" in talker.receive_statuses()[0]
    assert listener.receive() == []


def test_subscription_without_a_type_waits_for_a_publisher() -> None:
    hub = FakeHub()
    listener, talker = hub.client(), hub.client()
    listener.send("subscribe", "/fib")
    talker.send("advertise", "/fib", type=INT32)
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]


def test_subscription_outlives_its_publishers() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    talker.disconnect()
    other = hub.client()
    other.send("advertise", "/fib", type=STRING)
    other.send("publish", "/fib", msg={"data": "now text"})
    assert listener.receive_messages("/fib") == [{"data": "now text"}]


# Unadvertising and unsubscribing.


def test_advertisement_is_withdrawn_by_its_id() -> None:
    hub = FakeHub()
    client = hub.client()
    for id_ in ("a", 5, None):
        client.send("advertise", "/fib", type=INT32, id=id_)
    for id_ in ("a", 5, "unknown"):
        client.send("unadvertise", "/fib", id=id_)
    assert "/fib" in hub.graph.topics
    client.send("unadvertise", "/fib")
    assert hub.graph.topics == {}


def test_last_id_ends_the_publisher() -> None:
    hub = FakeHub()
    client = hub.client()
    for id_ in ("a", "b"):
        client.send("advertise", "/fib", type=INT32, id=id_)
    for id_ in ("b", "a"):
        client.send("unadvertise", "/fib", id=id_)
    assert hub.graph.topics == {}


def test_unadvertise_without_id_takes_all_advertisements_back() -> None:
    hub = FakeHub()
    client = hub.client()
    for spelling in ("/fib", "fib"):
        client.send("advertise", spelling, type=INT32, id=spelling)
    client.send("unadvertise", "fib")
    assert not hub.graph.topics
    assert not client.session.topics.sources


def test_publish_does_not_count_as_an_advertisement() -> None:
    hub = FakeHub()
    _, listener = talker_and_listener(hub)
    other = hub.client("/other")
    other.send("publish", "/fib", msg=number(1), id="P")
    other.send("advertise", "/fib", type=INT32, id="A")
    assert list(hub.graph.topics["/fib"].sources) == ["/talker", "/other"]
    other.send("unadvertise", "/fib", id="A")
    assert list(hub.graph.topics["/fib"].sources) == ["/talker"]
    assert not other.session.topics.sources
    assert listener.receive_numbers("/fib") == [1]


def test_client_that_only_published_may_unadvertise() -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other = hub.client("/other")
    other.send("publish", "/fib", msg=number(1))
    other.send("unadvertise", "/fib", id="any")
    assert list(hub.graph.topics["/fib"].sources) == ["/talker"]


def test_unadvertise_does_not_change_other_topics() -> None:
    hub = FakeHub()
    client = hub.client()
    for topic in ("/a", "/b"):
        client.send("advertise", topic, type=INT32)
    client.send("unadvertise", "/a")
    assert list(hub.graph.topics) == list(client.session.topics.sources) == ["/b"]


def test_client_unadvertises_only_its_own_topics() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client("/other")
    other.send("advertise", "/fib", type=INT32)
    other.send("subscribe", "/fib")
    other.send("unadvertise", "/fib")
    other.send("unsubscribe", "/fib")
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]
    assert other.receive() == []


@pytest.mark.parametrize("op", ["unadvertise", "unsubscribe"])
@pytest.mark.parametrize("id_", [None, "a"])
def test_taking_back_unknown_topics_is_harmless(op: str, id_: str | None) -> None:
    hub = FakeHub()
    client = hub.client()
    client.send(op, "/fib", id=id_)
    assert client.receive() == []
    assert hub.graph.topics == {}


@pytest.mark.parametrize(
    ("ids", "expected"),
    [
        (["a"], [1]),
        (["a", "b"], []),
        ([None], []),
        (["unknown"], [1]),
        (["a", "a"], [1]),
    ],
)
def test_unsubscribe_by_id_or_all(ids: list[str | None], expected: list[int]) -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/fib", type=INT32)
    for subscribed in ("a", "b"):
        listener.send("subscribe", "/fib", id=subscribed)
    for unsubscribed in ids:
        listener.send("unsubscribe", "/fib", id=unsubscribed)
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == expected


def test_client_may_subscribe_again_after_unsubscribe() -> None:
    talker, listener = talker_and_listener(FakeHub())
    listener.send("unsubscribe", "/fib")
    talker.send("publish", "/fib", msg=number(1))
    listener.send("subscribe", "/fib")
    talker.send("publish", "/fib", msg=number(2))
    assert listener.receive_numbers("/fib") == [2]


# How much one client may have.


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_number_of_ids_per_topic_is_limited(op: str) -> None:
    hub = FakeHub()
    client = hub.client()
    for id_ in range(102):
        client.send(op, "/fib", type=INT32, id=id_)
    statuses = client.receive()
    assert [each["id"] for each in statuses] == [100, 101]
    assert all("/fib" in each["msg"] and "limit 100" in each["msg"] for each in statuses)
    client.disconnect()
    assert hub.empty
