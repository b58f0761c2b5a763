"""What a drawing shows of the graph: without what every graph has, in the order of the flow."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, Self

DEBUG_TOPICS = frozenset({"/rosout", "/rosout_agg", "/client_count", "/connected_clients"})
"""Topics that there are in every graph, which lead from everywhere to everywhere."""
DEBUG_SERVICES = ("/get_loggers", "/set_logger_level")
"""How the services end that each node of ROS has."""
ACTION_TOPICS = ("goal", "cancel", "feedback", "status", "result")


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic with the nodes at both of its ends; ``type`` is empty as long as it has none."""

    name: str
    type: str
    checked: bool
    publishers: list[str]
    subscribers: list[str]


@dataclass(frozen=True, slots=True)
class Service:
    """A service with the node that provides it."""

    name: str
    type: str
    node: str


@dataclass(frozen=True, slots=True)
class Action:
    """An action with its server and, if that is known, those who send it goals."""

    name: str
    type: str
    node: str
    clients: list[str]


@dataclass(frozen=True, slots=True)
class View:
    """A part of the graph: all names are sorted, but for topics, which follow the flow."""

    nodes: list[str]
    topics: list[Topic]
    services: list[Service]
    actions: list[Action]
    hidden_topics: int = 0
    hidden_services: int = 0

    @classmethod
    def of(
        cls, graph: dict[str, Any], *, but: str, namespace: str = "/", everything: bool = False
    ) -> Self:
        """The view of what /rosapi/graph tells.

        Args:
            graph: the response of /rosapi/graph.
            but: the node that asks, which is no part of it.
            namespace: what is in no namespace below this, and has no part in it, is left out.
            everything: also show topics and services of the hub itself, of logging, of actions.
        """
        hub = {node["name"] for node in graph["nodes"] if node["own"]}
        topics = [_topic(each, but) for each in graph["topics"]]
        ends = {each.name: each for each in topics}
        topics = [each for each in topics if _is_within(namespace, _names(each))]
        services = [_service(each) for each in graph["services"] if each["node"] != but]
        services = [each for each in services if _is_within(namespace, (each.name, each.node))]
        actions = [_action(each, ends) for each in graph["actions"]]
        actions = [
            each for each in actions if _is_within(namespace, (each.name, each.node, *each.clients))
        ]
        nodes = {node["name"] for node in graph["nodes"]} - {but}
        hidden: set[str] = set()
        if not everything:
            nodes -= hub
            hidden |= DEBUG_TOPICS
            hidden |= {f"{each.name}/{topic}" for each in actions for topic in ACTION_TOPICS}
        shown = [each for each in topics if each.name not in hidden]
        offered = [
            each
            for each in services
            if everything or (each.node not in hub and not each.name.endswith(DEBUG_SERVICES))
        ]
        return cls(
            nodes=sorted(node for node in nodes if _is_within(namespace, (node,))),
            topics=in_order_of_flow(shown),
            services=sorted(offered, key=lambda each: each.name),
            actions=sorted(actions, key=lambda each: each.name),
            hidden_topics=len(topics) - len(shown),
            hidden_services=len(services) - len(offered),
        )

    def idle(self) -> list[str]:
        """The nodes that nothing else in the view names."""
        busy = {node for topic in self.topics for node in (*topic.publishers, *topic.subscribers)}
        busy |= {each.node for each in self.services}
        busy |= {each.node for each in self.actions}
        busy |= {node for action in self.actions for node in action.clients}
        return [node for node in self.nodes if node not in busy]

    def as_json(self) -> dict[str, Any]:
        """The nodes, topics, services and actions, fit for JSON."""
        return {
            name: value for name, value in asdict(self).items() if not name.startswith("hidden")
        }


def in_order_of_flow(topics: Iterable[Topic]) -> list[Topic]:
    """Each topic behind one that its publisher hears, as far as circles allow."""
    by_name = {topic.name: topic for topic in sorted(topics, key=lambda each: each.name)}
    heard: defaultdict[str, set[str]] = defaultdict(set)
    published: defaultdict[str, set[str]] = defaultdict(set)
    for topic in by_name.values():
        for node in topic.publishers:
            published[node].add(topic.name)
        for node in topic.subscribers:
            heard[node].add(topic.name)
    sources = [name for name, topic in by_name.items() if not any(map(heard.get, topic.publishers))]
    ordered: dict[str, Topic] = {}
    for start in (*sources, *by_name):
        ahead = [start]
        while ahead:
            name = ahead.pop()
            if name not in ordered:
                ordered[name] = by_name[name]
                behind = {
                    follower for node in by_name[name].subscribers for follower in published[node]
                }
                ahead += sorted(behind, reverse=True)
    return list(ordered.values())


def _topic(topic: dict[str, Any], but: str) -> Topic:
    publishers = {each["node"] for each in topic["publishers"]} - {but}
    subscribers = {each["node"] for each in topic["subscriptions"]} - {but}
    return Topic(
        topic["name"], topic["type"], topic["checked"], sorted(publishers), sorted(subscribers)
    )


def _service(service: dict[str, Any]) -> Service:
    return Service(service["name"], service["type"], service["node"])


def _action(action: dict[str, Any], topics: dict[str, Topic]) -> Action:
    goal = topics.get(f"{action['name']}/goal") if action["over_topics"] else None
    clients = goal.publishers if goal is not None else []
    return Action(action["name"], action["type"], action["node"], clients)


def _names(topic: Topic) -> list[str]:
    return [topic.name, *topic.publishers, *topic.subscribers]


def _is_within(namespace: str, found: Iterable[str]) -> bool:
    inner = namespace.rstrip("/") + "/"
    return any(f"{name}/".startswith(inner) for name in found)
