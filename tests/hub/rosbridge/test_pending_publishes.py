"""Messages of a client that has just come, before their topic has a type."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.hub.rosbridge.session import MAX_OBJECTS
from fibws.hub.rosbridge.topics import GRACE, MOST_PENDING_BYTES
from fibws.protocol.operations import Publish, encode

from ..fakes import INT32, STRING, Client, FakeHub, number, talker_and_listener

CANNOT = "publish: Cannot infer topic type for topic /fib as it is not yet advertised"


def test_message_of_a_new_client_waits_for_its_advertisement() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.send("subscribe", "/fib")
    for each in range(3):
        talker.send("publish", "/fib", msg=number(each))
        hub.clock.advance(GRACE / 4)
    assert listener.receive() == talker.receive() == []
    talker.send("advertise", "/fib", type=INT32)
    talker.send("publish", "/fib", msg=number(3))
    assert listener.receive_numbers("/fib") == [0, 1, 2, 3]
    hub.clock.advance(10)
    assert listener.receive() == talker.receive() == []


def test_pending_messages_are_refused_after_the_grace_period() -> None:
    hub = FakeHub()
    hub.clock.advance(5)
    client = hub.client()
    for id_ in "ab":
        client.send("publish", "/fib", msg=number(1), id=id_)
        hub.clock.advance(GRACE / 3)
    assert client.receive() == []
    hub.clock.advance(GRACE / 2)
    assert [(each["id"], each["msg"]) for each in client.receive()] == [
        ("a", CANNOT),
        ("b", CANNOT),
    ]
    client.send("advertise", "/fib", type=INT32)
    assert client.receive() == []
    client.disconnect()
    assert hub.empty
    assert hub.clock.timers == 0


def test_messages_do_not_wait_after_the_grace_period() -> None:
    hub = FakeHub()
    client = hub.client()
    hub.clock.advance(GRACE)
    client.send("publish", "/fib", msg=number(1))
    assert client.receive_statuses() == [CANNOT]
    assert hub.clock.timers == 0


# Messages of a topic whose advertise was refused.

REFUSALS: list[tuple[str, dict[str, Any], str]] = [
    ("/float", {"type": "Float"}, "Float"),
    ("/fib", {"type": "std_msgs/Int33"}, "did you mean std_msgs/Int32?"),
    ("/fib", {"type": "my_msgs/Fib"}, "Unable to load the manifest for package my_msgs"),
    ("/fib", {"type": "my_msgs/Fib", "definition": "int33 x"}, "int33"),
    ("/fib", {}, "Expected a type field but none was found."),
    ("/one_too_many", {"type": INT32}, "limit 1"),
]


def hub_that_refuses() -> tuple[FakeHub, Client]:
    """Return a hub with a topic /float, and a client to whom it refuses `REFUSALS`."""
    hub = FakeHub(strict_types=True, max_advertisements=1)
    hub.client("/other").send("advertise", "/float", type="std_msgs/Float64")
    return hub, hub.client("/talker")


@pytest.mark.parametrize(("topic", "fields", "reason"), REFUSALS)
@pytest.mark.parametrize("is_new", [True, False])
def test_messages_of_a_refused_topic_are_refused_at_once_with_its_reason(
    is_new: bool, topic: str, fields: dict[str, Any], reason: str
) -> None:
    hub, client = hub_that_refuses()
    if not is_new:
        hub.clock.advance(2 * GRACE)
    if topic == "/one_too_many":
        client.send("advertise", "/first", type=INT32)
    client.send("advertise", topic, **fields)
    [refusal] = client.receive_statuses()
    assert refusal.startswith("advertise: ")
    assert reason in refusal
    for id_ in range(1000):
        client.send("publish", topic, msg=number(1), id=id_)
    received = client.receive()
    assert [each["id"] for each in received] == [0, 9, 99, 999]
    for count, each in zip((1, 10, 100, 1000), received, strict=True):
        why = refusal.removeprefix("advertise: ")
        text = f"publish: {topic} could not be advertised: {why} (messages dropped: {count})"
        assert (each["level"], each["msg"]) == ("error", text)
    hub.clock.advance(2 * GRACE)
    assert client.receive() == []
    assert "/talker" not in hub.graph.topic(topic).sources


@pytest.mark.parametrize("spelling", ["/fib", "fib"])
def test_waiting_messages_of_a_refused_topic_are_refused_with_it(spelling: str) -> None:
    hub, client = hub_that_refuses()
    for _ in range(3):
        client.send("publish", spelling, msg=number(1))
    client.send("publish", "/other", msg=number(2))
    client.send("advertise", "/fib", type="std_msgs/Int33")
    operations = [text.partition(":")[0] for text in client.receive_statuses()]
    assert sorted(operations) == ["advertise", "publish"]
    client.send("advertise", "/other", type=INT32)
    hub.clock.advance(2 * GRACE)
    assert client.receive() == []
    assert list(client.session.topics.sources) == ["/other"]


def test_refused_topic_can_be_published_once_it_is_advertised() -> None:
    hub, client = hub_that_refuses()
    listener = hub.client()
    listener.send("subscribe", "/fib")
    for type_ in ("std_msgs/Int33", INT32):
        client.send("advertise", "/fib", type=type_)
        client.send("publish", "/fib", msg=number(1))
    assert len(client.receive_statuses()) == 2
    assert listener.receive_numbers("/fib") == [1]


def test_refused_topic_is_usable_after_unadvertise() -> None:
    hub, client = hub_that_refuses()
    client.send("advertise", "/float", type="std_msgs/Int33")
    client.send("unadvertise", "float")
    client.send("publish", "/float", msg={"data": 0.5})
    assert len(client.receive_statuses()) == 1
    assert "/talker" in hub.graph.topics["/float"].sources
    client.send("unadvertise", "not a name")
    assert client.receive() == []


def test_refused_advertise_does_not_stop_a_publisher_that_the_client_has() -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)
    talker.send("advertise", "/fib", type=STRING, id="again")
    talker.send("publish", "/fib", msg=number(1))
    assert len(talker.receive_statuses()) == 1
    assert listener.receive_numbers("/fib") == [1]


def test_number_of_remembered_refusals_is_limited() -> None:
    _, client = hub_that_refuses()
    for name in ("/a", "/b", "/c"):
        client.send("advertise", name, type="std_msgs/Int33")
    assert len(client.receive_statuses()) == 3
    client.send("publish", "/c", msg=number(1))
    [text] = client.receive_statuses()
    assert "did you mean std_msgs/Int32?" in text
    assert len(client.session.topics._refused) == 1


@pytest.mark.parametrize("how", ["advertise", "subscribe", "publish"])
def test_any_client_may_give_the_topic_its_type(how: str) -> None:
    hub = FakeHub()
    talker, listener = hub.client("/talker"), hub.client()
    talker.send("publish", "/fib", msg=number(1))
    other = hub.client("/other")
    other.send("subscribe" if how == "subscribe" else "advertise", "/fib", type=INT32)
    listener.send("subscribe", "/fib")
    if how == "publish":
        talker.send("publish", "/fib", msg=number(2))
        assert listener.receive_numbers("/fib") == [1, 2]
    else:
        hub.clock.advance(GRACE)
        assert listener.receive_numbers("/fib") == [1]
    assert "/talker" in hub.graph.topics["/fib"].sources
    assert talker.receive() == []


def test_pending_messages_of_both_spellings_belong_to_one_topic() -> None:
    hub = FakeHub()
    talker, listener = hub.client("/talker"), hub.client()
    listener.send("subscribe", "/talker/fib")
    talker.send("publish", "~fib", msg=number(1))
    talker.send("publish", "/talker/fib", msg=number(2))
    talker.send("advertise", "/talker/fib", type=INT32)
    assert listener.receive_numbers("/talker/fib") == [1, 2]


def test_pending_messages_of_other_topics_go_on_waiting() -> None:
    client = FakeHub().client()
    for topic in ("/a", "/b", "/a"):
        client.send("subscribe", topic)
        client.send("publish", topic, msg=number(1))
    client.send("advertise", "/a", type=INT32)
    assert client.receive_numbers("/a") == [1, 1]
    client.send("advertise", "/b", type=INT32)
    assert client.receive_numbers("/b") == [1]


def test_pending_message_that_does_not_fit_the_type_is_refused() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.send("subscribe", "/fib")
    for id_, data in (("a", 1), ("b", "text")):
        talker.send("publish", "/fib", msg={"data": data}, id=id_)
    talker.send("advertise", "/fib", type=STRING)
    [status] = talker.receive()
    assert status["id"] == "a"
    assert "requires a string for field data, but got an int" in status["msg"]
    assert listener.receive_messages("/fib") == [{"data": "text"}]


def test_pending_messages_are_forgotten_when_the_client_leaves() -> None:
    hub = FakeHub()
    client, other = hub.client(), hub.client()
    client.send("publish", "/fib", msg=number(1))
    client.disconnect()
    assert hub.clock.timers == 0
    other.send("subscribe", "/fib")
    other.send("advertise", "/fib", type=INT32)
    hub.clock.advance(GRACE)
    assert client.receive() == other.receive() == []


def test_message_whose_topic_is_known_does_not_wait() -> None:
    talker, listener = talker_and_listener(FakeHub())
    talker.send("publish", "/fib", msg=number(1))
    assert listener.receive_numbers("/fib") == [1]


@pytest.mark.parametrize("name", ["", "no name", "/"])
def test_invalid_name_is_refused_at_once(name: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("publish", name, msg={})
    assert "is not a legal name" in client.receive_statuses()[0]
    assert hub.clock.timers == 0


def test_pending_messages_are_limited_and_refused_once_each() -> None:
    hub = FakeHub()
    client = hub.client()
    half = {"data": "x" * (MOST_PENDING_BYTES // 2)}
    for id_ in range(5):
        client.send("publish", "/fib", msg=half, id=id_)
    hub.clock.advance(GRACE)
    statuses = client.receive()
    assert sorted(each["id"] for each in statuses) == [0, 1, 2, 3, 4]
    assert {each["msg"] for each in statuses} == {CANNOT}


@pytest.mark.parametrize(
    "fields",
    [{}, {"msg": {}}, {"id": "x" * 1000}, {"topic": f"/{'x' * 1000}"}],
    ids=["no message", "empty message", "long id", "long topic"],
)
@pytest.mark.long
def test_small_messages_count_with_their_overhead(fields: dict[str, Any]) -> None:
    hub = FakeHub()
    client = hub.client()
    fields = {"topic": "/fib", **fields}
    size = 100 + len(encode(Publish(**fields)))
    count = 2 * MOST_PENDING_BYTES // size
    client.send_text(json.dumps({"op": "publish", **fields}) * min(count, MAX_OBJECTS))
    for _ in range(count // MAX_OBJECTS):
        client.send_text(json.dumps({"op": "publish", **fields}) * MAX_OBJECTS)
    refused = client.receive_statuses()
    assert refused
    hub.clock.advance(GRACE)
    assert client.receive_statuses()
    assert hub.clock.timers == 0


def test_pending_messages_are_published_once() -> None:
    hub = FakeHub()
    client, listener = hub.client(), hub.client()
    listener.send("subscribe", "/fib")
    client.send("publish", "/fib", msg=number(1))
    client.send("publish", "/other", msg=number(2))
    for _ in range(2):
        client.send("advertise", "/fib", type=INT32)
    hub.clock.advance(GRACE)
    assert listener.receive_numbers("/fib") == [1]
    assert len(client.receive_statuses()) == 1  # About /other.
    assert hub.clock.timers == 0
