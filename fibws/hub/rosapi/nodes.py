"""The hub's own nodes: they stand for ROS's rosout, rosapi and rosbridge_websocket.

rosapi's services let clients without ROS inspect the ROS graph. Their names, types and rules
are those of the ROS 1 package (RobotWebTools/rosbridge_suite, rosapi). ROS 2's get_ros_version is
left out on purpose: clients take a hub that has it for ROS 2. The services with types of fibws_msgs
are additions of fibws: one response replaces hundreds of calls.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fibws.errors import OperationError
from fibws.hub.delivery.clock import Clock
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.graph import ROSBRIDGE, Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.service import Function
from fibws.hub.graph.topic import SinkReport, Source
from fibws.hub.log.audit import Audit
from fibws.hub.rosapi import loggers
from fibws.hub.rosapi.clients import ConnectedClients, ListedClient
from fibws.hub.rosapi.introspection import Introspection
from fibws.hub.rosapi.parameters import ParameterServices, set_defaults
from fibws.hub.rosapi.refusals import Refusals
from fibws.hub.rosapi.rosnode import Rosnode
from fibws.hub.rosapi.snapshot import Snapshot
from fibws.hub.rosapi.statistics import Statistics
from fibws.hub.rosapi.typedefs import TypeDefs
from fibws.protocol.decoding import quoted

logger = logging.getLogger("fibws.hub")

ROSOUT = "/rosout"
"""A node, and the topic that it subscribes to."""
ROSAPI = "/rosapi"
CLOCK = "/clock"
USE_SIM_TIME = "/use_sim_time"
RESERVED_NODES = (ROSAPI, ROSBRIDGE)
"""The hub's own nodes whose names no client may take."""
LOG = "rosgraph_msgs/Log"

PUBLISHED = {
    ROSOUT: ((ROSAPI, ROSBRIDGE), LOG),
    "/client_count": ((ROSBRIDGE,), "std_msgs/Int32"),
    "/connected_clients": ((ROSBRIDGE,), "rosbridge_msgs/ConnectedClients"),
}
"""The topics of the hub's own nodes but `RosoutNode`, each with its publishers and its type."""


@dataclass(frozen=True, slots=True, eq=False)
class OwnNode:
    """A node that is part of the hub."""

    name: str
    published: Sequence[str]
    subscribed: Sequence[str]
    services: Sequence[str]

    def publishing(self) -> Sequence[str]:
        """Return the topics that it publishes."""
        return self.published

    def subscribing(self) -> Sequence[str]:
        """Return the topics that it subscribes to."""
        return self.subscribed

    def providing(self) -> Sequence[str]:
        """Return the services that it provides."""
        return self.services

    def replaced(self) -> None:
        """Fail: no client can take its name."""
        raise AssertionError(f"{self.name} is the hub's own")


class RosoutAggregator:
    """Publishes every message of /rosout on /rosout_agg, as ROS's rosout node does; a `Sink`."""

    def __init__(self, aggregated: Source) -> None:
        self.node = aggregated.node
        self.source = aggregated
        self._messages = 0

    def receive(self, publication: Publication) -> None:
        """Publish a message again if there are subscribers."""
        self._messages += 1
        if self.source.group.has_sinks:
            self.source.forward(publication)

    def replay(self, publication: Publication) -> None:
        """Ignore a latched message: nodes do not latch their log."""

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(messages=self._messages)


class RosoutNode:
    """The node /rosout: it aggregates the log, and has the services of loggers; a `GraphNode`.

    A client may take its name, as in ROS, on a hub without authentication. /rosapi aggregates the
    log until that client has left.
    """

    name = ROSOUT

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._services: tuple[str, ...] = ()
        self._closed = False
        self._aggregator = self._aggregate(ROSAPI)
        self._enter()
        graph.watch("node", self._node_changed)

    def publishing(self) -> Sequence[str]:
        """Return the topics that it publishes."""
        return ("/rosout_agg",)

    def subscribing(self) -> Sequence[str]:
        """Return the topics that it subscribes to."""
        return (ROSOUT,)

    def providing(self) -> Sequence[str]:
        """Return the services that it provides."""
        return self._services

    def replaced(self) -> None:
        """Make room for a client of this name."""
        self._remove_services()
        self._graph.rights.internal.discard(ROSOUT)
        self._move(ROSAPI)

    def close(self) -> None:
        """Take everything back; the second time nothing happens."""
        if self._closed:
            return
        self._closed = True
        self._remove_aggregator()
        self._remove_services()
        self._graph.leave(self, ROSOUT)

    def _enter(self) -> None:
        self._graph.rights.internal.add(ROSOUT)
        self._move(ROSOUT)
        services = loggers.services(ROSOUT)
        for service, (type_, function) in services.items():
            self._graph.serve_internally(service, type_, ROSOUT, function)
        self._services = tuple(services)
        self._graph.enter(self, ROSOUT, internal=True)

    def _node_changed(self, name: str) -> None:
        if name == ROSOUT and ROSOUT not in self._graph.nodes and not self._closed:
            self._enter()

    def _move(self, node: str) -> None:
        """Let another node be the one that aggregates."""
        self._remove_aggregator()
        self._aggregator = self._aggregate(node)

    def _aggregate(self, node: str) -> RosoutAggregator:
        graph = self._graph
        aggregator = RosoutAggregator(graph.advertise(graph.topic("/rosout_agg"), node, LOG))
        graph.subscribe(graph.topic(ROSOUT), aggregator, LOG)
        return aggregator

    def _remove_aggregator(self) -> None:
        self._graph.unsubscribe(self._graph.topics[ROSOUT], self._aggregator)
        self._graph.remove_source(self._aggregator.source)

    def _remove_services(self) -> None:
        for service in self._services:
            self._graph.remove_service(self._graph.services[service])
        self._services = ()


class SimulatedTime:
    """Sets the graph's time from /clock while /use_sim_time is true (http://wiki.ros.org/Clock).

    It is a `Sink`. ROS nodes read the parameter once, when they start; the hub outlives them, so it
    follows each change.

    Args:
        subscribed: the topics of the node that subscribes.
    """

    node = ROSAPI

    def __init__(self, graph: Graph, subscribed: list[str]) -> None:
        self._graph = graph
        self._subscribed = subscribed
        self._messages = 0
        graph.parameters.watch(self._parameter_changed)

    def receive(self, publication: Publication) -> None:
        """Set the time, which is that of the message, too; others get it after this."""
        self._messages += 1
        clock = publication.values()["clock"]
        publication.received = clock["secs"] * 10**9 + clock["nsecs"]
        self._graph.clock.simulated = publication.received

    def replay(self, publication: Publication) -> None:
        """Set the time by a latched message."""
        self.receive(publication)

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(messages=self._messages)

    def close(self) -> None:
        """Return to the system's time."""
        if self._subscribed:
            self._subscribed.clear()
            self._graph.unsubscribe(self._graph.topics[CLOCK], self)
        self._graph.clock.simulated = None

    def _parameter_changed(self, name: str, node: str) -> None:
        if name.strip("/") not in ("", USE_SIM_TIME.strip("/")):
            return
        parameters = self._graph.parameters
        if not (parameters.has(USE_SIM_TIME) and parameters.get(USE_SIM_TIME) is True):
            self.close()
        elif not self._subscribed:
            topic = self._graph.topic(CLOCK)
            topic.first = self
            try:
                self._graph.subscribe(topic, self, "rosgraph_msgs/Clock")
            except OperationError as error:
                logger.warning("The hub does not use simulated time: %s", error)
                return
            self._subscribed.append(CLOCK)
            self._graph.clock.simulated = self._graph.clock.simulated or 0


class OwnNodes:
    """The hub's own nodes with all that they publish and serve, and the first parameters.

    Args:
        host: the name or the address by which the hub is reached.
        port: the port that it will listen on.
        address: the address that it will listen on.
        run_id: a UUID of this run of the hub.
        hubs: returns the other hubs, as for `Snapshot`.
    """

    def __init__(
        self,
        graph: Graph,
        clock: Clock,
        audit: Audit,
        *,
        host: str,
        port: int,
        address: str,
        run_id: str,
        hubs: Callable[[str], dict[str, Any]],
    ) -> None:
        self._graph = graph
        self._hubs = hubs
        self._audit = audit
        graph.rights.internal.update(RESERVED_NODES)
        graph.permanent.update(RESERVED_NODES)
        graph.reserved.update({"/rosout_agg", *PUBLISHED} - {ROSOUT})
        graph.rights.guards[ROSOUT] = self._check_author
        set_defaults(graph.parameters, run_id=run_id, host=host, port=port, address=address)
        self.parameters = graph.parameters.names()
        """The parameters that the hub sets for itself."""
        self._sources = {
            (node, topic): graph.advertise(graph.topic(topic), node, type_)
            for topic, (nodes, type_) in PUBLISHED.items()
            for node in nodes
        }
        self.clients = ConnectedClients(
            self._sources[ROSBRIDGE, "/client_count"],
            self._sources[ROSBRIDGE, "/connected_clients"],
            clock,
        )
        """The clients that are connected."""
        self.refusals = Refusals(self._sources[ROSBRIDGE, ROSOUT], clock)
        """The operations that were refused."""
        self._rosnode = Rosnode(graph, self.clients, clock, audit)
        services = self._services()
        for service, (type_, function) in services.items():
            graph.serve_internally(service, type_, _namespace(service), function)
        self._rosout = RosoutNode(graph)
        subscribed: dict[str, list[str]] = {name: [] for name in RESERVED_NODES}
        self._simulated_time = SimulatedTime(graph, subscribed[ROSAPI])
        self._nodes = [
            OwnNode(
                name,
                [topic for topic, (nodes, _) in PUBLISHED.items() if name in nodes],
                subscribed[name],
                [service for service in services if _namespace(service) == name],
            )
            for name in RESERVED_NODES
        ]
        for node in self._nodes:
            graph.enter(node, node.name, internal=True)

    def connected(self, client: ListedClient) -> None:
        """Add a client that has connected."""
        self.clients.connected(client, self._graph.now())

    def ponged(self, client: ListedClient, data: bytes) -> None:
        """Called when a client has sent a pong with these data."""
        self._rosnode.ponged(client, data)

    def disconnected(self, client: ListedClient) -> None:
        """Remove a client; nothing happens if it had not connected."""
        self.clients.disconnected(client)
        self._rosnode.left(client)

    def close(self) -> None:
        """Take everything back but the parameters; the second time nothing happens."""
        if not self._nodes:
            return
        self.clients.close()
        self._rosnode.close()
        self._simulated_time.close()
        self._rosout.close()
        for source in self._sources.values():
            self._graph.remove_source(source)
        for node in self._nodes:
            for service in node.services:
                self._graph.remove_service(self._graph.services[service])
            self._graph.leave(node, node.name)
        self._nodes.clear()

    def _services(self) -> dict[str, tuple[str, Function]]:
        """Return all services by their global names, each with its type and handler."""
        graph = self._graph
        services = {
            **Introspection(graph).services(),
            **ParameterServices(graph, self._audit).services(),
            **Snapshot(graph, self.clients, self._hubs).services(),
            **Statistics(graph, self.clients).services(),
            **TypeDefs(graph.definitions).services(),
            **self._rosnode.services(),
        }
        for name in RESERVED_NODES:
            services.update(loggers.services(name))
        return services

    def _check_author(self, node: str, values: Mapping[str, Any]) -> None:
        """Refuse a log line that a node writes in the name of another; raises `NotAllowed`."""
        author = values["name"]
        if author not in ("", node):
            fault = f"log lines must have the name of their node, got {quoted(author)}"
            raise self._graph.rights.refused(NotAllowed(node, "publish", ROSOUT, fault))


def _namespace(name: str) -> str:
    return name.rpartition("/")[0]
