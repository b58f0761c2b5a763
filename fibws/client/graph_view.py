"""The part of the graph that `fibws graph` draws and `fibws doctor` checks."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Self

from fibws.client.graph_snapshot import conflict_text

HIDDEN_NAMES = frozenset(
    {
        *("/rosout", "/rosout_agg", "/rosapi", "/rosbridge_websocket"),
        *("/client_count", "/connected_clients", "/statistics"),
    }
)
HIDDEN_PREFIXES = ("/rosapi/", "/rosout/", "/rosbridge_websocket/", "/page_")
HIDDEN_SUFFIXES = ("/get_loggers", "/set_logger_level")
TOOL = re.compile(r"/(\w+/)*fibws_(?!(echo|pub|hz|bw|delay)_)[a-z]+_\d+_\d+")
"""The nodes of fibws's commands; those of `fibws topic` publish and subscribe as rostopic's do."""
OTHER_LOGS = re.compile(r"/(\w+/)+rosout(/.*)?")
"""The logs of hubs that have joined with a prefix, and the nodes of hubs that read logs."""
ACTION_TOPICS = ("goal", "cancel", "feedback", "status", "result")


def is_hidden(name: str) -> bool:
    """Return whether a node, topic or service belongs to the hub, to its page or to a command.

    The page hides the same names: `web/src/hidden_names.ts`.
    """
    return (
        name in HIDDEN_NAMES
        or name.startswith(HIDDEN_PREFIXES)
        or name.endswith(HIDDEN_SUFFIXES)
        or TOOL.fullmatch(name) is not None
        or OTHER_LOGS.fullmatch(name) is not None
    )


@dataclass(frozen=True, slots=True)
class DrawnTopic:
    """A topic with its publishers and subscribers; ``type`` is empty if it is unknown."""

    name: str
    type: str
    checked: bool
    publishers: list[str]
    subscribers: list[str]


@dataclass(frozen=True, slots=True)
class DrawnConflict:
    """A node that uses a topic with another type, or otherwise as the hub cannot."""

    node: str
    topic: str
    publishes: bool
    text: str
    """The words for the node's use of the topic, and for the fault."""


@dataclass(frozen=True, slots=True)
class DrawnService:
    """A service with its server."""

    name: str
    type: str
    node: str


@dataclass(frozen=True, slots=True)
class DrawnAction:
    """An action with its server and, if they are known, its clients."""

    name: str
    type: str
    node: str
    clients: list[str]


@dataclass(frozen=True, slots=True)
class View:
    """A part of the graph: topics follow the flow of messages, other names are sorted."""

    nodes: list[str]
    topics: list[DrawnTopic]
    services: list[DrawnService]
    actions: list[DrawnAction]
    hidden_nodes: int = 0
    hidden_topics: int = 0
    hidden_services: int = 0
    conflicts: list[DrawnConflict] = field(default_factory=list)
    unreachable: dict[str, str] = field(default_factory=dict)
    """Why ROS 1 nodes do not answer, by their names."""

    @classmethod
    def of(
        cls, graph: dict[str, Any], *, exclude: str, namespace: str = "/", everything: bool = False
    ) -> Self:
        """Return a view of the response of /rosapi/graph.

        Args:
            graph: the response.
            exclude: the node that requested it.
            namespace: show names in this namespace and what is connected to them.
            everything: include hidden names, and the topics of actions.
        """
        hidden = {each["name"] for each in graph["nodes"] if each["own"] or is_hidden(each["name"])}
        all_topics = [_topic(each, exclude) for each in graph["topics"]]
        by_name = {each.name: each for each in all_topics}
        all_topics = [each for each in all_topics if _is_within(namespace, _names(each))]
        all_services = [
            DrawnService(each["name"], each["type"], each["node"])
            for each in graph["services"]
            if each["node"] != exclude and _is_within(namespace, (each["name"], each["node"]))
        ]
        actions = [_action(each, by_name) for each in graph["actions"]]
        actions = [
            each for each in actions if _is_within(namespace, (each.name, each.node, *each.clients))
        ]
        all_nodes = {each["name"] for each in graph["nodes"]} - {exclude}
        all_nodes = {each for each in all_nodes if _is_within(namespace, (each,))}
        nodes, topics, services = all_nodes, all_topics, all_services
        if not everything:
            nodes = all_nodes - hidden
            of_actions = {f"{each.name}/{topic}" for each in actions for topic in ACTION_TOPICS}
            topics = [
                _without(each, hidden)
                for each in all_topics
                if not is_hidden(each.name)
                and each.name not in of_actions
                and not _is_only_used_by(each, hidden)
            ]
            actions = [
                replace(each, clients=[node for node in each.clients if node not in hidden])
                for each in actions
            ]
            services = [
                each
                for each in all_services
                if each.node not in hidden and not is_hidden(each.name)
            ]
        shown = {each.name for each in topics}
        conflicts = [
            DrawnConflict(
                each["node"], topic["name"], each["publishes"], conflict_text(each, topic)
            )
            for topic in graph["topics"]
            for each in topic["conflicts"]
            if topic["name"] in shown and each["node"] in nodes
        ]
        unreachable = {
            each["name"]: each["fault"]
            for each in graph["nodes"]
            if each["fault"] and each["name"] in nodes
        }
        return cls(
            nodes=sorted(nodes),
            topics=in_order_of_flow(topics),
            services=sorted(services, key=lambda each: each.name),
            actions=sorted(actions, key=lambda each: each.name),
            hidden_nodes=len(all_nodes) - len(nodes),
            hidden_topics=len(all_topics) - len(topics),
            hidden_services=len(all_services) - len(services),
            conflicts=conflicts,
            unreachable=unreachable,
        )

    def idle(self) -> list[str]:
        """Return the nodes without topics, services and actions in the view."""
        busy = {node for topic in self.topics for node in (*topic.publishers, *topic.subscribers)}
        busy |= {each.node for each in self.services}
        busy |= {each.node for each in self.actions}
        busy |= {node for action in self.actions for node in action.clients}
        busy |= {each.node for each in self.conflicts}
        return [node for node in self.nodes if node not in busy]

    def as_json(self) -> dict[str, Any]:
        """Return the nodes, topics, services and actions for JSON."""
        return {
            name: value for name, value in asdict(self).items() if not name.startswith("hidden")
        }


def in_order_of_flow(topics: Iterable[DrawnTopic]) -> list[DrawnTopic]:
    """Return topics in an order in which, apart from cycles, messages flow from first to last."""
    by_name = {topic.name: topic for topic in sorted(topics, key=lambda each: each.name)}
    subscribed: defaultdict[str, set[str]] = defaultdict(set)
    published: defaultdict[str, set[str]] = defaultdict(set)
    for topic in by_name.values():
        for node in topic.publishers:
            published[node].add(topic.name)
        for node in topic.subscribers:
            subscribed[node].add(topic.name)
    sources = [
        name for name, topic in by_name.items() if not any(map(subscribed.get, topic.publishers))
    ]
    ordered: dict[str, DrawnTopic] = {}
    for start in (*sources, *by_name):
        ahead = [start]
        while ahead:
            name = ahead.pop()
            if name not in ordered:
                ordered[name] = by_name[name]
                following = {
                    topic for node in by_name[name].subscribers for topic in published[node]
                }
                ahead += sorted(following, reverse=True)
    return list(ordered.values())


def _topic(topic: dict[str, Any], exclude: str) -> DrawnTopic:
    publishers = {each["node"] for each in topic["publishers"]} - {exclude}
    subscribers = {each["node"] for each in topic["subscriptions"]} - {exclude}
    return DrawnTopic(
        topic["name"], topic["type"], topic["checked"], sorted(publishers), sorted(subscribers)
    )


def _action(action: dict[str, Any], topics: dict[str, DrawnTopic]) -> DrawnAction:
    goal = topics.get(f"{action['name']}/goal") if action["over_topics"] else None
    clients = goal.publishers if goal is not None else []
    return DrawnAction(action["name"], action["type"], action["node"], clients)


def _names(topic: DrawnTopic) -> list[str]:
    return [topic.name, *topic.publishers, *topic.subscribers]


def _is_within(namespace: str, names: Iterable[str]) -> bool:
    inner = namespace.rstrip("/") + "/"
    return any(f"{name}/".startswith(inner) for name in names)


def _without(topic: DrawnTopic, nodes: set[str]) -> DrawnTopic:
    """Return a topic without nodes at its ends."""
    publishers = [each for each in topic.publishers if each not in nodes]
    subscribers = [each for each in topic.subscribers if each not in nodes]
    return replace(topic, publishers=publishers, subscribers=subscribers)


def _is_only_used_by(topic: DrawnTopic, nodes: set[str]) -> bool:
    used_by = {*topic.publishers, *topic.subscribers}
    return bool(used_by) and used_by <= nodes
