"""The whole graph in one response, for programs that draw it: /rosapi/graph."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

from pydantic_core import to_json

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Function, Response
from fibws.hub.graph.topic import Sink, Topic
from fibws.hub.rosapi.cache import ResponseCache
from fibws.hub.rosapi.clients import ConnectedClients
from fibws.hub.rosapi.introspection import actions_over_topics

MOST = 2**32 - 1
"""The largest uint32; clients may ask for more."""
GOAL = "ActionGoal"
"""How the types of goals end that are sent over topics, behind the action's type."""


class Snapshot:
    """The nodes, topics, services and actions, each sorted by name.

    Args:
        own: the names of the hub's own nodes.
        clients: the other nodes' connections.
    """

    def __init__(self, graph: Graph, own: Collection[str], clients: ConnectedClients) -> None:
        self._graph = graph
        self._own = own
        self._clients = clients
        self._began = graph.now()
        self._cached = ResponseCache(graph).get_lately

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return the service by its global name, with its type and handler."""
        return {"/rosapi/graph": ("fibws_msgs/GetGraph", self.graph)}

    def graph(self, request: dict[str, Any], caller: str) -> Response:
        """Return everything that the caller may list, and the revision of the graph."""
        return self._cached(self._all, caller)

    def _all(self, caller: str) -> bytes:
        graph = self._graph
        return to_json(
            {
                "revision": graph.revision,
                "nodes": self._nodes(caller),
                "topics": [
                    self._topic(graph.topics[name], caller)
                    for name in graph.listed(caller, graph.topics)
                ],
                "services": [
                    {
                        "name": name,
                        "type": graph.services[name].type.name,
                        "node": self._node(graph.services[name].node, caller),
                    }
                    for name in graph.listed(caller, graph.services)
                ],
                "actions": sorted(self._actions(caller), key=lambda action: str(action["name"])),
            }
        )

    def _nodes(self, caller: str) -> list[dict[str, Any]]:
        connected = {client.name: (client.peer, since) for client, since in self._clients}
        nodes = []
        for name in self._graph.listed(caller, self._graph.nodes):
            address, since = connected.get(name, ("", self._began))
            secs, nsecs = divmod(since, 1_000_000_000)
            nodes.append(
                {
                    "name": name,
                    "address": address,
                    "since": {"secs": secs, "nsecs": nsecs},
                    "own": name in self._own,
                }
            )
        return nodes

    def _topic(self, topic: Topic, caller: str) -> dict[str, Any]:
        may_list = self._graph.may_list
        sinks = sorted(topic.sinks(), key=lambda sink: sink.node)
        return {
            "name": topic.name,
            "type": topic.type.name if topic.type is not None else "",
            "checked": topic.type is not None and topic.type.checked,
            "publishers": [
                {"node": node, "latch": topic.sources[node].latch}
                for node in self._graph.listed(caller, topic.sources)
            ],
            "subscriptions": [_subscription(sink) for sink in sinks if may_list(caller, sink.node)],
        }

    def _node(self, name: str, caller: str) -> str:
        """Return a node's name, or an empty string if the caller may not list it."""
        return name if self._graph.may_list(caller, name) else ""

    def _actions(self, caller: str) -> Iterator[dict[str, Any]]:
        graph = self._graph
        for name in graph.listed(caller, graph.actions):
            action = graph.actions[name]
            node = self._node(action.node, caller)
            yield _action(name, action.type.name, node, over_topics=False)
        topics = graph.listed(caller, graph.topics)
        for name in graph.listed(caller, actions_over_topics(topics)):
            goal, status, result = (
                graph.topics[f"{name}/{topic}"] for topic in ("goal", "status", "result")
            )
            type_ = goal.type.name if goal.type is not None else ""
            node = min(status.sources or result.sources, default="")
            type_ = type_.removesuffix(GOAL) if type_.endswith(GOAL) else ""
            yield _action(name, type_, self._node(node, caller), over_topics=True)


def _subscription(sink: Sink) -> dict[str, Any]:
    report = sink.report()
    return {
        "node": sink.node,
        "queue_length": min(report.queue_length, MOST),
        "throttle_rate": min(round(report.throttle_rate), MOST),
        "compression": report.encoding,
    }


def _action(name: str, type_: str, node: str, *, over_topics: bool) -> dict[str, Any]:
    return {"name": name, "type": type_, "node": node, "over_topics": over_topics}
