"""What went over each topic, and how each client keeps up: /rosapi/statistics.

All numbers are totals. Who wants rates takes the differences of two answers, so that the hub keeps
no windows and runs no timer.
"""

from __future__ import annotations

from typing import Any

from pydantic_core import to_json

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Answer, Function
from fibws.hub.graph.topic import Topic
from fibws.hub.rosapi.clients import ConnectedClients
from fibws.hub.rosapi.kept import KeptAnswers


class Statistics:
    """The totals of every publisher, subscription and client since it came.

    Args:
        clients: those that are connected.
    """

    def __init__(self, graph: Graph, clients: ConnectedClients) -> None:
        self._graph = graph
        self._clients = clients
        self._just_now = KeptAnswers(graph).just_now

    def services(self) -> dict[str, tuple[str, Function]]:
        """The service by its global name, with its type and what answers it."""
        return {"/rosapi/statistics": ("fibws_msgs/GetStatistics", self.statistics)}

    def statistics(self, request: dict[str, Any], caller: str) -> Answer:
        """All totals, when that was, and the revision of the graph."""
        return self._just_now(self._all)

    def _all(self) -> bytes:
        secs, nsecs = divmod(self._graph.now(), 1_000_000_000)
        return to_json(
            {
                "revision": self._graph.revision,
                "stamp": {"secs": secs, "nsecs": nsecs},
                "topics": [_topic(topic) for _, topic in sorted(self._graph.topics.items())],
                "clients": self._list(),
            }
        )

    def _list(self) -> list[dict[str, Any]]:
        # Whoever was replaced, or is being closed, may still be connected.
        clients = {client.name: client for client, _ in self._clients}
        return [
            {
                "node": name,
                "address": client.peer,
                "kept_bytes": client.outbox.kept_bytes,
                "dropped": client.outbox.dropped,
                "slow": client.outbox.paused,
            }
            for name, client in sorted(clients.items())
            if name in self._graph.nodes
        ]


def _topic(topic: Topic) -> dict[str, Any]:
    return {
        "topic": topic.name,
        "publishers": [
            {"node": node, "messages": publisher.messages, "bytes": publisher.bytes}
            for node, publisher in sorted(topic.publishers.items())
        ],
        "subscriptions": [
            {"node": each.node, "messages": each.messages, "dropped": each.queue.dropped}
            for each in sorted(topic.subscriptions(), key=lambda each: each.node)
        ],
    }
