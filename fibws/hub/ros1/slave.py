"""The Slave API of ROS 1 (http://wiki.ros.org/ROS/Slave_API) for the nodes that are not ROS 1's.

The hub answers for all of them: at ``/node/<name>`` for one, at ``/`` for whichever publishes the
topic that is asked for.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any, Protocol

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.topic import Topic
from fibws.hub.ros1 import api
from fibws.hub.ros1.api import Answer, Method
from fibws.hub.ros1.http import XmlRpcCaller
from fibws.hub.ros1.nodes import Ros1Nodes
from fibws.hub.ros1.topic_registrations import ANY, CLIENT

_topic = api.resolved("topic")


class TopicServer(Protocol):
    """Serves the topics of the hub's clients to ROS 1 subscribers."""

    def request_topic(
        self, caller: str, topic: str, protocols: list[Any], host: str, port: int
    ) -> Answer:
        """Return how a subscriber can connect."""

    def bus_info(self, node: str) -> list[Any]:
        """Return the connections for a node, or all if it is empty, as getBusInfo does."""

    def bus_stats(self, node: str) -> list[Any]:
        """Return their statistics, as getBusStats does."""


class Slave:
    """The methods of the Slave API.

    Args:
        kill: ends a node of this name for a reason; returns whether it could.
        port: returns the port of the hub's master.
    """

    def __init__(
        self,
        graph: Graph,
        nodes: Ros1Nodes,
        topics: TopicServer,
        kill: Callable[[str, str], bool],
        port: Callable[[], int],
    ) -> None:
        self._graph = graph
        self._view = graph.view(CLIENT)
        self._nodes = nodes
        self._topics = topics
        self._kill = kill
        self._port = port

    def has(self, node: str) -> bool:
        """Return whether the hub answers for a node."""
        return self._view.node(node) is not None and node not in self._nodes.by_name

    def methods(self, node: str) -> dict[str, Method]:
        """Return the methods for a node; an empty name stands for all nodes."""
        return {
            "requestTopic": Method(self._request_topic, [], (_topic, _protocols)),
            "publisherUpdate": Method(self._ignore, 0, (_topic, api.anything)),
            "paramUpdate": Method(self._ignore, 0, (api.anything, api.anything)),
            "getPublications": Method(lambda caller, _: self._publications(node), []),
            "getSubscriptions": Method(lambda caller, _: self._subscriptions(node), []),
            "getBusInfo": Method(
                lambda caller, _: (1, "bus info", self._topics.bus_info(node)), []
            ),
            "getBusStats": Method(lambda caller, _: (1, "", self._topics.bus_stats(node)), []),
            "getMasterUri": Method(self._master_uri, ""),
            "getName": Method(lambda caller, _: (1, "", node), ""),
            "getUri": Method(
                lambda caller, _: (1, "", self._nodes.topics.hub_api(caller.hub_host, node)), ""
            ),
            "getPid": Method(lambda caller, _: (1, "", os.getpid()), -1),
            "shutdown": Method(
                lambda caller, caller_id, reason="": self._shut_down(node, caller_id, reason),
                0,
                (api.anything,),
                optional=1,
            ),
        }

    def _request_topic(
        self, caller: XmlRpcCaller, caller_id: str, topic: str, protocols: list[Any]
    ) -> Answer:
        return self._topics.request_topic(
            caller_id, topic, protocols, caller.hub_host, self._port()
        )

    def _ignore(self, caller: XmlRpcCaller, caller_id: str, *arguments: object) -> Answer:
        """Ignored: the hub has the master's knowledge itself."""
        return 1, "", 0

    def _master_uri(self, caller: XmlRpcCaller, caller_id: str) -> Answer:
        uri = self._nodes.topics.hub_api(caller.hub_host)
        return 1, uri, uri

    def _publications(self, node: str) -> Answer:
        return 1, "publications", self._listed(self._view.publishers, node)

    def _subscriptions(self, node: str) -> Answer:
        return 1, "subscriptions", self._listed(self._view.subscribers, node)

    def _listed(self, users: Callable[[Topic], Iterable[str]], node: str) -> list[Any]:
        """Return the topics that a node uses, with their types."""
        found = []
        for topic in self._view.all_topics():
            of_hub = set(users(topic)).difference(self._nodes.by_name)
            if node in of_hub or (not node and of_hub):
                found.append([topic.name, topic.type.name if topic.type is not None else ANY])
        return found

    def _shut_down(self, node: str, caller_id: str, reason: object) -> Answer:
        if not self._graph.policy.allows_all and not self._graph.policy.is_admin(CLIENT):
            return -1, f"{caller_id} may not end {node}: missing right admin", 0
        if not self._kill(node, f"{caller_id}: {reason}"):
            return 0, f"{node} is the hub's own, which ends with the hub alone", 0
        return 1, "shutdown", 0


def _protocols(value: Any, caller_id: str) -> list[Any]:
    """Check a list of protocols, each with its parameters."""
    if not value or not isinstance(value, list):
        raise api.InvalidArgument("ERROR: parameter [protocols] must be specified and non-empty")
    return value
