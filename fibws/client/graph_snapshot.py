"""The graph at one moment, as a tool sees it: without the tool itself."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fibws.client.hub_client import HubClient
from fibws.errors import UnknownName
from fibws.suggestions import suggestion

Entry = dict[str, Any]
"""One node, topic, service or action, with the fields of its message in fibws_msgs."""


class Snapshot:
    """What there is on a hub, sorted by name: lists of fibws_msgs/NodeInfo and so on, as dicts."""

    def __init__(self, client: HubClient) -> None:
        graph = client.call("/rosapi/graph")
        self._hub = client.url.partition("://")[2].rstrip("/")
        self.nodes: list[Entry] = _without(client.node, "name", graph["nodes"])
        self.topics: list[Entry] = [
            {
                **topic,
                "publishers": _without(client.node, "node", topic["publishers"]),
                "subscriptions": _without(client.node, "node", topic["subscriptions"]),
            }
            for topic in graph["topics"]
        ]
        self.services: list[Entry] = graph["services"]
        self.actions: list[Entry] = graph["actions"]

    def node(self, name: str) -> Entry:
        """The node of a global name; it raises `UnknownName` if there is none."""
        return _named("node", name, self.nodes)

    def topic(self, name: str) -> Entry:
        """The topic of a global name; it raises `UnknownName` if there is none."""
        return _named("topic", name, self.topics)

    def service(self, name: str) -> Entry:
        """The service of a global name; it raises `UnknownName` if there is none."""
        return _named("service", name, self.services)

    def ways(self, action: str) -> list[Entry]:
        """The action of a global name: twice if goals may go over operations and over topics.

        It raises `UnknownName` if there is none.
        """
        _named("action", action, self.actions)
        return [each for each in self.actions if each["name"] == action]

    def address(self, node: str) -> str:
        """Where a node is, ``127.0.0.1:5``; one of the hub's own is where the hub is."""
        for each in self.nodes:
            if each["name"] == node:
                return str(each["address"] or self._hub)
        return "unknown address"


def within(namespace: str | None, entries: Iterable[Entry]) -> list[Entry]:
    """Those of a global namespace, or whose name it is; all if it is None."""
    if namespace is None:
        return list(entries)
    above = namespace.rstrip("/") + "/"
    return [each for each in entries if each["name"] == namespace or each["name"].startswith(above)]


def _named(kind: str, name: str, entries: Iterable[Entry]) -> Entry:
    known = {each["name"]: each for each in entries}
    if name not in known:
        raise UnknownName(f"Unknown {kind} {name}{suggestion(name, known)}")
    return known[name]


def _without(node: str, key: str, entries: Iterable[Entry]) -> list[Entry]:
    return [each for each in entries if each[key] != node]
