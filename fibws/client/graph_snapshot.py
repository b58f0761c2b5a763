"""The graph at one moment, without the tool itself."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fibws.client.hub_client import HubClient
from fibws.errors import UnknownName
from fibws.suggestions import suggestion

Entry = dict[str, Any]
"""A node, topic, service or action, with the fields of its message in fibws_msgs."""

OTHER_FIELDS = "with other fields"
"""In the fault of a conflict between two definitions of one type."""


class GraphSnapshot:
    """The nodes, topics, services and actions on a hub, each sorted by name."""

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
        """Return the node of a global name; raise `UnknownName` if there is none."""
        return _find("node", name, self.nodes)[0]

    def topic(self, name: str) -> Entry:
        """Return the topic of a global name; raise `UnknownName` if there is none."""
        return _find("topic", name, self.topics)[0]

    def service(self, name: str) -> Entry:
        """Return the service of a global name; raise `UnknownName` if there is none."""
        return _find("service", name, self.services)[0]

    def actions_named(self, name: str) -> list[Entry]:
        """Return the action of a global name: two entries if it is over topics and operations.

        Raises:
            UnknownName: there is no such action.
        """
        return _find("action", name, self.actions)

    def address(self, node: str) -> str:
        """Return a node's address, ``127.0.0.1:5``: the hub's for the hub's own nodes.

        That of a ROS 1 node is a URI, as ROS's tools print it: ``http://robot:5/``; for a node of
        another hub it is ``hub NAME``.
        """
        for each in self.nodes:
            if each["name"] == node:
                if each["hub"]:
                    return f"hub {each['hub']}"
                return str(each["api"] or each["address"] or self._hub)
        return "unknown address"


def conflict_text(conflict: Entry, topic: Entry) -> str:
    """Return what a node in conflict does at a topic, and why no messages pass; not its name.

    Args:
        conflict: an entry of the topic's conflicts.
        topic: an entry of `GraphSnapshot.topics`.
    """
    verb = "publishes" if conflict["publishes"] else "subscribes to"
    if is_of_other_type(conflict, topic):
        return f"{verb} {conflict['type']}, the topic is {topic['type']}"
    return f"{verb} {conflict['type']}: {conflict['fault']}"


def is_of_other_type(conflict: Entry, topic: Entry) -> bool:
    """Return whether it is the type that keeps messages from passing, not a missing right."""
    return bool(topic["type"]) and conflict["type"] != topic["type"]


def in_namespace(namespace: str | None, entries: Iterable[Entry]) -> list[Entry]:
    """Return the entries in a global namespace or of its name; all of them if it is None."""
    if namespace is None:
        return list(entries)
    above = namespace.rstrip("/") + "/"
    return [each for each in entries if each["name"] == namespace or each["name"].startswith(above)]


def _find(kind: str, name: str, entries: list[Entry]) -> list[Entry]:
    found = [each for each in entries if each["name"] == name]
    if not found:
        names = [each["name"] for each in entries]
        raise UnknownName(f"Unknown {kind} {name}{suggestion(name, names)}")
    return found


def _without(node: str, key: str, entries: Iterable[Entry]) -> list[Entry]:
    return [each for each in entries if each[key] != node]
