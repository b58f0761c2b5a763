"""The type of a topic: who sets it, what it must be, and when it is free again."""

from __future__ import annotations

import pytest

from ..fakes import INT32, STRING, FakeHub, talker_and_listener


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
    assert not other.session.topics.publishers
    assert not other.session.topics.subscriptions


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
            "Caused by: no such msg in std_msgs; did you mean std_msgs/String?",
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
            "msg": "/a: messages of type my_msgs/Thing are not checked",
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


def test_an_unchecked_topic_is_not_broken_by_who_brings_another_type_of_the_package() -> None:
    hub = FakeHub()
    talker, bringer, late = hub.client(), hub.client(), hub.client()
    talker.says("advertise", "/a", type="my_msgs/Pose")
    bringer.says("advertise", "/b", type="my_msgs/Other", definition="int32 x\n")
    assert bringer.hears() == []
    late.says("subscribe", "/a", type="my_msgs/Pose")
    talker.says("advertise", "/a", type="my_msgs/Pose", id="again")
    late.says("publish", "/a", msg={"any": "thing"})
    talker.says("publish", "/a", msg={"other": "thing"})
    late.says("advertise", "/c", type="my_msgs/Pose")
    assert late.hears_messages("/a") == [{"any": "thing"}, {"other": "thing"}]
    assert talker.hears() == []


def test_a_definition_that_comes_with_a_conflict_is_not_learned() -> None:
    hub = FakeHub()
    _, client = talker_and_listener(hub)
    client.says("advertise", "/fib", type="my_msgs/Thing", definition="int8 a\n")
    assert "already established with type std_msgs/Int32" in client.hears_statuses()[0]
    client.says("advertise", "/a", type="my_msgs/Thing", definition="string b\n")
    assert client.hears() == []


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
