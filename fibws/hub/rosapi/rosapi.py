"""rosapi: the services by which clients that have no ROS ask for what ROS knows.

Their names, types and ways are those of the ROS 1 package (RobotWebTools/rosbridge_suite, rosapi).
ROS 2's get_ros_version is left out on purpose: clients take a hub that has it for ROS 2. Those of
fibws_msgs are ours alone: they tell in one answer what would take others hundreds of calls.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from fibws.hub.clock import Clock
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Function
from fibws.hub.rosapi.clients import ConnectedClients
from fibws.hub.rosapi.introspection import Introspection
from fibws.hub.rosapi.parameters import ParameterServices
from fibws.hub.rosapi.rosnode import Rosnode
from fibws.hub.rosapi.snapshot import Snapshot
from fibws.hub.rosapi.statistics import Statistics
from fibws.hub.rosapi.typedefs import TypeDefs


class Rosapi:
    """All of rosapi's services.

    Args:
        own: the names of the hub's own nodes.
        heard: those that hear a topic, by the topic's name.
        clients: those that are connected.
    """

    def __init__(
        self,
        graph: Graph,
        own: Collection[str],
        heard: Mapping[str, list[str]],
        clients: ConnectedClients,
        clock: Clock,
    ) -> None:
        self._typedefs = TypeDefs(graph.interfaces)
        self._introspection = Introspection(graph, heard)
        self._parameters = ParameterServices(graph.parameters)
        self._snapshot = Snapshot(graph, own, heard, clients)
        self._statistics = Statistics(graph, clients)
        self.rosnode = Rosnode(graph, clients, clock)
        """To be told of pongs, and of clients that leave."""

    def services(self) -> dict[str, tuple[str, Function]]:
        """All by their global names, each with its type and what answers it."""
        return {
            **self._introspection.services(),
            **self._parameters.services(),
            **self._snapshot.services(),
            **self._statistics.services(),
            **self._typedefs.services(),
            **self.rosnode.services(),
        }
