"""The whole graph in one response, for programs that draw it: /rosapi/graph and /rosapi/hubs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any
from urllib.parse import urlsplit

from pydantic_core import to_json

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.nodes import ExternalNode, NodeOfHub, NodeOfLink
from fibws.hub.graph.service import Function, Response
from fibws.hub.graph.topic import Sink, Topic
from fibws.hub.graph.view import GraphView
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
        clients: the other nodes' connections.
        hubs: returns the other hubs for a caller, as a fibws_msgs/GetHubs response.
    """

    def __init__(
        self,
        graph: Graph,
        clients: ConnectedClients,
        hubs: Callable[[str], dict[str, Any]],
    ) -> None:
        self._graph = graph
        self._clients = clients
        self._hubs = hubs
        self._began = graph.now()
        self._cached = ResponseCache(graph).get_lately

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return the services by their global names, each with its type and handler."""
        return {
            "/rosapi/graph": ("fibws_msgs/GetGraph", self.graph),
            "/rosapi/hubs": ("fibws_msgs/GetHubs", self.hubs),
        }

    def hubs(self, request: dict[str, Any], caller: str) -> Response:
        """Return the links to other hubs, and all hubs that are known."""
        return self._hubs(caller)

    def graph(self, request: dict[str, Any], caller: str) -> Response:
        """Return everything that the caller may see, and the revision of the graph."""
        return self._cached(self._all, caller)

    def _all(self, caller: str) -> bytes:
        view = self._graph.view(caller)
        topics = view.all_topics()
        return to_json(
            {
                "revision": self._graph.revision,
                "nodes": self._nodes(view),
                "topics": [_topic(each, view) for each in topics],
                "services": [
                    {"name": each.name, "type": each.type.name, "node": each.node}
                    for each in view.all_services()
                ],
                "actions": sorted(_actions(view, topics), key=lambda each: str(each["name"])),
            }
        )

    def _nodes(self, view: GraphView) -> list[dict[str, Any]]:
        connected = {client.name: (client.peer, since) for client, since in self._clients}
        nodes = []
        for name, node in view.all_nodes():
            address, since = connected.get(name, ("", self._began))
            api = fault = hub = ""
            if isinstance(node, ExternalNode):
                api, fault, since = node.api, node.fault, node.since
                address = urlsplit(api).netloc
            elif isinstance(node, NodeOfHub):
                hub, since = node.hub_name, node.since
            is_visible = view.sees_address(name)
            secs, nsecs = divmod(since, 1_000_000_000)
            nodes.append(
                {
                    "name": name,
                    "address": address if is_visible else "",
                    "since": {"secs": secs, "nsecs": nsecs},
                    "own": name in self._graph.rights.internal or isinstance(node, NodeOfLink),
                    "api": api if is_visible else "",
                    "fault": fault if is_visible else "",
                    "hub": hub,
                }
            )
        return nodes


def _topic(topic: Topic, view: GraphView) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type.name if topic.type is not None else "",
        "checked": topic.type is not None and topic.type.checked,
        "publishers": [{"node": each.node, "latch": each.latch} for each in view.sources(topic)],
        "subscriptions": [_subscription(sink) for sink in view.sinks(topic)],
        "conflicts": [each._asdict() for each in view.conflicts(topic)],
    }


def _actions(view: GraphView, topics: list[Topic]) -> Iterator[dict[str, Any]]:
    for action in view.all_actions():
        yield _action(action.name, action.type.name, action.node, over_topics=False)
    by_name = {each.name: each for each in topics}
    for name in actions_over_topics(by_name):
        goal, status, result = (by_name[f"{name}/{each}"] for each in ("goal", "status", "result"))
        type_ = goal.type.name if goal.type is not None else ""
        node = min(view.publishers(status) or view.publishers(result), default="")
        type_ = type_.removesuffix(GOAL) if type_.endswith(GOAL) else ""
        yield _action(name, type_, node, over_topics=True)


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
