"""Which nodes there are, which topics, and of which type."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import pytest

from fibws.errors import (
    InvalidTypeName,
    OperationError,
    TypeConflict,
    UnknownPackage,
    UnknownType,
)
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publisher import Publisher
from fibws.hub.graph.subscription import MAX_REGISTRATIONS, Subscription
from fibws.hub.outbox import Flusher, Outbox
from fibws.interfaces import Interfaces
from fibws.protocol.operations import Subscribe

from ..fakes import INT32, NANOSECONDS, STRING, FakeClock

INTERFACES = Interfaces()


class Node:
    """A client that only counts how often it lost its name."""

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
    graph: Graph, node: str, name: str, type_: str, definition: str | None = None
) -> Publisher:
    return graph.add_publisher(graph.topic(name), node, type_, definition, latch=False)


def subscription(graph: Graph, name: str, spelling: str | None = None) -> Subscription:
    outbox = Outbox(print, print, Flusher(print), max_bytes=1000)
    return Subscription(
        "/listener",
        graph.topic(name),
        spelling or name,
        outbox,
        FakeClock(),
        print,
        queue_length=10,
    )


def subscribe(graph: Graph, name: str, **fields: Any) -> Subscription:
    made = subscription(graph, name)
    graph.subscribe(made, Subscribe(topic=name, **fields))
    return made


def test_a_client_without_a_name_is_given_one() -> None:
    graph = new_graph()
    assert [graph.enter(Node(), None) for _ in range(3)] == ["/client_1", "/client_2", "/client_3"]


def test_a_name_that_was_given_is_not_given_again() -> None:
    graph, node = new_graph(), Node()
    graph.leave(node, graph.enter(node, None))
    assert graph.enter(Node(), None) == "/client_2"


def test_the_hub_gives_nobody_a_name_that_is_taken() -> None:
    graph, node = new_graph(), Node()
    graph.enter(node, "/client_1")
    assert graph.enter(Node(), None) != "/client_1"
    assert node.times_replaced == 0


def test_a_client_has_the_name_that_it_asked_for() -> None:
    graph, node = new_graph(), Node()
    assert graph.enter(node, "/talker") == "/talker"
    assert graph.nodes == {"/talker": node}


def test_the_older_node_of_a_name_is_told_that_it_lost_it() -> None:
    graph, older, newer = new_graph(), Node(), Node()
    graph.enter(older, "/talker")
    graph.enter(newer, "/talker")
    assert (older.times_replaced, newer.times_replaced) == (1, 0)
    assert graph.nodes == {"/talker": newer}


def test_a_node_that_lost_its_name_takes_it_from_nobody_when_it_leaves() -> None:
    graph, older, newer = new_graph(), Node(), Node()
    graph.enter(older, "/talker")
    graph.enter(newer, "/talker")
    graph.leave(older, "/talker")
    assert graph.nodes == {"/talker": newer}
    graph.leave(newer, "/talker")
    assert graph.nodes == {}


def test_asking_for_a_topic_does_not_register_it() -> None:
    graph = new_graph()
    assert graph.topic("/a").name == "/a"
    assert graph.topics == {}


@pytest.mark.parametrize(
    "join",
    [lambda graph: advertise(graph, "/talker", "/a", INT32), lambda graph: subscribe(graph, "/a")],
)
def test_a_topic_that_somebody_has_to_do_with_is_known(join: Callable[[Graph], object]) -> None:
    graph = new_graph()
    join(graph)
    assert list(graph.topics) == ["/a"]
    assert graph.topic("/a") is graph.topics["/a"]
    assert graph.topic("/b") is not graph.topics["/a"]


def test_a_node_has_one_publisher_of_a_topic_and_its_first_call_decides_on_latching() -> None:
    graph = new_graph()
    first = graph.add_publisher(graph.topic("/a"), "/talker", INT32, latch=True)
    assert graph.add_publisher(graph.topic("/a"), "/talker", INT32, latch=False) is first
    assert first.latch
    assert advertise(graph, "/other", "/a", INT32) is not first
    assert list(graph.topics["/a"].publishers) == ["/talker", "/other"]


@pytest.mark.parametrize("spelling", [INT32, "std_msgs/msg/Int32"])
def test_a_type_may_be_spelled_as_in_ros_1_or_2(spelling: str) -> None:
    graph = new_graph()
    publisher = advertise(graph, "/talker", "/a", spelling)
    assert publisher.type.name == INT32
    assert advertise(graph, "/other", "/a", INT32).type is publisher.type


def test_a_topic_keeps_its_type_while_a_node_holds_it() -> None:
    graph = new_graph()
    advertise(graph, "/talker", "/a", INT32)
    with pytest.raises(TypeConflict) as caught:
        advertise(graph, "/other", "/a", "std_msgs/msg/String")
    assert (caught.value.asked, caught.value.established) == (STRING, INT32)
    assert (caught.value.topic, caught.value.by) == ("/a", "/talker")


def test_a_subscription_that_names_the_type_holds_it_as_well() -> None:
    graph = new_graph()
    subscribe(graph, "/a", type=INT32)
    with pytest.raises(TypeConflict) as caught:
        subscribe(graph, "/a", type=STRING)
    assert caught.value.by == "/listener"


def test_a_type_that_nobody_holds_gives_way() -> None:
    graph = new_graph()
    subscribe(graph, "/a")
    graph.remove_publisher(advertise(graph, "/talker", "/a", INT32))
    assert advertise(graph, "/talker", "/a", STRING).type.name == STRING


@pytest.mark.parametrize("name", ["Int32", "std_msgs/", "/Int32", "a/b/c/d", "std_msgs/Int 32", ""])
def test_what_is_no_type_name_is_refused(name: str) -> None:
    graph = new_graph()
    with pytest.raises(InvalidTypeName):
        advertise(graph, "/talker", "/a", name)
    with pytest.raises(InvalidTypeName):
        subscribe(graph, "/a", type=name)
    assert graph.topics == {}


def test_a_typing_error_is_met_with_a_suggestion() -> None:
    with pytest.raises(UnknownType, match=r"did you mean std_msgs/String\?"):
        advertise(new_graph(), "/talker", "/a", "std_msgs/Sting")


def test_a_topic_of_an_unknown_package_is_not_checked() -> None:
    graph = new_graph()
    found = advertise(graph, "/talker", "/a", "my_msgs/msg/Thing").type
    assert not found.checked
    assert found.name == "my_msgs/Thing"
    assert advertise(graph, "/talker", "/b", "my_msgs/Thing").type.name == found.name


def test_unless_types_are_strict() -> None:
    graph = new_graph(strict_types=True)
    with pytest.raises(UnknownPackage):
        advertise(graph, "/talker", "/a", "my_msgs/Thing")
    assert graph.topics == {}


def test_an_unknown_package_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    graph = new_graph()
    for name in ("/a", "/b"):
        advertise(graph, "/talker", name, "my_msgs/Thing")
    assert [record.message for record in caplog.records] == [
        "Unable to load the manifest for package my_msgs. Caused by: no folder of definitions "
        "holds it. Messages of type my_msgs/Thing are relayed unchecked."
    ]


def test_who_makes_up_packages_does_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    graph = new_graph()
    for number in range(1000):
        advertise(graph, "/talker", f"/a{number}", f"made_up_{number}/Thing")
    assert len(caplog.records) < 100


def test_a_definition_may_be_brought_along() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    found = advertise(graph, "/talker", "/a", "my_msgs/Thing", "int32 number\n").type
    assert found.validate({}) == {"number": 0}


def test_what_conflicts_is_not_learned() -> None:
    interfaces = Interfaces()
    graph = Graph(interfaces, lambda: NANOSECONDS)
    advertise(graph, "/talker", "/a", INT32)
    with pytest.raises(TypeConflict):
        advertise(graph, "/other", "/a", "my_msgs/Thing", "int32 number\n")
    assert "my_msgs" not in interfaces.packages()


def test_an_established_type_is_not_looked_up_again() -> None:
    """Else who brings one type of a package would break the topics of its others."""
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    pose = advertise(graph, "/talker", "/a", "my_msgs/Pose").type
    advertise(graph, "/other", "/b", "my_msgs/Other", "int32 number\n")
    assert advertise(graph, "/late", "/a", "my_msgs/Pose").type is pose
    assert not advertise(graph, "/late", "/c", "my_msgs/Pose").type.checked


def test_a_topic_that_nobody_has_to_do_with_is_forgotten() -> None:
    graph = new_graph()
    first, second = (advertise(graph, node, "/a", INT32) for node in ("/a", "/b"))
    listener = subscribe(graph, "/a")
    graph.remove_publisher(first)
    graph.unsubscribe(listener, None)
    assert list(graph.topics) == ["/a"]
    graph.remove_publisher(second)
    assert graph.topics == {}


def test_a_publisher_may_be_removed_twice() -> None:
    graph = new_graph()
    publisher = advertise(graph, "/talker", "/a", INT32)
    for _ in range(2):
        graph.remove_publisher(publisher)
    assert graph.topics == {}


def test_a_topic_that_is_only_listened_to_has_no_type() -> None:
    graph = new_graph()
    subscribe(graph, "/a")
    publisher = advertise(graph, "/talker", "/a", INT32)
    graph.remove_publisher(publisher)
    assert graph.topics["/a"].type is None


def test_a_request_that_is_taken_back_takes_the_type_along() -> None:
    graph = new_graph()
    listener = subscribe(graph, "/a", id="typed", type=INT32)
    graph.subscribe(listener, Subscribe(topic="/a", id="untyped"))
    graph.unsubscribe(listener, "unknown")
    assert graph.topics["/a"].held
    graph.unsubscribe(listener, "typed")
    assert graph.topics["/a"].type is None
    graph.unsubscribe(listener, "untyped")
    assert graph.topics == {}


def test_a_request_that_is_replaced_by_one_without_a_type_takes_the_type_along() -> None:
    graph = new_graph()
    listener = subscribe(graph, "/a", id="a", type=INT32)
    graph.subscribe(listener, Subscribe(topic="/a", id="a"))
    assert graph.topics["/a"].type is None


def test_a_request_that_is_one_too_many_leaves_the_topic_as_it_was() -> None:
    graph = new_graph()
    listener = subscription(graph, "/a")
    for id_ in range(MAX_REGISTRATIONS):
        graph.subscribe(listener, Subscribe(topic="/a", id=id_))
    with pytest.raises(OperationError, match="100 subscriptions to one topic are enough"):
        graph.subscribe(listener, Subscribe(topic="/a", id="another", type=INT32))
    assert len(listener.requests) == MAX_REGISTRATIONS
    assert not graph.topics["/a"].held
    assert graph.topics["/a"].type is None
