"""The ROS 2 nodes of a network as nodes of the graph, found by their tokens."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable, Iterator
from typing import Protocol, TypeVar

from fibws.access.rights import Principal
from fibws.errors import Ros2Error
from fibws.hub.errors import NotAllowed
from fibws.hub.foreign.nodes import ForeignNode
from fibws.hub.graph.graph import Graph
from fibws.hub.log.text import is_power_of_ten, printable
from fibws.hub.ros2.key_layout import TOPIC_KINDS, Entity, gid_of, is_left_out

logger = logging.getLogger("fibws.hub")

K = TypeVar("K")

CLIENT = "ros2"
"""Stands for ROS 2 programs that belong to no known node, such as clients without a token."""
MOST_TOKENS = 100_000
"""Tokens of a network that are kept."""


class Ros2Node(ForeignNode):
    """A ROS 2 node; a `GraphNode` of the graph."""

    __slots__ = ()

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        """Report that it answers: its token would be gone otherwise."""
        return asyncio.get_running_loop().call_soon(done, "").cancel

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        """Report that ROS 2 nodes cannot be ended by others."""
        text = f"{self.name} is a ROS 2 node, which can only be ended on its machine"
        return asyncio.get_running_loop().call_soon(done, text).cancel


class Ros2Endpoints(Protocol):
    """Attaches the topics, or the services, of ROS 2 nodes."""

    def changed(self, name: str) -> None:
        """Called when the ROS 2 nodes that use a name have changed."""

    def detach(self, node: Ros2Node) -> None:
        """Detach, name by name, what a node uses that has left."""


class Ros2Nodes:
    """The nodes of a network, by their tokens.

    A node of the hub that has the same name stays, and the ROS 2 node is attached once the name is
    free: nobody but its own process can end it.

    Args:
        session_id: returns that of the hub, whose own tokens are ignored.
        principal: whose rights they have; None on a hub without authentication.

    Attributes:
        attached: the nodes that are in the graph, by name.
        endpoints: set before the first token arrives: for topics, and for services.
    """

    def __init__(
        self, graph: Graph, session_id: Callable[[], str], principal: Principal | None
    ) -> None:
        self.attached: dict[str, Ros2Node] = {}
        self.topics: Ros2Endpoints
        self.services: Ros2Endpoints
        self._graph = graph
        self._session_id = session_id
        self._principal = principal
        self._entities: dict[str, Entity] = {}
        """By token."""
        self._by_node: dict[str, dict[str, Entity]] = {}
        """By node and token."""
        self._by_name: dict[tuple[bool, str], dict[str, Entity]] = {}
        """Whether it is a topic, and its name or that of a service; then by token."""
        self._gids: dict[bytes, Entity] = {}
        """The publishers and service clients."""
        self._faults = 0
        self._warned: set[str] = set()
        """The nodes whose names are taken, or that may not join."""
        if principal is not None:
            graph.policy.enter(CLIENT, principal, is_chosen=False, is_taken=False)
        graph.watch("node", self._node_changed)

    # Looking up.

    def entities(self, name: str, *, is_topic: bool) -> Iterable[Entity]:
        """Return what attached nodes have of a topic or a service, the oldest first."""
        found = self._by_name.get((is_topic, name), {}).values()
        return [entity for entity in found if entity.node in self.attached]

    def of_gid(self, gid: bytes) -> Entity | None:
        """Return the publisher or the service client with a gid."""
        return self._gids.get(gid)

    # Tokens.

    def token(self, text: str, is_alive: bool) -> None:
        """Called when a token appears or disappears."""
        if not is_alive:
            self._remove(text)
            return
        if text in self._entities:
            return
        try:
            entity = Entity.parse(text)
        except Ros2Error as error:
            self._reject(str(error))
            return
        if entity.session == self._session_id():
            return
        if len(self._entities) >= MOST_TOKENS:
            self._reject(f"too many tokens (limit {MOST_TOKENS})")
            return
        self._entities[text] = entity
        self._by_node.setdefault(entity.node, {})[text] = entity
        if entity.name and not is_left_out(entity.name):
            key = entity.kind in TOPIC_KINDS, entity.name
            self._by_name.setdefault(key, {})[text] = entity
        if entity.kind in ("MP", "SC"):
            self._gids[gid_of(text)] = entity
        self._settle(entity.node)
        self._changed(entity)

    def _remove(self, text: str) -> None:
        entity = self._entities.pop(text, None)
        if entity is None:
            return
        if entity.kind in ("MP", "SC"):
            self._gids.pop(gid_of(text), None)
        if entity.name:
            key = entity.kind in TOPIC_KINDS, entity.name
            _remove(self._by_name, key, text)
        _remove(self._by_node, entity.node, text)
        self._changed(entity)
        self._settle(entity.node)

    def _changed(self, entity: Entity) -> None:
        if not entity.name or is_left_out(entity.name):
            return
        if entity.kind in TOPIC_KINDS:
            self.topics.changed(entity.name)
        else:
            self.services.changed(entity.name)

    def _reject(self, text: str) -> None:
        """Log an invalid token; not each time."""
        self._faults += 1
        if is_power_of_ten(self._faults):
            logger.warning("ROS 2 (%d invalid tokens so far): %s", self._faults, printable(text))

    # Attaching.

    def set_principal(self, principal: Principal) -> None:
        """Give all nodes the rights of a principal, and attach them again, in turns."""
        self._principal = principal
        for name in (CLIENT, *self.attached):
            self._graph.policy.enter(name, principal, is_chosen=False, is_taken=False)
        self._graph.revision += 1
        self._warned.clear()
        self._graph.finish(self._attach_again(principal))

    def _attach_again(self, principal: Principal) -> Iterator[None]:
        for name in list(self._by_node):
            if self._principal is not principal:
                return  # A newer one is on its way.
            attached = self.attached.get(name)
            if attached is not None:
                self._detach(attached)
            self._settle(name)
            yield

    def close(self) -> None:
        """Detach all nodes."""
        self._entities.clear()
        self._by_node.clear()
        self._by_name.clear()
        for node in list(self.attached.values()):
            self._detach(node)

    def _settle(self, name: str) -> None:
        """Attach the node of a name if there is one, and the name is free; else detach it."""
        attached, is_there = self.attached.get(name), name in self._by_node
        if not is_there:
            self._warned.discard(name)
        if attached is not None:
            if not is_there:
                self._detach(attached)
            return
        if not is_there or name in self._warned:
            return
        if name in self._graph.nodes:
            self._warned.add(name)
            logger.warning("The ROS 2 node %s is left out: another node has its name.", name)
            return
        node = Ros2Node(name, self._graph.now(), self._replaced)
        self.attached[name] = node  # Whoever is told of it must know whose it is.
        try:
            self._graph.enter(node, name, self._principal)
        except NotAllowed as error:
            del self.attached[name]
            self._warned.add(name)
            logger.warning("The ROS 2 node %s may not join: %s", name, error)
            return
        for entity in self._by_node[name].values():
            self._changed(entity)

    def _detach(self, node: Ros2Node) -> None:
        del self.attached[node.name]
        self.topics.detach(node)
        self.services.detach(node)
        self._graph.leave(node, node.name)

    def _replaced(self, node: Ros2Node) -> None:
        """Detach a node whose name another one has taken."""
        if self.attached.get(node.name) is node:
            del self.attached[node.name]
            self._warned.add(node.name)
            logger.warning("The ROS 2 node %s is left out: another node has its name.", node.name)
            self.topics.detach(node)
            self.services.detach(node)

    def _node_changed(self, name: str) -> None:
        """Attach a node once its name is free."""
        if name in self._by_node and name not in self._graph.nodes:
            if name not in self.attached:
                self._warned.discard(name)
                self._settle(name)


def _remove(index: dict[K, dict[str, Entity]], key: K, token: str) -> None:
    entities = index.get(key, {})
    entities.pop(token, None)
    if not entities:
        index.pop(key, None)
