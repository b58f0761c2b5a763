"""Definitions that clients bring: known while in use, then forgotten."""

from __future__ import annotations

import gc
import json
import weakref
from typing import Any

import cbor2
import pytest

from fibws.hub.graph.types import CheckedType, Codecs
from fibws.interfaces import client_definitions
from fibws.interfaces.client_definitions import DefinitionLimits

from ..fakes import INT32, TEXT, Client, FakeHub, number

THING = "my_msgs/Thing"
OLDER, NEWER = "int8 one\n", "int8 one\nint8 two\n"
POINT = f"{'=' * 80}\nMSG: my_msgs/Point\n"
KINDS = ["topic", "service", "action"]


def advertise(client: Client, kind: str, name: str, fields: str) -> None:
    """Advertise a topic, a service or an action of a type that has these fields."""
    if kind == "topic":
        client.send("advertise", name, type=THING, definition=fields)
    elif kind == "service":
        definition = f"{fields}---\n"
        client.send("advertise_service", service=name, type=THING, definition=definition)
    else:
        definition = f"{fields}---\n---\n"
        client.send("advertise_action", action=name, type=THING, definition=definition)


def unadvertise(client: Client, kind: str, name: str) -> None:
    op = "unadvertise" if kind == "topic" else f"unadvertise_{kind}"
    client.send(op, **{kind: name})


def known(hub: FakeHub) -> set[str]:
    """Return the types that clients brought."""
    return {name for _, name in hub.graph.definitions._by_type}


# Forgotten with the last user.


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("end", ["leave", "unadvertise"])
def test_types_of_one_name_have_each_the_definition_of_their_nodes(kind: str, end: str) -> None:
    hub = FakeHub()
    older, newer = hub.client("/older"), hub.client("/newer")
    advertise(older, kind, "/a", OLDER)
    advertise(newer, kind, "/b", NEWER)
    assert newer.receive() == []
    graph = hub.graph
    md5s: dict[str, set[Any]] = {
        "topic": {each.type and each.type.md5sum for each in graph.topics.values()},
        "service": {each.type.md5sum for each in graph.services.values()},
        "action": {each.type.md5sum for each in graph.actions.values()},
    }
    assert len(md5s[kind]) >= 2
    for client, name in ((older, "/a"), (newer, "/b")):
        assert known(hub) != set()
        if end == "leave":
            client.disconnect()
        else:
            unadvertise(client, kind, name)
    assert not known(hub)


def test_publisher_without_a_definition_uses_a_known_one_and_keeps_it() -> None:
    hub = FakeHub()
    first, second = hub.client(), hub.client("/second")
    advertise(first, "topic", "/a", OLDER)
    second.send("advertise", "/b", type=THING)
    first.disconnect()
    second.send("publish", "/b", msg={"one": 1000})
    assert "1000 is not in -128..127" in second.receive_statuses()[0]
    assert known(hub) == {THING}
    second.disconnect()
    assert not known(hub)


@pytest.mark.parametrize("kind", KINDS)
def test_server_or_publisher_may_be_replaced_by_one_of_another_type(kind: str) -> None:
    hub = FakeHub()
    first, second = hub.client(), hub.client()
    advertise(first, kind, "/a", OLDER)
    if kind == "topic":
        first.disconnect()
        second.send("advertise", "/a", type=INT32)
    elif kind == "service":
        second.send("advertise_service", service="/a", type="std_srvs/Empty")
    else:
        second.send("advertise_action", action="/a", type="example_interfaces/Fibonacci")
    assert second.receive() == []
    assert not known(hub)


def test_nested_types_are_forgotten_with_the_type_that_has_them() -> None:
    hub = FakeHub()
    first, second = hub.client(), hub.client("/second")
    advertise(first, "topic", "/a", f"Point at\n{POINT}int8 x")
    second.send("advertise", "/b", type="my_msgs/Point")
    first.disconnect()
    second.send("publish", "/b", msg={"x": "1"})
    assert "requires an int8 for field x" in second.receive_statuses()[0]
    second.disconnect()
    assert not known(hub)


def test_definition_refused_for_its_md5_is_not_kept() -> None:
    hub = FakeHub()
    client = hub.client()
    for md5sum in ("0" * 32, "1" * 32):
        client.send("advertise", "/a", type=THING, definition=OLDER, md5sum=md5sum)
        client.send("subscribe", "/a", type=THING, definition=OLDER, md5sum=md5sum)
        assert [md5sum in status for status in client.receive_statuses()] == [True, True]
    assert not known(hub)
    advertise(client, "topic", "/a", NEWER)
    assert client.receive() == []


def test_refused_subscription_leaves_no_definition() -> None:
    hub = FakeHub(max_subscriptions=1)
    client = hub.client()
    client.send("subscribe", "/a")
    client.send("subscribe", "/b", type=THING, definition=OLDER)
    assert "limit 1" in client.receive_statuses()[0]
    assert not known(hub)


def test_definition_decides_whether_types_have_equal_fields() -> None:
    hub = FakeHub()
    talker, other = hub.client(), hub.client()
    talker.send("advertise", "/n", type=INT32)
    for fields in ({}, {"definition": "int64 data"}):
        other.send("advertise", "/n", type="my_msgs/Number", **fields)
        assert "type std_msgs/Int32" in other.receive_statuses("warning")[0]
        other.send("unadvertise", "/n")
    talker.receive()
    other.send("advertise", "/n", type="my_msgs/Number", definition="int32 data", md5sum="0" * 32)
    assert "0" * 32 in other.receive_statuses()[0]
    other.send("advertise", "/n", type="my_msgs/Number", definition="int32 data")
    assert other.receive() == []
    assert not known(hub)


def test_call_in_progress_is_answered_by_the_definition_that_it_was_made_with() -> None:
    hub = FakeHub()
    older, newer, caller = hub.client(), hub.client(), hub.client()
    definition = f"---\nPoint at\n{POINT}int8 x"
    older.send("advertise_service", service="/a", type=THING, definition=definition)
    caller.send("call_service", service="/a", id="x")
    [call] = older.receive()
    newer.send("advertise_service", service="/a", type="std_srvs/Empty")
    newer.send("advertise", "/p", type="my_msgs/Point", definition="string x")
    response = {"op": "service_response", "service": "/a", "id": call["id"], "result": True}
    older.send(**response, values={"at": {"x": "1"}})
    assert "requires an int8 for field at.x" in caller.receive_one("service_response")["values"]


# Subscribers.


@pytest.mark.parametrize("compression", ["none", "cbor"])
def test_subscriber_that_names_a_type_follows_its_new_definition(compression: str) -> None:
    """A page goes on showing a topic while its publisher is being developed."""
    hub = FakeHub()
    older, newer, page = hub.client(), hub.client(), hub.client()
    page.send("subscribe", "/a", type=THING, compression=compression)
    advertise(older, "topic", "/a", OLDER)
    older.send("publish", "/a", msg={"one": 1})
    older.disconnect()
    assert not known(hub)
    newer.send("advertise", "/a", type=INT32)
    newer.send("unadvertise", "/a")
    advertise(newer, "topic", "/a", NEWER)
    newer.send("publish", "/a", msg={"one": 1})
    assert newer.receive() == []
    frames = page.receive_frames()
    received = [
        json.loads(data) if first == TEXT else cbor2.loads(data)
        for first, data in frames
        if b"status" not in data
    ]
    assert [each["msg"] for each in received] == [{"one": 1}, {"one": 1, "two": 0}]


@pytest.mark.parametrize(
    "fields",
    [{"definition": OLDER}, {"md5sum": "*"}, {"compression": "cbor-raw"}, {"compression": "ros1"}],
)
def test_subscriber_that_relies_on_the_fields_keeps_the_definition(
    fields: dict[str, str],
) -> None:
    hub = FakeHub()
    older, listener = hub.client(), hub.client("/listener", serialized=True)
    advertise(older, "topic", "/a", OLDER)
    listener.send("subscribe", "/a", type=THING, **fields)
    older.disconnect()
    assert known(hub) == {THING}
    listener.send("unsubscribe", "/a")
    assert not known(hub)


def test_subscriber_that_names_a_type_keeps_its_definition_if_types_are_strict() -> None:
    hub = FakeHub(strict_types=True)
    older, listener = hub.client(), hub.client("/listener")
    advertise(older, "topic", "/a", OLDER)
    listener.send("subscribe", "/a", type=THING)
    older.disconnect()
    assert known(hub) == {THING}


def test_topic_with_a_subscriber_alone_takes_a_definition_that_is_known_elsewhere() -> None:
    hub = FakeHub()
    first, second, listener = hub.client(), hub.client(), hub.client()
    advertise(first, "topic", "/a", OLDER)
    listener.send("subscribe", "/b", type=THING)
    second.send("advertise", "/b", type=THING)
    second.send("publish", "/b")
    assert listener.receive_messages("/b") == [{"one": 0}]


def test_serialized_messages_of_another_definition_have_another_number() -> None:
    hub = FakeHub()
    older, newer, listener = hub.client(), hub.client(), hub.client(serialized=True)
    listener.send("subscribe", "/a", compression="ros1")
    answers = []
    for client, fields in ((older, OLDER), (newer, NEWER)):
        advertise(client, "topic", "/a", fields)
        client.send("publish", "/a")
        answers.append(listener.receive_frames()[0][1])
        client.disconnect()
    assert answers[0] != answers[1]
    numbers = {answer.partition(b'"topic_id":')[2].partition(b",")[0] for answer in answers}
    assert len(numbers) == 2


# Limits.


@pytest.fixture
def little_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_definitions, "PER_CLIENT", DefinitionLimits(1, 1000, 1000))


@pytest.mark.usefixtures("little_room")
@pytest.mark.parametrize("kind", KINDS)
def test_without_room_for_a_definition_messages_are_relayed_with_a_warning(
    kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    hub = FakeHub()
    greedy, other = hub.client("/greedy"), hub.client("/other")
    greedy.send("set_level", level="warning")
    greedy.send("advertise", "/first", type="my_msgs/First", definition="int8 x")
    advertise(greedy, kind, "/a", f"Point at\n{POINT}int8 x\n" if kind == "topic" else OLDER)
    [status] = greedy.receive_statuses("warning")
    assert f"{THING} are not checked: too many definitions from /greedy" in status
    assert "limit is 1" in caplog.text
    advertise(other, "topic", "/b", NEWER)
    assert other.receive() == []


@pytest.mark.usefixtures("little_room")
def test_messages_without_room_for_their_definition_are_not_checked() -> None:
    hub = FakeHub()
    greedy, listener = hub.client("/greedy"), hub.client()
    greedy.send("advertise", "/first", type="my_msgs/First", definition="int8 x")
    advertise(greedy, "topic", "/a", OLDER)
    listener.send("subscribe", "/a", type=THING)
    greedy.send("publish", "/a", msg={"any": "thing"})
    assert listener.receive_messages("/a") == [{"any": "thing"}]
    greedy.send("unadvertise", "/first")
    greedy.send("advertise", "/a", type=THING, definition=OLDER, id="again")
    greedy.send("publish", "/a", msg={"any": "thing"})
    assert "does not have a field any" in greedy.receive_statuses()[0]


@pytest.mark.usefixtures("little_room")
def test_subscriber_without_room_for_its_definition_is_warned() -> None:
    client = FakeHub().client()
    client.send("set_level", level="warning")
    client.send("advertise", "/first", type="my_msgs/First", definition="int8 x")
    client.send("subscribe", "/a", type=THING, definition=OLDER, id="x")
    status = client.receive_one("status")
    assert (status["id"], status["level"]) == ("x", "warning")
    assert "limit is 1" in status["msg"]


@pytest.mark.usefixtures("little_room")
@pytest.mark.parametrize(
    "operation",
    [{"op": "advertise", "publisher": 1}, {"op": "subscribe", "compression": "ros1"}],
)
def test_serialized_messages_without_room_for_their_definition_are_refused(
    operation: dict[str, Any],
) -> None:
    hub = FakeHub()
    client = hub.client(serialized=True)
    client.send("advertise", "/first", type="my_msgs/First", definition="int8 x")
    client.send(**operation, topic="/a", type=THING, definition=OLDER)
    [status] = client.receive_statuses()
    assert f"need the definition of {THING}, which is unknown: too many definitions" in status
    assert list(hub.graph.topics) == ["/first"]


@pytest.mark.usefixtures("little_room")
@pytest.mark.parametrize("kind", KINDS)
def test_strict_types_refuse_a_definition_without_room(kind: str) -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.send("advertise", "/first", type="my_msgs/First", definition="int8 x")
    advertise(client, kind, "/a", f"Point at\n{POINT}int8 x\n" if kind == "topic" else OLDER)
    assert "limit is 1" in client.receive_statuses()[0]
    assert known(hub) == {"my_msgs/First"}


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_left_of_definitions_that_are_forgotten(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    original = Codecs.__init__

    def remembered(self: Codecs, *args: Any) -> None:
        original(self, *args)
        made.append(weakref.ref(self))

    hub = FakeHub()
    listener = hub.client()
    listener.send("subscribe", "/a", compression="cbor-raw")
    monkeypatch.setattr(Codecs, "__init__", remembered)
    for each in range(50):
        client = hub.client()
        nested = f"Point at\n{POINT}int8 x" if kind == "topic" else ""
        advertise(client, kind, "/a", f"int8 x{each}\nfloat32 y\n{nested}")
        if kind == "topic":
            client.send("publish", "/a")
        client.disconnect()
    listener.disconnect()
    definitions = hub.graph.definitions
    assert not (definitions._by_type or definitions._holders or definitions._usage)
    assert not hub.graph._types._brought
    gc.collect()
    assert len(made) == 50
    assert not [each for each in made if each() is not None]


def test_types_of_the_standard_packages_are_kept() -> None:
    hub = FakeHub()
    types = []
    for _ in range(2):
        client = hub.client()
        client.send("advertise", "/a", type=INT32, definition="int32 data")
        types.append(hub.graph.topics["/a"].type)
        client.send("publish", "/a", msg=number(1))
        client.disconnect()
    assert isinstance(types[0], CheckedType)
    assert types[0] is types[1]


def test_refused_definitions_are_forgotten_when_their_client_leaves() -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("advertise", "/a", type="new_msgs/Mine", definition="int32 1x")
    assert hub.graph.definitions._refusals
    client.disconnect()
    assert not hub.graph.definitions._refusals
