"""The tokens of this hub's nodes, by which ROS 2 programs see them."""

from __future__ import annotations

import re
from itertools import count

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import NodeOfLink
from fibws.hub.ros2.key_layout import Entity, Kind, Qos, gid_of, is_left_out, is_legal
from fibws.hub.ros2.network import Declared, Ros2Network
from fibws.hub.ros2.nodes import Ros2Node

HUB = "/fibws_hub"
"""The node that has the subscriptions of the hub's own nodes, which ROS 2 does not see."""
_ILLEGAL = re.compile(r"\W", re.ASCII)


class OwnEntity:
    """A token of this hub.

    Attributes:
        gid: what messages and requests of it have in their attachments.
    """

    __slots__ = ("declared", "entity", "gid")

    def __init__(self, entity: Entity, network: Ros2Network) -> None:
        token = entity.token()
        self.entity = entity
        self.gid = gid_of(token)
        self.declared: Declared = network.declare_token(token)

    def close(self) -> None:
        """Undeclare the token."""
        self.declared.close()


class Ros2Tokens:
    """The nodes of the graph that are not ROS 2's, as ROS 2 sees them.

    The hub's own nodes are left out, but for `HUB`, as are topics and services whose names ROS 2
    does not allow.
    """

    def __init__(self, graph: Graph, network: Ros2Network) -> None:
        self._graph = graph
        self._network = network
        self._tokens: dict[str, OwnEntity] = {}
        """By node."""
        self._ids = count(1)
        graph.watch("node", self._changed)

    def start(self) -> None:
        """Declare all nodes."""
        for name in self._graph.nodes:
            self._changed(name)

    def is_shown(self, node: str) -> bool:
        """Return whether ROS 2 may see a node."""
        found = self._graph.nodes.get(node)
        is_own = found is not None and not isinstance(found, Ros2Node | NodeOfLink)
        return is_own and node not in self._graph.rights.internal

    def may_show(self, name: str) -> bool:
        """Return whether ROS 2 may see a topic or a service."""
        return is_legal(name) and not is_left_out(name)

    def declare(
        self, kind: Kind, node: str, name: str, type_: str, type_hash: str, qos: Qos
    ) -> OwnEntity:
        """Declare what a node has, which ROS 2 sees."""
        network, owner = self._network, self._token(node).entity
        number = str(next(self._ids))
        ids = network.domain, network.session_id, owner.node_id, number
        return OwnEntity(Entity(*ids, kind, owner.node, name, type_, type_hash, qos), network)

    def close(self) -> None:
        """Undeclare all nodes."""
        for token in self._tokens.values():
            token.close()
        self._tokens.clear()

    def _changed(self, name: str) -> None:
        if not self.is_shown(name):
            if name in self._tokens and name != HUB:
                self._tokens.pop(name).close()
        elif self._graph.policy.allows_all:
            self._token(name)  # Otherwise once it has something that ROS 2 may see.

    def _token(self, name: str) -> OwnEntity:
        found = self._tokens.get(name)
        if found is None:
            number, network = str(next(self._ids)), self._network
            entity = Entity(network.domain, network.session_id, number, number, "NN", legal(name))
            found = self._tokens[name] = OwnEntity(entity, network)
        return found


def legal(name: str) -> str:
    """Return a node's name as ROS 2 allows it: ``/_1_a/b`` for ``/1-a/b``."""
    if is_legal(name):
        return name
    parts = (_ILLEGAL.sub("_", part) for part in name.strip("/").split("/"))
    return "".join(f"/_{part}" if part[:1].isdigit() else f"/{part or '_'}" for part in parts)[:200]
