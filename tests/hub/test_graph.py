"""Which nodes there are, which topics, and of which type."""

from __future__ import annotations

import logging

import pytest

from fibws.errors import (
    InvalidMessage,
    InvalidTypeName,
    TypeConflict,
    UnknownPackage,
    UnknownType,
)
from fibws.hub.graph import Graph, Unchecked
from fibws.hub.outbox import Flusher, Outbox
from fibws.hub.subscription import Subscription
from fibws.hub.topic import Channel, Publisher
from fibws.interfaces import Interfaces
from fibws.protocol.operations import Subscribe

from .fakes import NANOSECONDS, FakeClock

INTERFACES = Interfaces()
INT32 = "std_msgs/Int32"
STRING = "std_msgs/String"


class Node:
    """A client that only counts how often it lost its name."""

    def __init__(self) -> None:
        self.times_replaced = 0

    def replaced(self) -> None:
        self.times_replaced += 1


def new_graph(*, strict_types: bool = False) -> Graph:
    return Graph(INTERFACES, lambda: NANOSECONDS, strict_types=strict_types)


def advertise(graph: Graph, node: str, name: str, type_: str) -> None:
    topic = graph.topic(name)
    checked = graph.establish(topic, type_)
    topic.publishers[node] = Publisher(topic, checked, latch=False)


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


def test_a_topic_is_made_when_first_asked_for() -> None:
    graph = new_graph()
    assert graph.topic("/a") is graph.topic("/a")
    assert graph.topic("/a") is not graph.topic("/b")


@pytest.mark.parametrize("spelling", [INT32, "std_msgs/msg/Int32"])
def test_a_type_may_be_spelled_as_in_ros_1_or_2(spelling: str) -> None:
    graph = new_graph()
    topic = graph.topic("/a")
    assert graph.establish(topic, spelling).type == INT32
    assert graph.establish(topic, INT32) is topic.type


def test_a_topic_keeps_its_type_while_a_node_holds_it() -> None:
    graph = new_graph()
    advertise(graph, "/talker", "/a", INT32)
    with pytest.raises(TypeConflict) as caught:
        graph.establish(graph.topic("/a"), "std_msgs/msg/String")
    assert (caught.value.asked, caught.value.established) == (STRING, INT32)
    assert (caught.value.topic, caught.value.by) == ("/a", "/talker")


def test_a_type_that_nobody_holds_gives_way() -> None:
    graph = new_graph()
    topic = graph.topic("/a")
    graph.establish(topic, INT32)
    assert graph.establish(topic, STRING).type == STRING


@pytest.mark.parametrize("name", ["Int32", "std_msgs/", "/Int32", "a/b/c/d", "std_msgs/Int 32", ""])
def test_what_is_no_type_name_is_refused(name: str) -> None:
    graph = new_graph()
    with pytest.raises(InvalidTypeName):
        graph.establish(graph.topic("/a"), name)


def test_a_typing_error_is_met_with_a_suggestion() -> None:
    graph = new_graph()
    with pytest.raises(UnknownType, match=r"did you mean std_msgs/String\?"):
        graph.establish(graph.topic("/a"), "std_msgs/Sting")


def test_a_topic_of_an_unknown_package_is_not_checked() -> None:
    graph = new_graph()
    found = graph.establish(graph.topic("/a"), "my_msgs/msg/Thing")
    assert isinstance(found, Unchecked)
    assert found.type == "my_msgs/Thing"
    assert graph.establish(graph.topic("/b"), "my_msgs/Thing").type == found.type


def test_unless_types_are_strict() -> None:
    graph = new_graph(strict_types=True)
    with pytest.raises(UnknownPackage):
        graph.establish(graph.topic("/a"), "my_msgs/Thing")


def test_an_unknown_package_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    graph = new_graph()
    for name in ("/a", "/b"):
        graph.establish(graph.topic(name), "my_msgs/Thing")
    assert [record.message for record in caplog.records] == [
        "Unable to load the manifest for package my_msgs. Caused by: no folder of definitions "
        "holds it. Messages of type my_msgs/Thing are relayed unchecked."
    ]


def test_who_makes_up_packages_does_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    graph = new_graph()
    for number in range(1000):
        graph.establish(graph.topic("/a"), f"made_up_{number}/Thing")
    assert len(caplog.records) < 100


def test_a_definition_may_be_brought_along() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    found = graph.establish(graph.topic("/a"), "my_msgs/Thing", "int32 number\n")
    assert found.validate({}) == {"number": 0}


def test_an_unchecked_message_is_relayed_as_it_came() -> None:
    message = {"any": [{"thing": None}]}
    assert Unchecked("my_msgs/Thing").validate(message) == message
    assert Unchecked("my_msgs/Thing").missing(message) == []


@pytest.mark.parametrize("msg", [5, "x", []])
def test_an_unchecked_message_must_be_an_object_all_the_same(msg: object) -> None:
    with pytest.raises(InvalidMessage, match="Expected a JSON object for type my_msgs/Thing but"):
        Unchecked("my_msgs/Thing").validate(msg)


def test_a_topic_that_nobody_has_to_do_with_is_deleted() -> None:
    graph = new_graph()
    advertise(graph, "/talker", "/a", INT32)
    topic = graph.topic("/a")
    graph.settle(topic)
    assert graph.topics == {"/a": topic}
    topic.publishers.clear()
    graph.settle(topic)
    assert graph.topics == {}


def test_a_topic_that_is_only_listened_to_has_no_type() -> None:
    graph = new_graph()
    topic = graph.topic("/a")
    outbox = Outbox(print, print, Flusher(print), max_bytes=1000)
    subscription = Subscription("/listener", outbox, FakeClock(), queue_length=10)
    subscription.request(Subscribe(topic="/a"))
    topic.channels["/a"] = Channel("/a")
    topic.channels["/a"].set(subscription)
    graph.establish(topic, INT32)
    graph.settle(topic)
    assert topic.type is None
    assert graph.topics == {"/a": topic}


def test_an_empty_channel_does_not_keep_a_topic() -> None:
    graph = new_graph()
    topic = graph.topic("/a")
    topic.channels["/a"] = Channel("/a")
    graph.settle(topic)
    assert graph.topics == {}
