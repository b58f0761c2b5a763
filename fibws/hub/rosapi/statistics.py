"""Totals of messages, bytes and drops of each topic and client: /rosapi/statistics.

All numbers are totals. Programs that want rates take the difference of two responses, so that the
hub keeps no windows and runs no timer.
"""

from __future__ import annotations

from typing import Any

from pydantic_core import to_json

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Function, Response
from fibws.hub.graph.topic import Sink, Topic
from fibws.hub.graph.view import GraphView
from fibws.hub.rosapi.cache import ResponseCache, Views
from fibws.hub.rosapi.clients import ConnectedClients, ListedClient


class Statistics:
    """The totals of every publisher, subscription and client.

    Args:
        clients: those that are connected.
    """

    def __init__(self, graph: Graph, clients: ConnectedClients) -> None:
        self._graph = graph
        self._clients = clients
        self._cached = ResponseCache(graph).get_recent
        self._topics = Views(graph, lambda caller: graph.view(caller).all_topics())
        self._nodes = Views(graph, lambda caller: graph.view(caller).nodes())

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return the service by its global name, with its type and handler."""
        return {"/rosapi/statistics": ("fibws_msgs/GetStatistics", self.statistics)}

    def statistics(self, request: dict[str, Any], caller: str) -> Response:
        """Return all totals, the time, and the revision of the graph."""
        return self._cached(self._all, caller)

    def _all(self, caller: str) -> bytes:
        graph, view = self._graph, self._graph.view(caller)
        secs, nsecs = divmod(graph.now(), 1_000_000_000)
        return to_json(
            {
                "revision": graph.revision,
                "stamp": {"secs": secs, "nsecs": nsecs},
                "topics": [_topic(each, view) for each in self._topics.get(caller)],
                "clients": self._list(caller),
            }
        )

    def _list(self, caller: str) -> list[dict[str, Any]]:
        # A client that was replaced, or is being closed, may still be connected.
        view = self._graph.view(caller)
        clients = {client.name: (client, since) for client, since in self._clients}
        return [
            _client(name, *clients[name], shown=view.sees_address(name))
            for name in self._nodes.get(caller)
            if name in clients
        ]


def _client(name: str, client: ListedClient, since: int, *, shown: bool) -> dict[str, Any]:
    """Return a client's totals.

    Args:
        since: when it connected, in nanoseconds since 1970.
        shown: whether to say where and who it is.
    """
    queue = client.queue
    principal = client.principal.title if shown and client.principal is not None else ""
    secs, nsecs = divmod(since, 1_000_000_000)
    return {
        "node": name,
        "address": client.peer if shown else "",
        "principal": principal,
        "protocol": client.protocol,
        "since": {"secs": secs, "nsecs": nsecs},
        "messages_received": client.messages_received,
        "bytes_received": client.bytes_received,
        "messages_sent": queue.messages_sent,
        "bytes_sent": queue.bytes_sent,
        "kept_bytes": queue.kept_bytes,
        "dropped": queue.dropped,
        "limited": client.limited,
        "subscriptions": client.registrations("subscriptions"),
        "advertisements": client.registrations("advertisements"),
        "slow": queue.paused,
    }


def _topic(topic: Topic, view: GraphView) -> dict[str, Any]:
    """Return the totals of a topic's publishers and subscriptions."""
    return {
        "topic": topic.name,
        "publishers": [
            {"node": each.node, "messages": each.messages, "bytes": each.bytes}
            for each in view.sources(topic)
        ],
        "subscriptions": [_subscription(sink) for sink in view.sinks(topic)],
    }


def _subscription(sink: Sink) -> dict[str, Any]:
    report = sink.report()
    return {
        "node": sink.node,
        "messages": report.messages,
        "dropped": report.dropped,
        "throttled": report.throttled,
    }
