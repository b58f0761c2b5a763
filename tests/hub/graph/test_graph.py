"""The graph: its nodes, its topics, and their types."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from typing import Any

import pytest

from fibws import names
from fibws.errors import (
    InvalidMessage,
    InvalidTypeName,
    OperationError,
    UnknownPackage,
    UnknownType,
)
from fibws.hub.errors import DefinitionMismatch, TypeConflict
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.topic import Source
from fibws.interfaces import Interfaces

from ..fakes import INT32, NANOSECONDS, STRING
from .recorder import Recorder

INTERFACES = Interfaces()


class Node:
    """A node that counts how often it is replaced."""

    def __init__(self) -> None:
        self.times_replaced = 0

    def replaced(self) -> None:
        self.times_replaced += 1

    def publishing(self) -> list[str]:
        return []

    def subscribing(self) -> list[str]:
        return []

    def providing(self) -> list[str]:
        return []


def new_graph(*, strict_types: bool = False) -> Graph:
    return Graph(INTERFACES, lambda: NANOSECONDS, strict_types=strict_types)


def advertise(
    graph: Graph, node: str, name: str, type_: str, definition: str | None = None, **options: Any
) -> Source:
    return graph.advertise(graph.topic(name), node, type_, definition, **options)


def subscribe(
    graph: Graph, name: str, type_: str | None = None, *, node: str = "/listener", **options: Any
) -> Recorder:
    recorder = Recorder(node)
    graph.subscribe(graph.topic(name), recorder, type_, **options)
    return recorder


def test_node_without_a_name_gets_one() -> None:
    graph = new_graph()
    for number in (1, 2, 3):
        name = graph.enter(Node(), None)
        assert re.fullmatch(rf"/client_{number}_[0-9a-f]{{6}}", name)
        assert names.check(name) == name


def test_generated_names_are_not_used_again() -> None:
    graph, node = new_graph(), Node()
    first = graph.enter(node, None)
    graph.leave(node, first)
    assert graph.enter(Node(), None) != first


def test_generated_name_is_not_one_that_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.hub.graph.graph.secrets.token_hex", lambda size: "9f3c2a")
    graph, node = new_graph(), Node()
    graph.enter(node, "/client_1_9f3c2a")
    assert graph.enter(Node(), None) == "/client_2_9f3c2a"
    assert node.times_replaced == 0


def test_name_that_a_client_chooses_is_not_a_generated_one_by_accident() -> None:
    graph, nodes = new_graph(), [Node() for _ in range(3)]
    for node in nodes:
        graph.enter(node, None)
    before_the_restart = new_graph()
    for number in (1, 2, 3):
        graph.enter(Node(), f"/client_{number}")
        graph.enter(Node(), before_the_restart.enter(Node(), None))
    assert [node.times_replaced for node in nodes] == [0, 0, 0]


def test_node_gets_the_name_that_it_asked_for() -> None:
    graph, node = new_graph(), Node()
    assert graph.enter(node, "/talker") == "/talker"
    assert graph.nodes == {"/talker": node}


def test_older_node_of_a_name_is_replaced() -> None:
    graph, older, newer = new_graph(), Node(), Node()
    graph.enter(older, "/talker")
    graph.enter(newer, "/talker")
    assert (older.times_replaced, newer.times_replaced) == (1, 0)
    assert graph.nodes == {"/talker": newer}


def test_replaced_node_does_not_remove_the_newer_one_when_it_leaves() -> None:
    graph, older, newer = new_graph(), Node(), Node()
    graph.enter(older, "/talker")
    graph.enter(newer, "/talker")
    graph.leave(older, "/talker")
    assert graph.nodes == {"/talker": newer}
    graph.leave(newer, "/talker")
    assert graph.nodes == {}


def test_looking_up_a_topic_does_not_register_it() -> None:
    graph = new_graph()
    assert graph.topic("/a").name == "/a"
    assert graph.topics == {}


@pytest.mark.parametrize(
    "join",
    [lambda graph: advertise(graph, "/talker", "/a", INT32), lambda graph: subscribe(graph, "/a")],
)
def test_topic_is_registered_while_it_is_used(join: Callable[[Graph], object]) -> None:
    graph = new_graph()
    join(graph)
    assert list(graph.topics) == ["/a"]
    assert graph.topic("/a") is graph.topics["/a"]
    assert graph.topic("/b") is not graph.topics["/a"]


def test_node_has_one_source_of_a_topic_and_the_first_latch_counts() -> None:
    graph = new_graph()
    first = graph.advertise(graph.topic("/a"), "/talker", INT32, latch=True)
    assert graph.advertise(graph.topic("/a"), "/talker", INT32, latch=False) is first
    assert first.latch
    assert advertise(graph, "/other", "/a", INT32) is not first
    assert list(graph.topics["/a"].sources) == ["/talker", "/other"]


@pytest.mark.parametrize("spelling", [INT32, "std_msgs/msg/Int32"])
def test_type_may_be_spelled_as_in_ros_1_or_2(spelling: str) -> None:
    graph = new_graph()
    publisher = advertise(graph, "/talker", "/a", spelling)
    assert publisher.type.name == INT32
    assert advertise(graph, "/other", "/a", INT32).type is publisher.type


def test_node_publishes_a_topic_with_one_type() -> None:
    graph = new_graph()
    advertise(graph, "/talker", "/a", INT32)
    with pytest.raises(TypeConflict) as caught:
        advertise(graph, "/talker", "/a", "std_msgs/msg/String")
    assert (caught.value.asked, caught.value.established) == (STRING, INT32)
    assert (caught.value.topic, caught.value.by) == ("/a", "/talker")
    assert len(graph.topics["/a"].groups) == 1


def test_topic_keeps_its_type_while_a_node_publishes_with_it() -> None:
    graph = new_graph()
    subscribe(graph, "/a", STRING)
    first = advertise(graph, "/talker", "/a", INT32)
    other = advertise(graph, "/other", "/a", "std_msgs/msg/String")
    topic = graph.topics["/a"]
    assert [topic.type, other.type.name] == [first.type, STRING]
    graph.remove_source(first)
    assert topic.type is other.type


def test_types_of_subscriptions_count_without_publishers() -> None:
    graph = new_graph()
    subscribe(graph, "/a", INT32)
    subscribe(graph, "/a", STRING)
    assert graph.topics["/a"].type is not None
    assert graph.topics["/a"].type.name == INT32


def test_type_is_free_when_its_last_holder_leaves() -> None:
    graph = new_graph()
    subscribe(graph, "/a")
    graph.remove_source(advertise(graph, "/talker", "/a", INT32))
    assert advertise(graph, "/talker", "/a", STRING).type.name == STRING


@pytest.mark.parametrize("name", ["Int32", "std_msgs/", "/Int32", "a/b/c/d", "std_msgs/Int 32", ""])
def test_invalid_type_name_is_refused(name: str) -> None:
    graph = new_graph()
    with pytest.raises(InvalidTypeName):
        advertise(graph, "/talker", "/a", name)
    with pytest.raises(InvalidTypeName):
        subscribe(graph, "/a", name)
    assert graph.topics == {}


def test_unknown_type_is_refused_with_a_suggestion() -> None:
    with pytest.raises(UnknownType, match=r"did you mean std_msgs/String\?"):
        advertise(new_graph(), "/talker", "/a", "std_msgs/Sting")


def test_topic_of_an_unknown_package_is_not_checked() -> None:
    graph = new_graph()
    found = advertise(graph, "/talker", "/a", "my_msgs/msg/Thing").type
    assert not found.checked
    assert found.name == "my_msgs/Thing"
    assert advertise(graph, "/talker", "/b", "my_msgs/Thing").type.name == found.name


def test_strict_types_refuse_an_unknown_package() -> None:
    graph = new_graph(strict_types=True)
    with pytest.raises(UnknownPackage):
        advertise(graph, "/talker", "/a", "my_msgs/Thing")
    assert graph.topics == {}


def test_client_may_bring_a_definition() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    found = advertise(graph, "/talker", "/a", "my_msgs/Thing", "int32 number\n").type
    assert found.validate({}) == {"number": 0}


def test_definition_with_a_conflict_is_not_learned() -> None:
    interfaces = Interfaces()
    graph = Graph(interfaces, lambda: NANOSECONDS)
    advertise(graph, "/talker", "/a", INT32)
    with pytest.raises(TypeConflict):
        advertise(graph, "/talker", "/a", "my_msgs/Thing", "int32 number\n")
    assert "my_msgs" not in interfaces.packages()


def test_established_type_is_not_looked_up_again() -> None:
    """A client that brings one type of a package must not break topics of its other types."""
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    pose = advertise(graph, "/talker", "/a", "my_msgs/Pose").type
    advertise(graph, "/other", "/b", "my_msgs/Other", "int32 number\n")
    assert advertise(graph, "/late", "/a", "my_msgs/Pose").type is pose
    assert not advertise(graph, "/late", "/c", "my_msgs/Pose").type.checked


def test_topic_that_is_no_longer_used_is_forgotten() -> None:
    graph = new_graph()
    first, second = (advertise(graph, node, "/a", INT32) for node in ("/a", "/b"))
    listener = subscribe(graph, "/a")
    graph.remove_source(first)
    graph.unsubscribe(graph.topics["/a"], listener)
    assert list(graph.topics) == ["/a"]
    graph.remove_source(second)
    assert graph.topics == {}


def test_removing_a_source_twice_is_harmless() -> None:
    graph = new_graph()
    publisher = advertise(graph, "/talker", "/a", INT32)
    for _ in range(2):
        graph.remove_source(publisher)
    assert graph.topics == {}


def test_source_that_was_removed_does_not_take_a_newer_one_with_it() -> None:
    graph = new_graph()
    older = advertise(graph, "/talker", "/a", INT32)
    graph.remove_source(older)
    newer = advertise(graph, "/talker", "/a", INT32)
    graph.remove_source(older)
    assert list(graph.topics["/a"].sources.values()) == [newer]


def test_topic_that_was_forgotten_does_not_take_a_newer_one_with_it() -> None:
    graph = new_graph()
    listener = subscribe(graph, "/a")
    older = graph.topics["/a"]
    graph.unsubscribe(older, listener)
    advertise(graph, "/talker", "/a", INT32)
    graph.unsubscribe(older, listener)
    assert list(graph.topics["/a"].sources) == ["/talker"]


def test_topic_with_untyped_subscribers_only_has_no_type() -> None:
    graph = new_graph()
    subscribe(graph, "/a")
    publisher = advertise(graph, "/talker", "/a", INT32)
    graph.remove_source(publisher)
    assert graph.topics["/a"].type is None


def test_subscription_renewed_without_a_type_no_longer_holds_it() -> None:
    graph = new_graph()
    listener = subscribe(graph, "/a", INT32)
    topic = graph.topics["/a"]
    held = [topic.held]
    graph.subscribe(topic, listener)
    assert topic.type is None
    assert [*held, topic.held] == [True, False]
    graph.unsubscribe(topic, listener)
    assert graph.topics == {}


def test_refused_change_leaves_a_subscription_as_it_was() -> None:
    graph = new_graph()
    listener = subscribe(graph, "/a", INT32)
    with pytest.raises(TypeConflict):
        graph.subscribe(graph.topics["/a"], listener, STRING, keeps_type=True)
    assert graph.topics["/a"].type is not None
    assert graph.topics["/a"].type.name == INT32
    advertise(graph, "/talker", "/a", INT32).publish({"data": 5})
    assert listener.numbers == [5]


def test_unsubscribing_twice_is_harmless() -> None:
    graph = new_graph()
    listener = subscribe(graph, "/a")
    topic = graph.topics["/a"]
    for _ in range(2):
        graph.unsubscribe(topic, listener)
    assert graph.topics == {}


def test_serialized_messages_need_a_known_definition() -> None:
    graph = new_graph()
    with pytest.raises(OperationError, match="my_msgs/Thing"):
        subscribe(graph, "/a", "my_msgs/Thing", serialized=True)
    assert graph.topics == {}


# The md5sum of a type.

INT32_MD5 = "da5909fbe378aeaf85e547e830cc1bb7"
OTHER_MD5 = "992ce8a1687cec8c8bd883ec73ca41d1"
MORE = "int32 data\nint8 more\n"
MORE_MD5 = hashlib.md5(MORE.strip().encode()).hexdigest()


@pytest.mark.parametrize("md5sum", [INT32_MD5, "*", None])
@pytest.mark.parametrize("join", ["advertise", "subscribe"])
def test_md5sum_of_the_hubs_definition_is_accepted(join: str, md5sum: str | None) -> None:
    graph = new_graph()
    if join == "advertise":
        advertise(graph, "/talker", "/a", INT32, md5sum=md5sum)
    else:
        subscribe(graph, "/a", INT32, md5sum=md5sum)
    assert graph.topics["/a"].held


@pytest.mark.parametrize("established", [False, True])
@pytest.mark.parametrize("join", ["advertise", "subscribe"])
@pytest.mark.parametrize("strict", [False, True])
def test_md5sum_of_another_definition_is_refused_for_serialized_messages(
    join: str, established: bool, strict: bool
) -> None:
    graph = new_graph(strict_types=strict)
    if established:
        advertise(graph, "/first", "/a", INT32)
    with pytest.raises(OperationError) as caught:
        if join == "advertise":
            advertise(graph, "/talker", "/a", INT32, md5sum=OTHER_MD5, serialized=True)
        else:
            subscribe(graph, "/a", INT32, md5sum=OTHER_MD5, serialized=True)
    assert f"md5sum {INT32_MD5} at the hub, but {OTHER_MD5} at the client" in str(caught.value)
    assert list(graph.topics) == (["/a"] if established else [])
    if established:
        assert list(graph.topics["/a"].sources) == ["/first"]
        assert not graph.topics["/a"].subscribers()


def test_md5sum_of_another_definition_is_a_type_of_its_own() -> None:
    graph = new_graph()
    listener, guest = (subscribe(graph, "/a", INT32, node=node) for node in ("/b", "/c"))
    claimed = subscribe(graph, "/a", INT32, md5sum=OTHER_MD5, node="/d")
    other = advertise(graph, "/other", "/a", INT32, md5sum=OTHER_MD5)
    right = advertise(graph, "/right", "/a", INT32)
    other.publish({"more": 1})
    right.publish({"data": 2})
    assert [each.values for each in (listener, guest)] == 2 * [[{"data": 2}]]
    assert claimed.values == [{"more": 1}]


def test_definition_of_a_claimed_md5sum_may_come_later() -> None:
    graph = new_graph()
    early = advertise(graph, "/early", "/a", INT32, md5sum=MORE_MD5)
    early.publish({"any": "thing"})
    recorder = subscribe(graph, "/a", INT32, md5sum=MORE_MD5)
    advertise(graph, "/late", "/a", INT32, MORE)
    early.publish({"more": 1})
    with pytest.raises(InvalidMessage):
        early.publish({"any": "thing"})
    assert recorder.values == [{"data": 0, "more": 1}]
    assert len(graph.topics["/a"].groups) == 1


def test_md5sum_of_an_unknown_type_is_not_checked() -> None:
    graph = new_graph()
    advertise(graph, "/talker", "/a", "my_msgs/Thing", md5sum=OTHER_MD5)
    subscribe(graph, "/a", "my_msgs/Thing", md5sum=INT32_MD5)
    assert graph.topics["/a"].held


def test_definition_with_another_md5sum_is_refused() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    with pytest.raises(DefinitionMismatch, match="my_msgs/Thing"):
        advertise(graph, "/talker", "/a", "my_msgs/Thing", "int8 x\n", md5sum=OTHER_MD5)
    assert graph.topics == {}


def test_definition_brought_later_is_for_earlier_sources_too() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    early = advertise(graph, "/early", "/a", "my_msgs/Thing")
    recorder = subscribe(graph, "/a")
    early.publish({"any": "thing"})
    advertise(graph, "/late", "/a", "my_msgs/Thing", "int8 x\n")
    early.publish({})
    early.publish_serialized(b"\5")
    assert recorder.values == [{"any": "thing"}, {"x": 0}, {"x": 5}]


def test_watcher_learns_of_each_change_of_a_topic() -> None:
    graph, changed = new_graph(), list[str]()
    graph.watch_topics(lambda topic: changed.append(topic.name))
    source = advertise(graph, "/talker", "/chatter", STRING)
    assert changed == ["/chatter"]
    sink = subscribe(graph, "/other")
    assert changed == ["/chatter", "/other"]
    graph.unsubscribe(graph.topics["/other"], sink)
    graph.remove_source(source)
    assert changed == ["/chatter", "/other", "/other", "/chatter"]


def test_watcher_learns_that_a_source_has_brought_the_definition() -> None:
    graph, changed = Graph(Interfaces(), lambda: NANOSECONDS), list[str]()
    advertise(graph, "/talker", "/a", "my_msgs/Thing")
    graph.watch_topics(lambda topic: changed.append(topic.name))
    advertise(graph, "/talker", "/a", "my_msgs/Thing")
    assert changed == []
    advertise(graph, "/talker", "/a", "my_msgs/Thing", "int8 x\n")
    assert changed == ["/a"]
