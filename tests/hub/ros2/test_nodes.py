"""ROS 2 nodes in the graph, without a network."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from fibws.access.rights import Principal, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.graph.graph import Graph
from fibws.hub.ros2.nodes import Ros2Node, Ros2Nodes
from fibws.interfaces import Interfaces

from ..fakes import NANOSECONDS


class Endpoints:
    """Records the names and the nodes that have changed."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def changed(self, name: str) -> None:
        self.seen.append(name)

    def detach(self, node: Ros2Node) -> None:
        self.seen.append(f"without {node.name}")


def principal(name: str, *publish: str) -> Principal:
    return Principal(name, Rights({"publish": list(publish), "node": ["/**"]}))


class World:
    """Three nodes, each with a publisher, whose principal may be changed step by step."""

    def __init__(self) -> None:
        self.graph = Graph(Interfaces(), lambda: NANOSECONDS, policy=AccessPolicy())
        self.nodes = Ros2Nodes(self.graph, lambda: "own", principal("old", "/**"))
        self.topics = self.nodes.topics = Endpoints()
        self.nodes.services = Endpoints()
        for number in range(3):
            self.nodes.token(f"@ros2_lv/2/aac3178e146ba6f1/0/{number}/NN/%/%/n{number}", True)
        self.topics.seen.clear()
        self.work: list[Iterator[None]] = []
        self.graph.finish = self.work.append


@pytest.fixture
def world() -> World:
    return World()


def test_nodes_with_other_rights_are_attached_again_in_turns(world: World) -> None:
    before = dict(world.nodes.attached)
    assert sorted(before) == ["/n0", "/n1", "/n2"]
    world.nodes.set_principal(principal("new"))
    # The rights are those of the new one at once.
    assert not any(world.graph.rights.allows(name, "publish", "/a") for name in before)
    [steps] = world.work
    next(steps)
    assert [world.nodes.attached[name] is before[name] for name in sorted(before)] == [
        False,
        True,
        True,
    ]
    assert list(steps) == [None, None]
    assert world.nodes.attached.keys() == before.keys()
    assert not set(world.nodes.attached.values()) & set(before.values())
    assert world.topics.seen == [f"without {name}" for name in sorted(before)]


def test_newer_rights_replace_those_that_are_being_given(world: World) -> None:
    world.nodes.set_principal(principal("new"))
    world.nodes.set_principal(principal("newer", "/a"))
    older, newer = world.work
    assert list(older) == []
    assert len(list(newer)) == 3
    assert all(world.graph.rights.allows(name, "publish", "/a") for name in world.nodes.attached)


def test_node_that_leaves_meanwhile_stays_away(world: World) -> None:
    world.nodes.set_principal(principal("new"))
    world.nodes.token("@ros2_lv/2/aac3178e146ba6f1/0/1/NN/%/%/n1", False)
    for _ in world.work[0]:
        pass
    assert sorted(world.nodes.attached) == ["/n0", "/n2"]
    assert sorted(world.graph.nodes) == ["/n0", "/n2"]
