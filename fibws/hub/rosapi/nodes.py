"""The nodes that the hub itself is: they stand for ROS's rosout, rosapi and rosbridge_websocket."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from fibws.hub.clock import Clock
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publisher import Publisher
from fibws.hub.rosapi import loggers
from fibws.hub.rosapi.clients import Client, ConnectedClients
from fibws.hub.rosapi.parameters import set_defaults
from fibws.hub.rosapi.rosapi import Rosapi

ROSOUT = "/rosout"
"""A node, and the topic that it hears."""
ROSAPI = "/rosapi"
ROSBRIDGE = "/rosbridge_websocket"
OWN_NODES = (ROSAPI, ROSBRIDGE, ROSOUT)
LOG = "rosgraph_msgs/Log"

PUBLISHED = {
    ROSOUT: (ROSAPI, LOG),
    "/rosout_agg": (ROSOUT, LOG),
    "/client_count": (ROSBRIDGE, "std_msgs/Int32"),
    "/connected_clients": (ROSBRIDGE, "rosbridge_msgs/ConnectedClients"),
}
"""The hub's own topics, each with the node that publishes it and its type."""
HEARD = {ROSOUT: [ROSOUT]}
"""The topics that the hub's own nodes hear, with these."""


@dataclass(frozen=True, slots=True, eq=False)
class OwnNode:
    """A node that is part of the hub."""

    name: str
    published: Sequence[str]
    heard: Sequence[str]
    provided: Sequence[str]

    def publishing(self) -> Sequence[str]:
        """The topics that it publishes."""
        return self.published

    def subscribing(self) -> Sequence[str]:
        """The topics that it subscribes to."""
        return self.heard

    def providing(self) -> Sequence[str]:
        """The services that it provides."""
        return self.provided

    def replaced(self) -> None:
        """The gate does not let that happen."""
        raise AssertionError(f"{self.name} is the hub's own")


class OwnNodes:
    """The hub's own nodes with all that they publish, hear and provide, and the first parameters.

    Args:
        host: the name or the address by which the hub is reached.
        port: the port that it will listen on.
        run_id: a UUID of this run of the hub.
    """

    def __init__(self, graph: Graph, clock: Clock, *, host: str, port: int, run_id: str) -> None:
        self._graph = graph
        set_defaults(graph.parameters, run_id=run_id, host=host, port=port)
        self._publishers = {topic: self._publisher(topic) for topic in PUBLISHED}
        self.clients = ConnectedClients(
            self._publishers["/client_count"], self._publishers["/connected_clients"], clock
        )
        """Those that are connected."""
        rosapi = Rosapi(graph, OWN_NODES, HEARD, self.clients, clock)
        self._rosnode = rosapi.rosnode
        services = rosapi.services()
        for name in OWN_NODES:
            services.update(loggers.services(name))
        for service, (type_, function) in services.items():
            graph.offer(service, type_, _namespace(service), function)
        graph.topics[ROSOUT].observers.append(self._repeat)
        self._nodes = [
            OwnNode(
                name,
                [topic for topic, (node, _) in PUBLISHED.items() if node == name],
                [topic for topic, nodes in HEARD.items() if name in nodes],
                [service for service in services if _namespace(service) == name],
            )
            for name in OWN_NODES
        ]
        for node in self._nodes:
            graph.enter(node, node.name)

    def connected(self, client: Client) -> None:
        """A client has come."""
        self.clients.connected(client, self._graph.now())

    def ponged(self, client: Client, data: bytes) -> None:
        """A client has sent a pong with these data."""
        self._rosnode.ponged(client, data)

    def disconnected(self, client: Client) -> None:
        """A client is gone; nothing happens if it had not come."""
        self.clients.disconnected(client)
        self._rosnode.left(client)

    def close(self) -> None:
        """Take everything back but the parameters; the second time nothing happens."""
        if not self._nodes:
            return
        self.clients.close()
        self._rosnode.close()
        self._graph.topics[ROSOUT].observers.remove(self._repeat)
        for publisher in self._publishers.values():
            self._graph.remove_publisher(publisher)
        for node in self._nodes:
            for service in node.provided:
                self._graph.remove_service(self._graph.services[service])
            self._graph.leave(node, node.name)
        self._nodes.clear()

    def _publisher(self, topic: str) -> Publisher:
        node, type_ = PUBLISHED[topic]
        return self._graph.add_publisher(self._graph.topic(topic), node, type_, latch=False)

    def _repeat(self, message: dict[str, Any]) -> None:
        """Publish a message on /rosout again, to those who hear what rosout has gathered."""
        aggregated = self._publishers["/rosout_agg"]
        if aggregated.topic.channels:
            aggregated.publish(message)


def _namespace(name: str) -> str:
    return name.rpartition("/")[0]
