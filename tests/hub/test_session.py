"""What clients say, and what they and others hear of it."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.protocol.closing import REPLACED
from fibws.protocol.text import InvalidUtf8

from .fakes import NANOSECONDS, Client, FakeHub

INT32 = "std_msgs/Int32"
STRING = "std_msgs/String"
ALLOWED = (
    "['advertise', 'fragment', 'publish', 'set_level', 'subscribe', 'unadvertise', 'unsubscribe']"
)


def number(data: int) -> dict[str, int]:
    return {"data": data}


def talker_and_listener(hub: FakeHub, **advertise: Any) -> tuple[Client, Client]:
    """Two clients, of which one publishes /fib and the other hears it."""
    talker, listener = hub.client("/talker"), hub.client("/listener")
    talker.says("advertise", "/fib", type=INT32, **advertise)
    listener.says("subscribe", "/fib")
    return talker, listener


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


# Types.


@pytest.mark.parametrize("spelling", [INT32, "std_msgs/msg/Int32"])
@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_a_topic_may_be_joined_under_either_spelling_of_its_type(op: str, spelling: str) -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other = hub.client()
    other.says(op, "/fib", type=spelling)
    assert other.hears() == []


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_a_topic_has_one_type(op: str) -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other = hub.client()
    other.says(op, "/fib", type=STRING)
    assert other.hears_statuses() == [
        f"{op}: Tried to register topic /fib with type std_msgs/String "
        "but it is already established with type std_msgs/Int32 (by /talker)"
    ]
    assert not other.session.publishers
    assert not other.session.subscriptions


def test_a_subscription_with_a_type_holds_the_topic_to_it() -> None:
    hub = FakeHub()
    listener, talker = hub.client("/listener"), hub.client()
    listener.says("subscribe", "/fib", type=INT32)
    talker.says("advertise", "/fib", type=STRING)
    assert "(by /listener)" in talker.hears_statuses()[0]
    listener.says("unsubscribe", "/fib")
    talker.says("advertise", "/fib", type=STRING)
    assert talker.hears() == []


def test_a_subscription_with_a_type_holds_it_when_the_publisher_is_gone() -> None:
    hub = FakeHub()
    listener, talker = hub.client("/listener"), hub.client()
    listener.says("subscribe", "/fib", type=INT32)
    talker.says("advertise", "/fib", type=INT32)
    talker.says("unadvertise", "/fib")
    talker.says("advertise", "/fib", type=STRING)
    assert "(by /listener)" in talker.hears_statuses()[0]


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_a_type_is_free_when_nobody_holds_it(end: str) -> None:
    hub = FakeHub()
    talker, _ = talker_and_listener(hub)
    if end == "leave":
        talker.leaves()
    else:
        talker.says("unadvertise", "/fib")
    assert hub.graph.topics["/fib"].type is None
    other = hub.client()
    other.says("subscribe", "/fib", type=STRING)
    assert other.hears() == []


def test_a_type_is_free_when_the_request_that_named_it_is_replaced() -> None:
    hub = FakeHub()
    listener, talker = hub.client(), hub.client()
    listener.says("subscribe", "/fib", id="a", type=INT32)
    listener.says("subscribe", "/fib", id="a")
    talker.says("advertise", "/fib", type=STRING)
    talker.says("publish", "/fib", msg={"data": "x"})
    assert listener.hears_messages("/fib") == [{"data": "x"}]
    assert talker.hears() == []


@pytest.mark.parametrize(
    ("type_", "fault"),
    [
        ("Int32", "Int32 is not a valid type string"),
        (
            "std_msgs/Sting",
            "Unable to import msg class Sting from package std_msgs. "
            "Caused by: did you mean std_msgs/String?",
        ),
    ],
)
@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_a_type_that_is_none_is_refused_and_leaves_nothing_behind(
    op: str, type_: str, fault: str
) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says(op, "/a", type=type_)
    assert client.hears_statuses() == [f"{op}: {fault}"]
    assert hub.graph.topics == {}


def test_messages_of_an_unknown_package_are_relayed_unchecked() -> None:
    client = FakeHub().client()
    client.says("advertise", "/a", type="my_msgs/Thing")
    client.says("subscribe", "/a", type="my_msgs/msg/Thing")
    client.says("publish", "/a", msg={"any": ["thing"]})
    client.says("publish", "/a")
    assert client.hears_messages("/a") == [{"any": ["thing"]}, {}]


def test_who_advertises_a_type_of_an_unknown_package_is_warned() -> None:
    client = FakeHub().client()
    client.says("set_level", level="warning")
    client.says("advertise", "/a", type="my_msgs/Thing", id=1)
    assert client.hears() == [
        {
            "op": "status",
            "id": 1,
            "level": "warning",
            "msg": "nobody defined my_msgs/Thing: not checked",
        }
    ]


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_strict_types_refuse_an_unknown_package(op: str) -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.says(op, "/a", type="my_msgs/Thing")
    assert client.hears_statuses() == [
        f"{op}: Unable to load the manifest for package my_msgs. "
        "Caused by: no folder of definitions holds it"
    ]
    assert hub.graph.topics == {}


def test_a_client_may_bring_a_definition_along() -> None:
    client = FakeHub(strict_types=True).client()
    client.says("advertise", "/a", type="my_msgs/msg/Thing", definition="int8 one\nstring two\n")
    client.says("subscribe", "/a", type="my_msgs/Thing")
    client.says("publish", "/a", msg={"one": 1})
    assert client.hears_messages("/a") == [{"one": 1, "two": ""}]
    client.says("publish", "/a", msg={"one": 1000})
    assert "1000 is not in -128..127" in client.hears_statuses()[0]


def test_a_definition_that_does_not_parse_is_refused_and_leaves_nothing_behind() -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("advertise", "/a", type="my_msgs/Thing", definition="int33 one\n")
    assert client.hears_statuses()[0].startswith("advertise: ")
    assert hub.graph.topics == {}


def test_a_definition_of_a_known_type_must_agree() -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("advertise", "/a", type=INT32, definition="int32 data\n")
    assert client.hears() == []
    client.says("advertise", "/b", type=INT32, definition="int64 data\n")
    assert "is known here with other fields" in client.hears_statuses()[0]


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
    assert not client.session.publishers


def test_other_topics_of_the_client_are_left_as_they_are() -> None:
    hub = FakeHub()
    client = hub.client()
    for topic in ("/a", "/b"):
        client.says("advertise", topic, type=INT32)
    client.says("unadvertise", "/a")
    assert list(hub.graph.topics) == list(client.session.publishers) == ["/b"]


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


# Throttles and queues.


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


# Latching.


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


# Names.


@pytest.mark.parametrize(
    ("node", "spelling", "name"),
    [
        ("/talker", "fib", "/fib"),
        ("/talker", "/fib", "/fib"),
        ("/talker", "~fib", "/talker/fib"),
        ("/robot/arm", "~pid/gain", "/robot/arm/pid/gain"),
        (None, "~fib", "/client_1/fib"),
    ],
)
def test_names_resolve_under_the_clients_node(node: str | None, spelling: str, name: str) -> None:
    hub = FakeHub()
    hub.client(node).says("advertise", spelling, type=INT32)
    assert list(hub.graph.topics) == [name]


def test_each_hears_a_topic_under_its_own_spelling() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    other = hub.client()
    other.says("subscribe", "fib")
    talker.says("publish", "fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]
    assert other.hears_numbers("fib") == [1]


def test_a_client_may_use_both_spellings_at_once() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.says("subscribe", "fib", throttle_rate=1000)
    for each in range(2):
        talker.says("publish", "/fib", msg=number(each))
    heard = [(each["topic"], each["msg"]["data"]) for each in listener.hears()]
    assert sorted(heard) == [("/fib", 0), ("/fib", 1), ("fib", 0)]
    listener.says("unsubscribe", "/fib")
    hub.clock.advance(1)
    talker.says("publish", "/fib", msg=number(2))
    assert listener.hears_numbers("fib") == [2]


def test_a_publisher_has_one_count_under_both_spellings() -> None:
    client = FakeHub().client()
    client.says("subscribe", "/a", type="rospy_tutorials/HeaderString")
    for spelling in ("/a", "a", "/a"):
        client.says("publish", spelling)
    assert [msg["header"]["seq"] for msg in client.hears_messages("/a")] == [1, 2, 3]


@pytest.mark.parametrize("name", ["", "/", "1st", "a b", "a//b", "/a/", "ä"])
@pytest.mark.parametrize("op", ["advertise", "publish", "subscribe"])
def test_a_name_that_is_not_legal_is_refused(op: str, name: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says(op, name, type=INT32, id="x")
    [status] = client.hears()
    assert (status["id"], status["level"]) == ("x", "error")
    assert status["msg"].startswith(f"{op}: {name!r} is not a legal name")
    assert hub.graph.topics == {}


# Statuses.


@pytest.mark.parametrize(
    ("text", "msg"),
    [
        (
            "{",
            "Expected JSON objects: EOF while parsing an object at line 1 column 1. "
            'Original message was: "{"',
        ),
        ("5", "Expected a JSON object. Original message was: 5"),
        ('{"op":"fly"}', f"Unknown operation: fly.  Allowed operations: {ALLOWED}"),
        (
            '{"topic":"/a"}',
            "Received a message without an op.  All messages require 'op' field with value "
            f'one of: {ALLOWED}.  Original message was: {{"topic":"/a"}}',
        ),
        ('{"op":"subscribe"}', "subscribe: Expected a topic field but none was found."),
        (
            '{"op":"publish","topic":5}',
            "publish: Expected field topic to be one of str. Invalid value: 5",
        ),
        (
            '{"op":"publish","topic":["/a"]}',
            'publish: Expected field topic to be one of str. Invalid value: ["/a"]',
        ),
    ],
)
def test_what_is_no_operation_is_refused(text: str, msg: str) -> None:
    client = FakeHub().client()
    client.says_text(text)
    assert client.hears_statuses() == [msg]


def test_an_error_ends_neither_the_session_nor_the_operations_around_it() -> None:
    client = FakeHub().client()
    client.says_text(
        '{"op":"advertise","topic":"/a","type":"std_msgs/Int32"}{"op":"fly"}'
        '{"op":"subscribe","topic":"/a"}{"op":"publish","topic":"/a"} garbage'
    )
    client.says("publish", "/a", msg=number(1))
    assert [each["op"] for each in client.hears()] == ["status", "publish", "status", "publish"]


@pytest.mark.parametrize("id_", ["subscribe:/t:1", "", 5, 0, -1.5, 2**70, True, False])
@pytest.mark.parametrize("op", ["fly", "publish", "subscribe"])
def test_a_status_carries_the_id_as_it_was_sent(op: str, id_: object) -> None:
    client = FakeHub().client()
    client.says(op, "not legal", id=id_)
    [status] = client.hears()
    assert (status["id"], type(status["id"])) == (id_, type(id_))


@pytest.mark.parametrize("id_", [None, [], {"a": 1}])
@pytest.mark.parametrize("op", ["fly", "publish", "subscribe"])
def test_a_status_carries_no_id_that_is_none(op: str, id_: object) -> None:
    client = FakeHub().client()
    client.says(op, "not legal", id=id_)
    [status] = client.hears()
    assert "id" not in status


def test_an_id_that_is_none_does_not_matter_to_a_known_publisher() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.says("publish", "/fib", msg={"data": "x"}, id=[1])
    [status] = talker.hears()
    assert "id" not in status
    assert listener.hears() == []


@pytest.mark.parametrize(
    ("level", "heard"),
    [
        ("none", []),
        ("error", ["error"]),
        ("warning", ["warning", "error"]),
        ("info", ["warning", "info", "error"]),
    ],
)
def test_a_client_hears_the_level_that_it_set_and_what_is_graver(
    level: str, heard: list[str]
) -> None:
    client = FakeHub().client()
    client.says("set_level", level=level)
    client.says("advertise", "/a", type="my_msgs/Thing")
    client.says("fly")
    assert [each["level"] for each in client.hears()] == heard


def test_nothing_above_errors_is_said_unless_asked_for() -> None:
    client = FakeHub().client()
    client.says("advertise", "/a", type="my_msgs/Thing")
    client.says("subscribe", "/b", compression="png")
    assert client.hears() == []


def test_a_wrong_level_is_refused_and_the_old_one_stays() -> None:
    client = FakeHub().client()
    client.says("set_level", level="loud", id=1)
    assert [each["id"] for each in client.hears()] == [1]
    client.says("fly")
    assert len(client.hears()) == 1


def informed(hub: FakeHub, node: str = "/talker") -> Client:
    client = hub.client(node)
    client.says("set_level", level="info")
    return client


def test_an_advertisement_is_acknowledged_at_level_info() -> None:
    client = informed(FakeHub())
    client.says("advertise", "fib", type="std_msgs/msg/Int32", id=1)
    assert client.hears() == [
        {
            "op": "status",
            "id": 1,
            "level": "info",
            "msg": "/talker publishes /fib (std_msgs/Int32)",
        }
    ]


def test_who_waits_for_a_publisher_is_told_at_level_info() -> None:
    client = informed(FakeHub())
    client.says("subscribe", "/fib", id="x")
    [status] = client.hears()
    assert (status["id"], status["level"]) == ("x", "info")
    assert status["msg"] == "/fib has no type yet: waiting for a publisher"


def test_what_a_message_left_out_is_told_at_level_info() -> None:
    hub = FakeHub()
    client = informed(hub)
    client.says("advertise", "/a", type="geometry_msgs/Twist")
    client.hears()
    zeros = {"x": 0, "y": 0, "z": 0}
    client.says("publish", "/a", msg={"linear": {"x": 1, "z": 1}}, id="p")
    client.says("publish", "/a", msg={"linear": zeros, "angular": zeros})
    client.says("publish", "/a")
    statuses = client.hears()
    assert [each["msg"] for each in statuses] == [
        "publish: defaults stand for linear.y, angular",
        "publish: defaults stand for linear, angular",
    ]
    assert statuses[0]["id"] == "p"


@pytest.mark.parametrize("compression", ["png", "cbor", "zip"])
def test_a_compression_that_is_not_there_is_treated_as_none(compression: str) -> None:
    hub = FakeHub()
    talker, _ = talker_and_listener(hub)
    listener = hub.client()
    listener.says("set_level", level="warning")
    listener.says("subscribe", "/fib", compression=compression)
    assert listener.hears_statuses("warning") == [f"no {compression} yet: messages come as JSON"]
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]


def test_a_status_overtakes_the_messages_that_a_slow_client_has_yet_to_read() -> None:
    talker, listener = talker_and_listener(FakeHub())
    listener.outbox.pause()
    talker.says("publish", "/fib", msg=number(1))
    listener.says("fly")
    listener.outbox.resume()
    assert [each["op"] for each in listener.hears()] == ["status", "publish"]


def test_a_client_that_errs_often_does_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    client = FakeHub().client("/clumsy")
    for _ in range(1000):
        client.says("subscribe", "/")
    fault = "/clumsy: subscribe: '/' is not a legal name"
    assert [record.message.startswith(fault) for record in caplog.records] == [True] * 4
    assert [record.message.partition(" (error ")[2] for record in caplog.records] == [
        f"{count} of this client)" for count in (1, 10, 100, 1000)
    ]
    assert len(client.hears()) == 1000


@pytest.mark.parametrize(
    "fields",
    [
        {"op": "x" * 10_000},
        {"op": "advertise", "topic": "/a", "type": "x" * 10_000},
        {"op": "advertise", "topic": "x" * 10_000, "type": INT32},
        {"op": "publish", "topic": "/fib", "msg": {"x" * 10_000: 1}},
        {"op": "publish", "topic": "/fib", "msg": {"data": "x" * 10_000}},
        {"op": "subscribe", "topic": "/fib", "compression": "x" * 10_000},
        {"op": "fragment", "id": "x" * 10_000, "data": "", "num": 0, "total": 2},
    ],
    ids=["operation", "type", "topic", "field", "value", "compression", "fragment"],
)
def test_a_status_repeats_only_a_part_of_what_was_wrong(fields: dict[str, Any]) -> None:
    client = informed(FakeHub())
    client.says("advertise", "/fib", type=INT32)
    fragment(client, "", 0, 3, "x" * 10_000)
    client.hears()
    client.says_text(json.dumps(fields))
    [text] = [each["msg"] for each in client.hears()]
    assert len(text) < 2000


def test_a_client_can_be_told_that_it_sent_no_operation_at_all() -> None:
    client = FakeHub().client()
    client.session.refuse("what was that?")
    assert client.hears_statuses() == ["what was that?"]


def test_bytes_that_are_no_text_are_the_connections_to_judge() -> None:
    client = FakeHub().client()
    with pytest.raises(InvalidUtf8):
        client.session.receive(b"\xff")


# Fragments.


def fragment(client: Client, data: str, num: int, total: int, id_: object = "f") -> None:
    client.says("fragment", data=data, num=num, total=total, id=id_)


def test_an_operation_may_come_in_fragments() -> None:
    client = FakeHub().client()
    text = json.dumps({"op": "advertise", "topic": "/fib", "type": INT32})
    client.says("subscribe", "/fib")
    fragment(client, text[20:], 1, 2)
    client.says("publish", "/fib", msg=number(1))
    assert "Cannot infer" in client.hears_statuses()[0]
    fragment(client, text[:20], 0, 2)
    client.says("publish", "/fib", msg=number(2))
    assert client.hears_numbers("/fib") == [2]


def test_fragments_of_two_clients_do_not_mix() -> None:
    hub = FakeHub()
    first, second = hub.client(), hub.client()
    fragment(first, '{"op":', 0, 2)
    fragment(second, '"fly"}', 1, 2)
    assert first.hears() == second.hears() == []


@pytest.mark.parametrize(
    ("fields", "msg"),
    [
        (
            {"data": "", "num": 2, "total": 2},
            "fragment: num must be from 0 to total - 1, but num is 2 and total is 2",
        ),
        ({"data": "", "num": 0}, "fragment: Expected a total field but none was found."),
        (
            {"data": 5, "num": 0, "total": 1},
            "fragment: Expected field data to be one of str. Invalid value: 5",
        ),
    ],
)
def test_a_wrong_fragment_is_refused(fields: dict[str, Any], msg: str) -> None:
    client = FakeHub().client()
    client.says("fragment", id="f", **fields)
    [status] = client.hears()
    assert (status["id"], status["msg"]) == ("f", msg)


def test_what_fragments_make_up_may_be_wrong_as_well() -> None:
    client = FakeHub().client()
    fragment(client, "no JSON", 0, 1)
    fragment(client, '{"op":"fly","id":7}', 0, 1)
    assert [each.get("id") for each in client.hears()][1:] == [7]


def test_unfinished_fragments_are_bounded_and_expire() -> None:
    hub = FakeHub(max_message_size=1000)
    client = hub.client()
    fragment(client, "x" * 800, 0, 2)
    fragment(client, "x" * 800, 0, 2, "other")
    assert client.hears_statuses() == ["fragment: unfinished messages may take 1000 bytes together"]
    hub.clock.advance(601)
    fragment(client, "x" * 800, 0, 2, "other")
    assert client.hears() == []


def test_fragments_within_fragments_do_not_exhaust_the_stack() -> None:
    client = FakeHub().client()
    text = '{"op":"fly"}'
    waiting: list[str] = []
    # Each text finishes the next one, whose beginning came with an earlier one.
    for number_ in range(400):
        piece = {"op": "fragment", "id": number_, "total": 2}
        begin = json.dumps({**piece, "num": 0, "data": text})
        waiting.append(begin)
        text = json.dumps({**piece, "num": 1, "data": ""})
        if len(waiting) == 60:
            text = "".join(waiting) + text
            waiting.clear()
    client.says_text("".join(waiting) + text)
    assert client.hears_statuses() != []


# Coming and going.


def test_a_client_that_leaves_leaves_nothing_behind() -> None:
    hub = FakeHub()
    client = hub.client("/busy")
    client.says("advertise", "/a", type=INT32, latch=True)
    client.says("advertise", "a", type=INT32)
    client.says("publish", "/a", msg=number(1))
    client.says("subscribe", "/a")
    client.says("subscribe", "a", type=INT32, throttle_rate=100, queue_length=5)
    client.says("subscribe", "/nothing_yet")
    client.says("publish", "/a", msg=number(2))
    client.says("publish", "/a", msg=number(3))
    fragment(client, "", 0, 2)
    client.leaves()
    assert hub.empty
    assert hub.clock.timers == 0
    assert not client.session.publishers
    assert not client.session.subscriptions


def test_the_second_time_a_client_leaves_nothing_happens() -> None:
    hub = FakeHub()
    client = hub.client("/a")
    client.leaves()
    newer = hub.client("/a")
    client.leaves()
    assert list(hub.graph.nodes) == ["/a"]
    assert newer.closings == []


def test_names_by_the_thousand_leave_nothing_behind() -> None:
    hub = FakeHub()
    client = hub.client()
    for each in range(1000):
        client.says("advertise", f"/a{each}", type=INT32)
        client.says("unadvertise", f"/a{each}")
        client.says("subscribe", f"/b{each}")
        client.says("unsubscribe", f"/b{each}")
        client.says("publish", f"/c{each}")
        client.says("advertise", f"/d{each}", type="std_msgs/None")
        client.says("subscribe", f"/e{each}", type="nonsense")
    assert hub.graph.topics == {}


def test_a_subscription_that_is_refused_leaves_the_others_as_they_are() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    listener.says("subscribe", "/fib", id="wrong", type=STRING)
    assert len(listener.hears_statuses()) == 1
    talker.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]
    listener.leaves()
    talker.leaves()
    assert hub.empty


def test_clients_without_a_name_are_given_different_ones() -> None:
    hub = FakeHub()
    assert [hub.client().session.node for _ in range(2)] == ["/client_1", "/client_2"]


def test_a_newer_node_of_the_same_name_shuts_the_older_down() -> None:
    hub = FakeHub()
    older, listener = talker_and_listener(hub)
    newer = hub.client("/talker")
    assert (older.closings, newer.closings, listener.closings) == ([REPLACED], [], [])
    assert list(hub.graph.nodes) == ["/listener", "/talker"]
    assert hub.graph.topics["/fib"].publishers == {}


def test_the_newer_node_keeps_what_is_its_own_when_the_older_is_gone() -> None:
    hub = FakeHub()
    older, listener = talker_and_listener(hub)
    newer = hub.client("/talker")
    newer.says("advertise", "/fib", type=INT32)
    older.leaves()
    newer.says("publish", "/fib", msg=number(1))
    assert listener.hears_numbers("/fib") == [1]
    newer.leaves()
    listener.leaves()
    assert hub.empty


TOPICS = st.sampled_from(["/a", "a", "~a", "/b", "b", "/", "", 5, None])
IDS: st.SearchStrategy[object] = st.sampled_from([None, "x", 1, True, 1.5, [], {}])
TYPES = st.sampled_from([INT32, STRING, "my_msgs/Thing", "std_msgs/Sting", "nonsense", 5, None])
SIZES = st.sampled_from([0, 1, 5, -1, 100, 2.5, 2**70, "1", None])
FIELDS = st.fixed_dictionaries(
    {
        "op": st.sampled_from(
            ["advertise", "publish", "subscribe", "unadvertise", "unsubscribe", "set_level", "fly"]
        ),
        "topic": TOPICS,
    },
    optional={
        "id": IDS,
        "type": TYPES,
        "latch": st.booleans(),
        "msg": st.sampled_from([{}, {"data": 1}, {"data": "x"}, {"data": [None]}, [], "x", None]),
        "throttle_rate": SIZES,
        "queue_length": SIZES,
        "compression": st.sampled_from(["none", "png", "cbor", 5]),
        "level": st.sampled_from(["info", "warning", "error", "none", "loud"]),
        "definition": st.sampled_from([None, "int32 data", "int8 a\nint8 b", "int33 c"]),
    },
)
STEPS = st.lists(
    st.tuples(st.integers(0, 1), FIELDS | st.sampled_from(["pause", "resume", "time", "turn"])),
    max_size=20,
)


@given(STEPS)
def test_whatever_clients_say_nothing_raises_and_nothing_is_left(
    steps: list[tuple[int, dict[str, Any] | str]],
) -> None:
    hub = FakeHub()
    clients = [hub.client("/robot"), hub.client()]
    for number_, step in steps:
        client = clients[number_]
        match step:
            case "pause":
                client.outbox.pause()
            case "resume":
                client.outbox.resume()
            case "time":
                hub.clock.advance(0.25)
            case "turn":
                client.hears()
            case _:
                client.says_text(json.dumps(step))
    for client in clients:
        client.leaves()
    assert hub.empty
    assert hub.clock.timers == 0
    assert all(client.outbox.kept_bytes == 0 or client.outbox.paused for client in clients)
