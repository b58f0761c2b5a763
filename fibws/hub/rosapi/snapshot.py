"""The whole graph in one answer, for those who draw it: /rosapi/graph."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from pydantic_core import to_json

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Answer, Function
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import Topic
from fibws.hub.rosapi.clients import ConnectedClients
from fibws.hub.rosapi.introspection import actions_over_topics
from fibws.hub.rosapi.kept import KeptAnswers

MOST = 2**32 - 1
"""What a uint32 holds; clients may ask for more."""
GOAL = "ActionGoal"
"""How the types of goals end that are sent over topics, behind the action's type."""


class Snapshot:
    """The nodes, topics, services and actions, each sorted by name.

    Args:
        own: the names of the hub's own nodes.
        heard: the hub's own nodes that hear a topic, by the topic's name.
        clients: tells where the other nodes are.
    """

    def __init__(
        self,
        graph: Graph,
        own: Collection[str],
        heard: Mapping[str, list[str]],
        clients: ConnectedClients,
    ) -> None:
        self._graph = graph
        self._own = own
        self._heard = heard
        self._clients = clients
        self._began = graph.now()
        self._lately = KeptAnswers(graph).lately

    def services(self) -> dict[str, tuple[str, Function]]:
        """The service by its global name, with its type and what answers it."""
        return {"/rosapi/graph": ("fibws_msgs/GetGraph", self.graph)}

    def graph(self, request: dict[str, Any], caller: str) -> Answer:
        """All that there is, and the revision of it."""
        return self._lately(self._all)

    def _all(self) -> bytes:
        graph = self._graph
        return to_json(
            {
                "revision": graph.revision,
                "nodes": self._nodes(),
                "topics": [self._topic(topic) for _, topic in sorted(graph.topics.items())],
                "services": [
                    {"name": name, "type": service.type.name, "node": service.node}
                    for name, service in sorted(graph.services.items())
                ],
                "actions": sorted(self._actions(), key=lambda action: str(action["name"])),
            }
        )

    def _nodes(self) -> list[dict[str, Any]]:
        connected = {client.name: (client.peer, since) for client, since in self._clients}
        nodes = []
        for name in sorted(self._graph.nodes):
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

    def _topic(self, topic: Topic) -> dict[str, Any]:
        subscriptions = [_subscription(node) for node in self._heard.get(topic.name, [])]
        subscriptions += [_subscription(each.node, each) for each in topic.subscriptions()]
        return {
            "name": topic.name,
            "type": topic.type.name if topic.type is not None else "",
            "checked": topic.type is not None and topic.type.checked,
            "publishers": [
                {"node": node, "latch": publisher.latch}
                for node, publisher in sorted(topic.publishers.items())
            ],
            "subscriptions": sorted(subscriptions, key=lambda each: str(each["node"])),
        }

    def _actions(self) -> Iterator[dict[str, Any]]:
        for name, action in self._graph.actions.items():
            yield _action(name, action.type.name, action.node, over_topics=False)
        for name in actions_over_topics(self._graph.topics):
            goal, status, result = (
                self._graph.topics[f"{name}/{topic}"] for topic in ("goal", "status", "result")
            )
            type_ = goal.type.name if goal.type is not None else ""
            node = min(status.publishers or result.publishers, default="")
            type_ = type_.removesuffix(GOAL) if type_.endswith(GOAL) else ""
            yield _action(name, type_, node, over_topics=True)


def _subscription(node: str, of: Subscription | None = None) -> dict[str, Any]:
    """What is told of a client's subscription, or of a part of the hub that hears a topic."""
    return {
        "node": node,
        "queue_length": min(of.queue.limit, MOST) if of is not None else 0,
        "throttle_rate": min(round(of.throttle_rate), MOST) if of is not None else 0,
        "compression": of.encoding.compression if of is not None else "none",
    }


def _action(name: str, type_: str, node: str, *, over_topics: bool) -> dict[str, Any]:
    return {"name": name, "type": type_, "node": node, "over_topics": over_topics}
