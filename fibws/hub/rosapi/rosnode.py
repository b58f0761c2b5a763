"""Services behind rosnode's ping, kill and cleanup.

They are /rosapi/ping_node, /rosapi/kill_node and /rosapi/unregister_node.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from functools import partial
from itertools import count
from typing import Any

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import DistantNode, ExternalNode
from fibws.hub.graph.service import Deferred, Function, Response
from fibws.hub.log.audit import Audit
from fibws.hub.log.text import shortened
from fibws.hub.rosapi.clients import ConnectedClients, ListedClient
from fibws.hub.rosapi.introspection import global_name
from fibws.protocol.websocket import KILLED

PATIENCE = 3.0
"""Seconds in which a node must answer a ping."""


@dataclass(frozen=True, slots=True, eq=False)
class Ping:
    """A ping that waits for its pong; ``sent`` is in nanoseconds since 1970."""

    node: str
    sent: int
    timer: Timer
    response: Deferred


class Rosnode:
    """Pings, kills and unregisters nodes; the hub's own nodes have no connection for that.

    Args:
        clients: those that are connected.
    """

    def __init__(self, graph: Graph, clients: ConnectedClients, clock: Clock, audit: Audit) -> None:
        self._graph = graph
        self._audit = audit
        self._clients = clients
        self._clock = clock
        self._numbers = count(1)
        self._pings: dict[ListedClient, OrderedDict[bytes, Ping]] = {}
        """Each client's pings by the data of their pongs, the oldest first."""

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return all services by their global names, each with its type and handler."""
        return {
            "/rosapi/ping_node": ("fibws_msgs/PingNode", self.ping),
            "/rosapi/kill_node": ("fibws_msgs/KillNode", self.kill),
            "/rosapi/unregister_node": ("fibws_msgs/UnregisterNode", self.unregister),
        }

    def ping(self, request: dict[str, Any], caller: str) -> Response | Deferred:
        """Return how many seconds a node takes to answer a WebSocket ping."""
        node = global_name(self._graph, request["node"], caller)
        found = self._graph.view(caller).node(node)
        if found is None:
            return _ping_failed(_unknown(node))
        if isinstance(found, DistantNode):
            return self._ping_distant(node, found)
        client = self._clients.find(node)
        if client is None:
            return {"success": True, "message": f"{node} is the hub's own", "seconds": 0.0}
        if client.queue.paused:
            return _ping_failed(f"{node} reads too slowly: a ping would wait behind other bytes")
        data = next(self._numbers).to_bytes(8, "big")
        # The clock of an event loop may be as coarse as a millisecond, and as old as its turn.
        sent = self._graph.now()
        client.ping(data)
        response = Deferred()
        response.on_cancel(partial(self._drop, client, data))
        timer = self._clock.call_later(PATIENCE, partial(self._give_up, client, data))
        self._pings.setdefault(client, OrderedDict())[data] = Ping(node, sent, timer, response)
        return response

    def kill(self, request: dict[str, Any], caller: str) -> Response | Deferred:
        """End a node by closing its connection with a reason, on which fibws's nodes exit.

        A node that is not connected to the hub is asked to end.

        Raises:
            NotAllowed: the node is another principal's, and the caller is not an admin.
        """
        node = global_name(self._graph, request["node"], caller)
        found = self._graph.view(caller).node(node)
        if found is None:
            return {"success": False, "message": _unknown(node)}
        client = self._clients.find(node)
        if client is None and not isinstance(found, DistantNode):
            text = f"{node} is the hub's own, which ends with the hub alone"
            return {"success": False, "message": text}
        self._check_may_end(caller, node)
        self._audit.node_killed(node, node=caller)
        if client is None:
            assert isinstance(found, DistantNode)
            return _kill_distant(node, found)
        # It may be the caller, whose operations in the same text must not outlive it.
        self._clock.call_later(0, partial(client.close, KILLED))
        return {"success": True, "message": f"killed {node}"}

    def unregister(self, request: dict[str, Any], caller: str) -> Response:
        """Remove a node that has not answered its last ping, as rosnode cleanup does.

        Nodes that are connected to the hub are removed when they disconnect. A ROS 1 node that
        answers stays: it would never register again.

        Raises:
            NotAllowed: as with `kill`.
        """
        node = global_name(self._graph, request["node"], caller)
        external = self._graph.view(caller).node(node)
        if external is None:
            return {"success": False, "message": _unknown(node)}
        if not isinstance(external, ExternalNode):
            text = f"{node} is not a ROS 1 node: it is removed when it disconnects"
            return {"success": False, "message": text}
        self._check_may_end(caller, node)
        if not external.fault:
            return {
                "success": False,
                "message": f"{node} answers: only unreachable nodes can be unregistered",
            }
        self._audit.node_unregistered(node, node=caller)
        external.unregister()
        return {"success": True, "message": f"unregistered {node}"}

    def ponged(self, client: ListedClient, data: bytes) -> None:
        """Respond to the pings that a client's pong answers."""
        now = self._graph.now()
        # A pong may stand for the pings before as well (RFC 6455, section 5.5.3).
        while data in (pings := self._pings.get(client, OrderedDict())):
            first, ping = next(iter(pings.items()))
            text = f"{ping.node} has answered"
            seconds = max(0, now - ping.sent) / 1_000_000_000
            self._settle(client, first, {"success": True, "message": text, "seconds": seconds})

    def left(self, client: ListedClient) -> None:
        """Fail the pings of a client that has disconnected."""
        for data, ping in list(self._pings.get(client, {}).items()):
            self._settle(client, data, _ping_failed(f"{ping.node} has left"))

    def close(self) -> None:
        """Fail all pings."""
        for client, pings in list(self._pings.items()):
            for data in list(pings):
                self._settle(client, data, _ping_failed("the hub is shutting down"))

    def _ping_distant(self, name: str, node: DistantNode) -> Deferred:
        sent = self._graph.now()
        response = Deferred()

        def done(fault: str) -> None:
            seconds = max(0, self._graph.now() - sent) / 1_000_000_000
            text = f"{name} has answered"
            answer = {"success": True, "message": text, "seconds": seconds}
            response.respond(_ping_failed(f"{name}: {fault}") if fault else answer)

        response.on_cancel(node.ping(done))
        return response

    def _check_may_end(self, caller: str, node: str) -> None:
        """Check that a node is the caller's, or the caller an admin; raises `NotAllowed`."""
        policy = self._graph.policy
        if not policy.is_same_owner(caller, node) and not policy.is_admin(caller):
            raise self._graph.rights.refused(NotAllowed(caller, "admin", node))

    def _give_up(self, client: ListedClient, data: bytes) -> None:
        text = f"{self._pings[client][data].node} did not answer within {PATIENCE:g} s"
        self._settle(client, data, _ping_failed(text))

    def _settle(self, client: ListedClient, data: bytes, answer: dict[str, Any]) -> None:
        response = self._pings[client][data].response
        self._drop(client, data)
        response.respond(answer)

    def _drop(self, client: ListedClient, data: bytes) -> None:
        self._pings[client].pop(data).timer.cancel()
        if not self._pings[client]:
            del self._pings[client]


def _kill_distant(name: str, node: DistantNode) -> Deferred:
    response = Deferred()

    def done(fault: str) -> None:
        response.respond(
            {"success": not fault, "message": f"{name}: {fault}" if fault else f"killed {name}"}
        )

    response.on_cancel(node.shut_down("user request", done))
    return response


def _unknown(node: str) -> str:
    return shortened(f"Node {node} does not exist")


def _ping_failed(text: str) -> dict[str, Any]:
    return {"success": False, "message": text, "seconds": 0.0}
