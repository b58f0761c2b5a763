"""Conflicts of types: states of a topic in which those who fit each other exchange messages.

The matrix is who came first, who is right, by which protocol each of them came, and how the
conflict ends.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Iterator
from itertools import permutations, product
from typing import Any

import pytest

from fibws.hub.graph.conflicts import MOST_TYPES
from fibws.interfaces import client_definitions
from fibws.interfaces.client_definitions import DefinitionLimits
from fibws.protocol.serialized import publish_head, read_delivery

from .fakes import INT32, STRING, FakeHub, number
from .foxglove.foxglove_client import FoxgloveHub
from .graph.test_policy import Forbid

TOPIC = "/scan"


class Talker:
    """A publisher, as clients of one protocol have it."""

    def __init__(self, hub: FoxgloveHub, node: str, protocol: str, type_: str) -> None:
        self.node = node
        self.protocol = protocol
        self.type = type_
        if protocol == "foxglove":
            self.foxglove = hub.foxglove_client(node)
        else:
            self.client = hub.client(node, serialized=protocol == "fibws.v1")
        self.warnings: list[str] = []

    def join(self) -> None:
        if self.protocol == "foxglove":
            fields = {"id": 1, "topic": TOPIC, "encoding": "ros1", "schemaName": self.type}
            self.foxglove.send("advertise", channels=[fields])
        else:
            publisher = {"publisher": 1} if self.protocol == "fibws.v1" else {}
            self.client.send("advertise", TOPIC, type=self.type, **publisher)

    def publish(self, value: int) -> None:
        text = str(value).encode()
        is_text = self.type == STRING
        data = struct.pack("<I", len(text)) + text if is_text else struct.pack("<i", value)
        match self.protocol:
            case "foxglove":
                self.foxglove.send_binary(struct.pack("<BI", 1, 1) + data)
            case "fibws.v1":
                self.client.send_binary(publish_head(1) + data)
            case _:
                self.client.send("publish", TOPIC, msg={"data": str(value) if is_text else value})

    def statuses(self) -> list[str]:
        """Return the texts of the warnings that came."""
        if self.protocol == "foxglove":
            found = [each for each in self.foxglove.receive() if isinstance(each, dict)]
            return [each["message"] for each in found if each["op"] == "status"]
        return [each["msg"] for each in self.client.receive() if each["op"] == "status"]

    def leave(self) -> None:
        if self.protocol == "foxglove":
            self.foxglove.disconnect()
        else:
            self.client.disconnect()


class Listener:
    """A subscriber of rosbridge or ``fibws.v1``."""

    def __init__(self, hub: FoxgloveHub, node: str, protocol: str, type_: str | None) -> None:
        self.node = node
        self.protocol = protocol
        self.type = type_
        self.client = hub.client(node, serialized=protocol == "fibws.v1")
        self._statuses: list[str] = []
        self._types: dict[int, str] = {}

    def join(self) -> None:
        serialized = {"compression": "ros1"} if self.protocol == "fibws.v1" else {}
        self.client.send("subscribe", TOPIC, type=self.type, **serialized)

    def receive(self) -> list[Any]:
        """Return the ``data`` of the messages that came since the last call."""
        found = []
        for first, payload in self.client.receive_frames():
            if first == 0x82:
                delivery = read_delivery(payload)
                is_text = self._types[delivery.topic] == STRING
                message = bytes(delivery.message)
                found.append(message[4:].decode() if is_text else struct.unpack("<i", message)[0])
                continue
            operation = json.loads(payload)
            match operation["op"]:
                case "subscribed":
                    self._types[operation["topic_id"]] = operation["type"]
                case "status":
                    self._statuses.append(operation["msg"])
                case "publish":
                    found.append(operation["msg"]["data"])
        return found

    def statuses(self) -> list[str]:
        """Return the texts of the warnings that came."""
        assert self.receive() == []
        found, self._statuses = self._statuses, []
        return found

    def leave(self) -> None:
        self.client.disconnect()


PUBLISHERS = ("json", "fibws.v1", "foxglove")
SUBSCRIBERS = ("json", "fibws.v1")
ORDERS = list(permutations(("wrong", "talker", "listener")))


def conflicts(hub: FakeHub) -> dict[str, str]:
    """Return the nodes that are shown in conflict, with their types."""
    topic = hub.graph.topics[TOPIC]
    return {each.node: each.type for each in hub.graph.view("/page").conflicts(topic)}


def matrix() -> Iterator[Any]:
    for order in ORDERS:
        for talker, listener in product(PUBLISHERS, SUBSCRIBERS):
            for is_publisher, kinds in ((True, PUBLISHERS), (False, SUBSCRIBERS)):
                for wrong in kinds:
                    role = "publisher" if is_publisher else "subscriber"
                    id_ = f"{'-'.join(order)}-{talker}-{listener}-wrong-{role}-{wrong}"
                    yield pytest.param(order, talker, listener, is_publisher, wrong, id=id_)


@pytest.mark.parametrize(("order", "talker", "listener", "is_publisher", "wrong"), list(matrix()))
@pytest.mark.parametrize("end", ["wrong leaves", "right leave"])
def test_those_who_fit_exchange_messages_whoever_came_first(
    order: tuple[str, ...],
    talker: str,
    listener: str,
    is_publisher: bool,
    wrong: str,
    end: str,
) -> None:
    hub = FoxgloveHub()
    make: Callable[..., Any] = Talker if is_publisher else Listener
    nodes: dict[str, Any] = {
        "wrong": make(hub, "/wrong", wrong, STRING),
        "talker": Talker(hub, "/talker", talker, INT32),
        "listener": Listener(hub, "/listener", listener, INT32),
    }
    for each in order:
        nodes[each].join()
    right, left = nodes["talker"], nodes["listener"]
    right.publish(1)
    assert left.receive() == [1]

    # Those in conflict are told the other type and who has it.
    others = nodes["wrong"]
    if is_publisher:
        others.publish(7)
        assert f"{STRING} (published by /wrong)" in " ".join(right.statuses())
        assert f"{STRING} (published by /wrong)" in " ".join(left.statuses())
    else:
        assert others.receive() == []
        assert right.statuses() == []
    assert f"{INT32} (published by /talker)" in " ".join(others.statuses())
    shown = conflicts(hub)
    assert shown in ({"/wrong": STRING}, {"/talker": INT32, "/listener": INT32})
    if not is_publisher:
        assert shown == {"/wrong": STRING}

    if end == "wrong leaves":
        others.leave()
        assert conflicts(hub) == {}
        right.publish(2)
        assert left.receive() == [2]
        return
    right.leave()
    left.leave()
    assert conflicts(hub) == {}
    counterpart: Callable[..., Any] = Listener if is_publisher else Talker
    late = counterpart(hub, "/late", "json", STRING)
    late.join()
    (others if is_publisher else late).publish(3)
    assert (late if is_publisher else others).receive() == ["3"]


@pytest.mark.parametrize("listener", SUBSCRIBERS)
@pytest.mark.parametrize("first", [INT32, STRING])
def test_topic_may_have_two_types_of_which_each_message_goes_to_those_who_fit(
    first: str, listener: str
) -> None:
    hub = FoxgloveHub()
    types = sorted((INT32, STRING), key=lambda type_: type_ != first)
    talkers = [Talker(hub, f"/talker{each}", "json", type_) for each, type_ in enumerate(types)]
    listeners = [Listener(hub, f"/for{each}", listener, type_) for each, type_ in enumerate(types)]
    every = Listener(hub, "/all", listener, None)
    for each in (listeners[1], talkers[0], every, talkers[1], listeners[0]):
        each.join()
    for value in range(3):
        for talker in talkers:
            talker.publish(value)
    numbers, texts = [0, 1, 2], ["0", "1", "2"]
    expected = (numbers, texts) if first == INT32 else (texts, numbers)
    assert [each.receive() for each in listeners] == list(expected)
    mixed = every.receive()
    assert sorted(map(str, mixed)) == ["0", "0", "1", "1", "2", "2"]
    assert [each for each in mixed if isinstance(each, int)] == numbers


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_client_gets_a_warning_with_the_id_of_its_registration(op: str) -> None:
    hub = FakeHub()
    hub.client("/talker").send("advertise", "/a", type=INT32)
    plain, serialized = hub.client(), hub.client(serialized=True)
    for client in (plain, serialized):
        client.send(op, "/a", type=STRING, id="x")
        status = client.receive_one("status")
        assert (status["level"], status["id"]) == ("warning", "x")
        assert status.get("code") == ("type_conflict" if client is serialized else None)


def test_warning_comes_once_for_each_request_and_an_information_when_it_is_over() -> None:
    hub = FakeHub()
    talker, client = hub.client("/talker"), hub.client()
    client.send("set_level", level="info")
    client.send("subscribe", "/a", type=STRING, id="x")
    client.receive()
    talker.send("advertise", "/a", type=INT32)
    assert [(each["level"], each["id"]) for each in client.receive()] == [("warning", "x")]
    client.send("subscribe", "/a", type=STRING, id="y")
    assert ("warning", "y") in [(each["level"], each.get("id")) for each in client.receive()]
    hub.client().send("advertise", "/a", type=INT32)
    assert client.receive() == []
    for each in list(hub.graph.topics["/a"].publishers.values()):
        hub.graph.remove_source(each)
    assert {(each["level"], each["id"]) for each in client.receive()} == {
        ("info", "x"),
        ("info", "y"),
    }


def test_page_that_also_names_a_wrong_type_still_gets_what_it_asked_for_without_one() -> None:
    hub = FakeHub()
    talker, page = hub.client("/talker"), hub.client()
    page.send("subscribe", "/a", id="any")
    page.send("subscribe", "/a", type=STRING, id="wrong")
    talker.send("advertise", "/a", type=INT32)
    assert INT32 in page.receive_one("status")["msg"]
    talker.send("publish", "/a", msg=number(1))
    assert page.receive_numbers("/a") == [1]
    page.send("unsubscribe", "/a", id="any")
    talker.send("publish", "/a", msg=number(2))
    assert page.receive() == []
    page.send("unsubscribe", "/a", id="wrong")
    talker.disconnect()
    page.disconnect()
    assert hub.empty


def test_client_cannot_publish_two_types_of_one_topic_itself() -> None:
    hub = FakeHub()
    client = hub.client("/talker")
    client.send("advertise", "/a", type=INT32, id="x")
    client.send("advertise", "/a", type=STRING, id="y")
    [status] = client.receive_statuses()
    assert f"{INT32} (by /talker)" in status
    assert "end its other publisher first" in status
    assert [each.type and each.type.name for each in hub.graph.topics["/a"].groups] == [INT32]


@pytest.mark.parametrize("first", [INT32, STRING])
@pytest.mark.parametrize("serialized", [False, True])
def test_client_may_subscribe_with_a_wrong_type_beside_the_right_one(
    first: str, serialized: bool
) -> None:
    hub = FakeHub()
    talker, client = hub.client("/talker"), hub.client("/page", serialized=serialized)
    compression = {"compression": "ros1", "credit": 2} if serialized else {}
    second = STRING if first == INT32 else INT32
    for type_ in (first, second):
        client.send("subscribe", TOPIC, type=type_, id=type_, peers=True, **compression)
    client.receive_frames()
    talker.send("advertise", TOPIC, type=INT32)
    talker.send("publish", TOPIC, msg=number(1))
    frames = client.receive_frames()
    found = [json.loads(data) for one, data in frames if one != 0x82]
    assert [each["id"] for each in found if each["op"] == "status"] == [STRING]
    peers = [(each["id"], each["nodes"]) for each in found if each["op"] == "peers"]
    assert peers == [(INT32, ["/talker"])]

    def received() -> int:
        """Return how many messages came."""
        frames = client.receive_frames()
        return sum(one == 0x82 or b'"publish"' in data for one, data in frames)

    assert sum(one == 0x82 or b'"op":"publish"' in data for one, data in frames) == 1
    for _ in range(3):
        talker.send("publish", TOPIC, msg=number(2))
    if serialized:
        assert received() == 1
        client.send("acknowledge", TOPIC, count=2)
        assert received() == 1  # The newest one.
        client.send("acknowledge", TOPIC, count=2)
    else:
        assert received() == 3
    client.send("unsubscribe", TOPIC, id=STRING)
    talker.send("publish", TOPIC, msg=number(3))
    assert received() == 1
    client.send("unsubscribe", TOPIC)
    talker.send("publish", TOPIC, msg=number(4))
    assert received() == 0
    assert client.session.topics.subscription_count == 0
    for each in (talker, client):
        each.disconnect()
    assert hub.empty


def test_request_that_comes_again_with_another_type_leaves_its_first_subscription() -> None:
    hub = FakeHub()
    client = hub.client("/page")
    for id_, type_ in (("x", INT32), ("y", INT32), ("z", STRING), ("x", STRING)):
        client.send("subscribe", TOPIC, type=type_, id=id_)
    groups = hub.graph.topics[TOPIC].groups
    assert [group.type and group.type.name for group in groups] == [INT32, STRING]
    client.send("unsubscribe", TOPIC, id="y")
    assert [group.type and group.type.name for group in groups if group.is_used] == [STRING]


def test_client_that_subscribes_without_a_type_too_gets_each_message_once() -> None:
    hub = FakeHub()
    first, second, page = hub.client(), hub.client(), hub.client("/page")
    first.send("advertise", TOPIC, type=INT32)
    second.send("advertise", TOPIC, type=STRING)

    def expect(count: int) -> None:
        page.receive()
        for talker, value in ((first, 1), (second, "x")):
            talker.send("publish", TOPIC, msg={"data": value})
        assert len(messages(page)) == count

    for request, count in (
        ({"type": INT32, "id": "i"}, 1),
        ({"type": STRING, "id": "s"}, 2),
        ({"id": "any"}, 2),
        ({"type": "std_msgs/Bool", "id": "b"}, 2),
    ):
        page.send("subscribe", TOPIC, **request)
        expect(count)
    page.send("unsubscribe", TOPIC)
    expect(0)


def test_subscriptions_with_further_types_are_limited() -> None:
    client = FakeHub(max_subscriptions=2).client()
    for type_ in (INT32, STRING, "std_msgs/Bool"):
        client.send("subscribe", TOPIC, type=type_, id=type_)
    assert "limit 2" in client.receive()[-1]["msg"]
    assert client.session.registrations("subscriptions") == 2


def test_types_with_equal_fields_are_no_conflict() -> None:
    hub = FakeHub()
    talker, listener = hub.client(), hub.client()
    listener.send("subscribe", "/p", type="geometry_msgs/Vector3")
    talker.send("advertise", "/p", type="geometry_msgs/Point")
    talker.send("publish", "/p", msg={"x": 1.0})
    assert listener.receive_messages("/p") == [{"x": 1.0, "y": 0.0, "z": 0.0}]
    assert talker.receive() == []


def test_latched_messages_are_replayed_to_those_of_their_type() -> None:
    hub = FakeHub()
    first, second, listener = hub.client(), hub.client(), hub.client()
    first.send("advertise", "/a", type=INT32, latch=True)
    second.send("advertise", "/a", type=STRING, latch=True)
    first.send("publish", "/a", msg=number(1))
    second.send("publish", "/a", msg={"data": "x"})
    listener.send("subscribe", "/a", type=STRING)
    received = listener.receive()
    assert [each["msg"] for each in received if each["op"] == "publish"] == [{"data": "x"}]


def test_publishers_see_only_the_subscribers_that_fit_them() -> None:
    hub = FakeHub()
    talker, wrong, page = hub.client("/talker"), hub.client("/wrong"), hub.client("/page")
    wrong.send("subscribe", "/a", type=STRING, peers=True)
    page.send("subscribe", "/a", peers=True)
    talker.send("advertise", "/a", type=INT32, peers=True)
    assert talker.receive_one("peers")["nodes"] == ["/page"]
    assert [each["nodes"] for each in page.receive()] == [[], ["/talker"]]
    assert [each["nodes"] for each in wrong.receive() if each["op"] == "peers"] == [[]]
    wrong.send("subscribe", "/a", peers=True, id="any")
    assert ["/page", "/wrong"] in [each["nodes"] for each in talker.receive()]


def test_topics_own_type_is_that_of_its_publishers() -> None:
    hub = FakeHub()
    wrong, talker = hub.client("/wrong"), hub.client("/talker")
    wrong.send("subscribe", "/a", type=STRING)
    topic = hub.graph.topics["/a"]
    types = [topic.type]
    talker.send("advertise", "/a", type=INT32)
    types.append(topic.type)
    talker.disconnect()
    types.append(topic.type)
    assert [each and each.name for each in types] == [STRING, INT32, STRING]


def test_subscribers_may_name_only_so_many_types_and_publishers_any() -> None:
    hub = FakeHub()
    clients = [hub.client() for _ in range(MOST_TYPES + 2)]
    for each, client in enumerate(clients):
        client.send("subscribe", "/a", type=f"my_msgs/T{each}")
    texts = [status["msg"] for status in clients[-1].receive()]
    assert f"limit {MOST_TYPES}" in texts[0]
    talker, listener = hub.client(), hub.client()
    talker.send("advertise", "/a", type=INT32)
    listener.send("subscribe", "/a", type=INT32)
    talker.send("publish", "/a", msg=number(1))
    assert listener.receive_numbers("/a") == [1]


def test_many_members_are_told_in_turns() -> None:
    hub = FakeHub()
    work: list[Iterator[None]] = []
    hub.graph.finish = work.append
    clients = [hub.client() for _ in range(3)]
    for client in clients:
        client.send("subscribe", "/a", type=STRING)
    talker = hub.client()
    talker.send("advertise", "/a", type=INT32)
    [steps] = work
    next(steps)
    assert [len(client.receive()) for client in clients] == [1, 0, 0]
    talker.disconnect()
    assert list(steps) == []  # The newer work tells all of them.
    for step in work[1:]:
        list(step)
    assert [len(client.receive()) for client in clients] == [0, 0, 0]


def test_node_without_the_right_to_publish_does_not_hold_a_type() -> None:
    viewer = FakeHub(policy=Forbid(("/page", "publish", "/a")))
    page, robot = viewer.client("/page"), viewer.client("/robot")
    page.send("subscribe", "/a", type=STRING)
    assert viewer.graph.topics["/a"].type is None
    assert page.receive() == []
    robot.send("advertise", "/a", type=INT32)
    assert "/robot" in page.receive_one("status")["msg"]
    robot.disconnect()
    assert viewer.graph.topics["/a"].type is None


def test_log_keeps_its_type() -> None:
    hub = FakeHub()
    hub.graph.rights.guards["/rosout"] = lambda node, values: None
    hub.client("/talker").send("advertise", "/rosout", type="rosgraph_msgs/Log")
    client = hub.client()
    client.send("advertise", "/rosout", type=INT32)
    assert "rosgraph_msgs/Log (by /talker)" in client.receive_statuses()[0]
    assert len(hub.graph.topics["/rosout"].groups) == 1


# Types of one name with other fields.

THING = "my_msgs/Thing"
MINE, YOURS = "int8 x", "int8 x\nint8 y"


def messages(client: Any) -> list[Any]:
    """Return the messages that came, without statuses."""
    return [each["msg"] for each in client.receive() if each["op"] == "publish"]


def bring(client: Any, op: str, fields: str, **more: Any) -> None:
    client.send(op, TOPIC, type=THING, definition=fields, **more)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("is_publisher", [True, False])
def test_types_of_one_name_with_other_fields_are_in_conflict(
    order: tuple[str, ...], is_publisher: bool
) -> None:
    hub = FakeHub()
    clients = {each: hub.client(f"/{each}") for each in order}
    ops = {"wrong": "advertise" if is_publisher else "subscribe"}
    ops |= {"talker": "advertise", "listener": "subscribe"}
    for each in order:
        bring(clients[each], ops[each], YOURS if each == "wrong" else MINE)
    talker, listener, wrong = (clients[each] for each in ("talker", "listener", "wrong"))
    talker.send("publish", TOPIC, msg={"x": 1})
    assert messages(listener) == [{"x": 1}]
    if is_publisher:
        wrong.send("publish", TOPIC, msg={"x": 1, "y": 2})
        assert messages(listener) == []
    status = wrong.receive()[-1]["msg"]
    assert f"{THING} with other fields (md5sum " in status
    assert "(published by /talker)" in status
    assert set(conflicts(hub)) in ({"/wrong"}, {"/talker", "/listener"})
    shown = hub.graph.view("/page").conflicts(hub.graph.topics[TOPIC])
    assert all(each.fault.endswith(f"(md5sum {each.md5sum})") for each in shown)
    wrong.disconnect()
    assert conflicts(hub) == {}
    late = hub.client()
    bring(late, "subscribe", MINE)
    talker.send("publish", TOPIC, msg={"x": 2})
    assert messages(late) == [{"x": 2}]
    for client in (talker, listener, late):
        client.disconnect()
    assert hub.empty


def test_definition_is_of_no_concern_to_other_topics() -> None:
    hub = FakeHub()
    first, second = hub.client(), hub.client()
    first.send("advertise", "/a", type=INT32, definition="int8 data\nint8 more")
    second.send("advertise", "/b", type=INT32)
    second.send("publish", "/b", msg=number(2**20))
    first.send("publish", "/a", msg={"data": 1, "more": 2})
    assert first.receive() == second.receive() == []
    first.send("publish", "/a", msg=number(2**20))
    assert "is not in -128..127" in first.receive_statuses()[0]


@pytest.mark.parametrize("serialized", [False, True])
def test_subscriber_that_only_names_a_type_follows_its_publishers(serialized: bool) -> None:
    hub = FakeHub()
    older, newer, keeper = hub.client("/older"), hub.client("/newer"), hub.client("/keeper")
    page = hub.client("/page", serialized=serialized)
    compression = {"compression": "ros1"} if serialized else {}
    bring(keeper, "subscribe", MINE)
    page.send("subscribe", TOPIC, type=THING, peers=True, **compression)
    bring(older, "advertise", MINE, latch=True)
    bring(newer, "advertise", YOURS, latch=True)
    older.send("publish", TOPIC, msg={"x": 1})
    newer.send("publish", TOPIC, msg={"x": 2, "y": 3})
    first = page.receive_frames()
    assert [data[-1:] == b"\x01" for one, data in first if one == 0x82] == [True] * serialized
    assert any(b"with other fields" in data for _, data in first)
    older.disconnect()
    frames = page.receive_frames()
    if serialized:
        assert [bytes(data[-2:]) for one, data in frames if one == 0x82] == [b"\x02\x03"]
    else:
        found = [json.loads(data) for _, data in frames]
        assert [each["msg"] for each in found if each["op"] == "publish"] == [{"x": 2, "y": 3}]
    peers = [json.loads(data)["nodes"] for one, data in frames if b'"peers"' in data]
    assert peers[-1] == ["/newer"]
    # A subscriber that knows the fields waits for a publisher with these.
    assert messages(keeper) == [{"x": 1}]
    assert conflicts(hub) == {"/keeper": THING}
    for each in (newer, keeper, page):
        each.disconnect()
    assert hub.empty


def test_publisher_with_the_md5_of_a_type_that_another_one_brought_has_that_type() -> None:
    hub = FakeHub()
    clients = [hub.client() for _ in range(3)]
    for client, fields in zip(clients, (MINE, YOURS), strict=False):
        bring(client, "advertise", fields)
    md5s = [group.type and group.type.md5sum for group in hub.graph.topics[TOPIC].groups]
    clients[2].send("advertise", TOPIC, type=THING, md5sum=md5s[1])
    clients[2].send("publish", TOPIC, msg={"y": 1})
    assert not [each for each in clients[2].receive() if each.get("level") == "error"]
    assert [len(group.sources) for group in hub.graph.topics[TOPIC].groups] == [1, 2]


def test_md5_without_a_definition_is_a_type_of_its_own() -> None:
    """Nobody can check its messages, which reach those alone that give the same md5."""
    hub = FakeHub()
    talker, claiming = hub.client("/right"), hub.client("/json")
    listener, alike = hub.client("/listener"), hub.client("/alike")
    serialized = hub.client("/bytes", serialized=True)
    md5sum = "0123456789abcdef0123456789abcdef"
    claiming.send("advertise", TOPIC, type=INT32, md5sum=md5sum)
    alike.send("subscribe", TOPIC, type=INT32, md5sum=md5sum)
    talker.send("advertise", TOPIC, type=INT32)
    listener.send("subscribe", TOPIC, type=INT32)
    claiming.send("publish", TOPIC, msg={"more": 1})
    talker.send("publish", TOPIC, msg=number(2))
    assert messages(listener) == [number(2)]
    assert messages(alike) == [{"more": 1}]
    assert set(conflicts(hub)) in ({"/json", "/alike"}, {"/right", "/listener"})
    serialized.send("advertise", TOPIC, type=INT32, md5sum=md5sum, publisher=1)
    [refusal] = serialized.receive_statuses()
    assert f"at the hub, but {md5sum} at the client" in refusal
    for each in (talker, claiming, listener, alike, serialized):
        each.disconnect()
    assert hub.empty


def test_without_room_for_its_definition_a_publisher_shares_no_type(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(client_definitions, "OF_ALL", DefinitionLimits(1, 1000, 1000))
    hub = FakeHub()
    first, second = hub.client(), hub.client(serialized=True)
    bring(first, "advertise", MINE)
    bring(second, "advertise", "int16 x", publisher=1)
    assert "limit is 1" in second.receive_statuses()[0]
    bring(second, "advertise", "int16 x")
    second.send("publish", TOPIC, msg={"x": 1000})
    assert [each["level"] for each in second.receive()] == ["warning"]
