"""The type of a topic: which clients set it, and when it is free again."""

from __future__ import annotations

import pytest

from fibws.hub.log.text import MOST_DIFFERENT
from fibws.hub.rosbridge.subscription import MAX_REGISTRATIONS

from ..fakes import INT32, STRING, FakeHub, talker_and_listener

TF, TF2 = "tf/tfMessage", "tf2_msgs/TFMessage"
TF_MD5 = "94810edda583a504dfda3829e70d7eec"


@pytest.mark.parametrize("spelling", [INT32, "std_msgs/msg/Int32"])
@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_topic_may_be_joined_under_either_spelling_of_its_type(op: str, spelling: str) -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other = hub.client()
    other.send(op, "/fib", type=spelling)
    assert other.receive() == []


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_topic_shows_one_type_to_those_of_others(op: str) -> None:
    hub = FakeHub()
    talker_and_listener(hub)
    other = hub.client()
    other.send(op, "/fib", type=STRING)
    [status] = other.receive_statuses("warning")
    assert all(each in status for each in (op, "/fib", STRING, INT32, "/talker"))
    assert hub.graph.topics["/fib"].type is not None
    assert hub.graph.topics["/fib"].type.name == INT32


@pytest.mark.parametrize("spelling", [TF, "tf/msg/tfMessage"])
def test_types_of_equal_fields_are_one_on_a_topic(spelling: str) -> None:
    hub = FakeHub()
    talker, listener, other = hub.client(), hub.client(), hub.client()
    talker.send("advertise", "/tf", type=TF2)
    listener.send("subscribe", "/tf", type=spelling)
    other.send("advertise", "/tf", type=spelling, md5sum=TF_MD5)
    for client in (talker, other):
        client.send("publish", "/tf", msg={"transforms": [{}]})
    assert len(listener.receive_messages("/tf")) == 2
    assert talker.receive() == other.receive() == []
    assert hub.graph.topics["/tf"].type is not None
    assert hub.graph.topics["/tf"].type.name == TF2


def test_serialized_subscriber_receives_the_type_of_the_topic() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client(serialized=True)
    talker.send("advertise", "/tf", type=TF2)
    listener.send("subscribe", "/tf", type=TF, md5sum=TF_MD5, compression="ros1")
    answer = listener.receive_one("subscribed")
    assert (answer["type"], answer["md5sum"]) == (TF2, TF_MD5)


def test_unchecked_types_of_two_names_are_different() -> None:
    hub = FakeHub()
    talker, other = hub.client(), hub.client()
    talker.send("advertise", "/n", type="my_msgs/Number")
    other.send("advertise", "/n", type="your_msgs/Number")
    assert "my_msgs/Number" in other.receive_statuses("warning")[0]


def test_subscription_with_a_type_does_not_hold_it_against_a_publisher() -> None:
    hub = FakeHub()
    listener, talker = hub.client("/listener"), hub.client()
    listener.send("subscribe", "/fib", type=INT32)
    talker.send("advertise", "/fib", type=STRING)
    assert talker.receive() == []
    assert STRING in listener.receive_statuses("warning")[0]
    assert hub.graph.topics["/fib"].type is not None
    assert hub.graph.topics["/fib"].type.name == STRING


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_type_is_free_when_its_last_holder_leaves(end: str) -> None:
    hub = FakeHub()
    talker, _ = talker_and_listener(hub)
    if end == "leave":
        talker.disconnect()
    else:
        talker.send("unadvertise", "/fib")
    assert hub.graph.topics["/fib"].type is None
    other = hub.client()
    other.send("subscribe", "/fib", type=STRING)
    assert other.receive() == []


def test_type_is_free_when_the_request_that_named_it_is_replaced() -> None:
    hub = FakeHub()
    listener, talker = hub.client(), hub.client()
    listener.send("subscribe", "/fib", id="a", type=INT32)
    listener.send("subscribe", "/fib", id="a")
    talker.send("advertise", "/fib", type=STRING)
    talker.send("publish", "/fib", msg={"data": "x"})
    assert listener.receive_messages("/fib") == [{"data": "x"}]
    assert talker.receive() == []


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
def test_invalid_type_is_refused_and_leaves_nothing_behind(op: str, type_: str, fault: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.send(op, "/a", type=type_)
    assert client.receive_statuses() == [f"{op}: {fault}"]
    assert hub.graph.topics == {}


def test_messages_of_an_unknown_package_are_relayed_unchecked() -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type="my_msgs/Thing")
    client.send("subscribe", "/a", type="my_msgs/msg/Thing")
    client.send("publish", "/a", msg={"any": ["thing"]})
    client.send("publish", "/a")
    assert client.receive_messages("/a") == [{"any": ["thing"]}, {}]


def test_advertising_a_type_of_an_unknown_package_gives_a_warning() -> None:
    client = FakeHub().client()
    client.send("set_level", level="warning")
    client.send("advertise", "/a", type="my_msgs/Thing", id=1)
    assert client.receive() == [
        {
            "op": "status",
            "id": 1,
            "level": "warning",
            "msg": "/a: messages of type my_msgs/Thing are not checked",
        }
    ]


@pytest.mark.parametrize(
    ("op", "fields", "meant"),
    [
        ("advertise", {"topic": "/a", "type": "std_msg/String"}, "std_msgs/String"),
        ("advertise", {"topic": "/a", "type": "std_msg/Strng"}, "std_msgs/String"),
        ("subscribe", {"topic": "/a", "type": "geometry_msg/Twist"}, "geometry_msgs/Twist"),
        ("advertise_service", {"service": "/a", "type": "std_srv/Empty"}, "std_srvs/Empty"),
        (
            "advertise_action",
            {"action": "/a", "type": "actionlib_tutorial/Fibonacci"},
            "actionlib_tutorials/Fibonacci",
        ),
    ],
)
def test_misspelled_package_earns_a_warning_at_the_default_level(
    op: str, fields: dict[str, str], meant: str, caplog: pytest.LogCaptureFixture
) -> None:
    client = FakeHub().client("/clumsy")
    client.send(op, id=1, **fields)
    [status] = client.receive()
    assert (status["level"], status["id"]) == ("warning", 1)
    assert fields["type"] in status["msg"] and f"did you mean {meant}?" in status["msg"]
    [record] = caplog.records
    assert record.message.startswith("/clumsy: ") and meant in record.message


def test_misspelled_package_is_relayed_unchecked() -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type="std_msg/String")
    client.send("subscribe", "/a")
    assert len(client.receive_statuses("warning")) == 1
    client.send("publish", "/a", msg={"any": 1})
    assert client.receive_messages("/a") == [{"any": 1}]


@pytest.mark.parametrize("type_", ["my_msgs/Thing", "std_msgs2/Foo", "robot_msgs/String"])
def test_package_of_ones_own_earns_no_suggestion(type_: str) -> None:
    client = FakeHub().client()
    client.send("advertise", "/a", type=type_)
    assert client.receive() == []


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_strict_types_refuse_an_unknown_package(op: str) -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.send(op, "/a", type="my_msgs/Thing")
    assert client.receive_statuses() == [
        f"{op}: Unable to load the manifest for package my_msgs. "
        "Caused by: no folder of definitions contains it (FIBWS_INTERFACES names them)"
    ]
    assert hub.graph.topics == {}


def test_client_may_bring_a_definition() -> None:
    client = FakeHub(strict_types=True).client()
    client.send("advertise", "/a", type="my_msgs/msg/Thing", definition="int8 one\nstring two\n")
    client.send("subscribe", "/a", type="my_msgs/Thing")
    client.send("publish", "/a", msg={"one": 1})
    assert client.receive_messages("/a") == [{"one": 1, "two": ""}]
    client.send("publish", "/a", msg={"one": 1000})
    assert "1000 is not in -128..127" in client.receive_statuses()[0]


def test_unchecked_topic_goes_on_when_another_type_of_its_package_is_defined() -> None:
    hub = FakeHub()
    talker, other, late = hub.client(), hub.client(), hub.client()
    talker.send("advertise", "/a", type="my_msgs/Pose")
    other.send("advertise", "/b", type="my_msgs/Other", definition="int32 x\n")
    assert other.receive() == []
    late.send("subscribe", "/a", type="my_msgs/Pose")
    talker.send("advertise", "/a", type="my_msgs/Pose", id="again")
    late.send("publish", "/a", msg={"any": "thing"})
    talker.send("publish", "/a", msg={"other": "thing"})
    late.send("advertise", "/c", type="my_msgs/Pose")
    assert late.receive_messages("/a") == [{"any": "thing"}, {"other": "thing"}]
    assert talker.receive() == []


def test_definition_with_a_conflict_is_not_learned() -> None:
    hub = FakeHub()
    client, _ = talker_and_listener(hub)
    client.send("advertise", "/fib", type="my_msgs/Thing", definition="int8 a\n")
    assert "already established with type std_msgs/Int32" in client.receive_statuses()[0]
    client.send("advertise", "/a", type="my_msgs/Thing", definition="string b\n")
    assert client.receive() == []


def test_invalid_definition_is_refused_and_leaves_nothing_behind() -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("advertise", "/a", type="my_msgs/Thing", definition="int33 one\n")
    assert client.receive_statuses()[0].startswith("advertise: ")
    assert hub.graph.topics == {}


def test_unknown_types_are_logged_without_filling_the_log(
    caplog: pytest.LogCaptureFixture,
) -> None:
    client = FakeHub().client("/talker")
    for number in range(1000):
        client.send("advertise", f"/a{number}", type=f"made_up_{number}/Thing")
    assert len(caplog.records) == MOST_DIFFERENT + 3
    assert "made_up_0/Thing" in caplog.records[0].message


@pytest.mark.parametrize("id_", ["typed", None])
def test_type_is_free_when_the_request_that_named_it_is_cancelled(id_: str | None) -> None:
    hub = FakeHub()
    listener = hub.client()
    listener.send("subscribe", "/fib", id="typed", type=INT32)
    listener.send("subscribe", "/fib", id="untyped")
    listener.send("unsubscribe", "/fib", id="unknown")
    assert hub.graph.topics["/fib"].held
    listener.send("unsubscribe", "/fib", **({"id": id_} if id_ else {}))
    if id_:
        assert hub.graph.topics["/fib"].type is None
    else:
        assert "/fib" not in hub.graph.topics


def test_request_beyond_the_limit_leaves_the_topic_as_it_was() -> None:
    hub = FakeHub()
    listener = hub.client()
    for id_ in range(MAX_REGISTRATIONS):
        listener.send("subscribe", "/fib", id=str(id_))
    listener.send("subscribe", "/fib", id="another", type=INT32)
    [status] = listener.receive_statuses()
    assert "/fib" in status
    assert str(MAX_REGISTRATIONS) in status
    assert not hub.graph.topics["/fib"].held
    assert hub.graph.topics["/fib"].type is None
    assert len(listener.session.topics.subscriptions["/fib"].requests) == MAX_REGISTRATIONS
