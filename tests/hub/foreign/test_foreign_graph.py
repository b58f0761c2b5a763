"""A graph of another kind joins by a bridge of its own, without changes in `hub/graph`."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest

import fibws.hub.graph
from fibws.hub.graph.graph import Graph
from fibws.interfaces import Interfaces

from ..fakes import ADD, INT32, NANOSECONDS, STRING, FakeClock
from ..graph.recorder import Recorder
from . import mailbox_bridge
from .mailbox_bridge import MailBridge, MailNode, MailServer

INTERFACES = Interfaces()
MD5 = {type_: INTERFACES.md5(type_) for type_ in (INT32, STRING)}


class World:
    """A graph and a bridge."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.graph = Graph(INTERFACES, lambda: NANOSECONDS)
        self.bridge = MailBridge(self.graph, self.clock.call_soon)
        self.bridge.join("/post")

    def publishes(self, topic: str, type_: str, md5sum: str = "") -> None:
        self.bridge.publishes[topic] = {"/post": (type_, md5sum or MD5[type_])}
        self.settle(topic)

    def subscribes(self, topic: str, type_: str) -> None:
        self.bridge.subscribes[topic] = {"/post": (type_, MD5[type_])}
        self.settle(topic)

    def settle(self, *topics: str) -> None:
        for topic in topics:
            self.bridge.work.add("topics", topic)
        self.clock.turn()


@pytest.fixture
def world() -> World:
    return World()


def test_bridge_is_small_and_the_graph_does_not_know_bridges() -> None:
    code = [
        line
        for line in inspect.getsource(mailbox_bridge).splitlines()
        if line.strip() and not line.strip().startswith('"""')
    ]
    assert len(code) < 100
    for path in Path(fibws.hub.graph.__file__).parent.glob("*.py"):
        assert "hub.foreign" not in path.read_text("utf-8")


def test_messages_pass_both_ways_and_none_goes_back(world: World) -> None:
    world.publishes("/count", INT32)
    world.subscribes("/count", INT32)
    graph, topic = world.graph, world.graph.topic("/count")
    recorder = Recorder("/listener")
    graph.subscribe(topic, recorder, INT32)
    world.bridge.send("/count", "/post", {"data": 1})
    assert recorder.values == [{"data": 1}]
    graph.advertise(topic, "/talker", INT32).publish({"data": 2})
    assert world.bridge.delivered == [(INT32, {"data": 2})]


def test_node_is_listed_with_what_it_uses(world: World) -> None:
    world.publishes("/count", INT32)
    world.subscribes("/name", STRING)
    world.bridge.serve("/post", "/add", ADD, lambda values: {"sum": 0})
    node = world.graph.nodes["/post"]
    assert [*node.publishing()] == ["/count"]
    assert [*node.subscribing()] == ["/name"]
    assert [*node.providing()] == ["/add"]


def test_publisher_that_does_not_fit_is_a_conflict_until_the_topic_has_another_type(
    world: World,
) -> None:
    graph = world.graph
    world.publishes("/count", "std_msgs/Nothing", "0" * 32)
    [conflict] = graph.topic("/count").unattached
    assert (conflict.node, conflict.publishes) == ("/post", True)
    assert len(world.bridge.warnings) == 1
    world.bridge.publishes["/count"] = {"/post": (INT32, MD5[INT32])}
    world.settle("/count")
    topic = graph.topic("/count")
    assert topic.unattached == []
    assert [*topic.publishers] == ["/post"]


def test_service_is_called_both_ways(world: World) -> None:
    bridge, graph = world.bridge, world.graph
    later = world.clock.call_later
    graph.serve("/ours", ADD, None, MailServer("/client", lambda values: {"sum": values["a"]}))
    bridge.call("/ours", {"a": 1, "b": 2}, "/post", later)
    bridge.serve("/post", "/theirs", ADD, lambda values: {"sum": values["b"]})
    bridge.call("/theirs", {"a": 1, "b": 2}, "/client", later)
    assert bridge.delivered == [("/ours", {"sum": 1}), ("/theirs", {"sum": 2})]
    assert world.clock.timers == 0
    bridge.leave("/post")
    assert [*graph.services] == ["/ours"]


@pytest.mark.parametrize("is_replaced", [False, True], ids=["leaves", "replaced"])
def test_nothing_of_a_node_that_has_left_stays(world: World, *, is_replaced: bool) -> None:
    world.publishes("/count", INT32)
    world.subscribes("/count", INT32)
    if is_replaced:
        other = MailNode("/post", 0, lambda node: None)
        world.graph.enter(other, "/post")
        world.graph.leave(other, "/post")
    else:
        world.bridge.leave("/post")
    world.clock.turn()
    assert not world.graph.topics
    assert not world.graph.nodes
    assert not world.graph._left
