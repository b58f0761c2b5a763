"""What there is in the graph, as rosapi tells it: its topics, nodes, services, actions, and time.

Some of these services are asked every few seconds by every open page. Their answers are kept as
JSON text until the graph changes, and the text of a type for as long as there is room.
"""

from __future__ import annotations

import logging
from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic_core import to_json

from fibws import names
from fibws.errors import InterfaceError, InvalidName, InvalidTypeName
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Answer, Function
from fibws.hub.logtext import is_power_of_ten
from fibws.hub.rosapi.kept import KeptAnswers
from fibws.hub.rosapi.texts import Texts

logger = logging.getLogger("fibws.hub")

HOST = "127.0.0.1"
"""Where all services are: their callers reach them by the hub."""
MOST_TEXT = 2**23
"""Bytes that the full texts of all topics' types may have in one answer: half of what the hub keeps
for a client that falls behind."""
ACTION_TOPICS = frozenset({"goal", "cancel", "feedback", "status", "result"})
"""The topics in the namespace of an actionlib server."""

_NO_TEXT = b'""'


class Introspection:
    """The services that tell what there is.

    Names in a request may be relative to the caller. What there is not has no type, no node and no
    host, which are empty texts then, and nothing in its lists.

    Args:
        heard: the hub's own nodes that hear a topic, by the topic's name.
    """

    def __init__(self, graph: Graph, heard: Mapping[str, list[str]]) -> None:
        self._graph = graph
        self._heard = heard
        self._full_texts = Texts(lambda name: to_json(graph.interfaces.full_text(name)))
        self._kept = KeptAnswers(graph).of
        self._times_too_long = 0

    def services(self) -> dict[str, tuple[str, Function]]:
        """All by their global names, each with its type and what answers it."""
        return {
            "/rosapi/topics": ("rosapi/Topics", self.topics),
            "/rosapi/topics_for_type": ("rosapi/TopicsForType", self.topics_for_type),
            "/rosapi/topics_and_raw_types": ("rosapi/TopicsAndRawTypes", self.topics_and_raw_types),
            "/rosapi/topic_type": ("rosapi/TopicType", self.topic_type),
            "/rosapi/publishers": ("rosapi/Publishers", self.publishers),
            "/rosapi/subscribers": ("rosapi/Subscribers", self.subscribers),
            "/rosapi/services": ("rosapi/Services", self.service_names),
            "/rosapi/services_for_type": ("rosapi/ServicesForType", self.services_for_type),
            "/rosapi/service_type": ("rosapi/ServiceType", self.service_type),
            "/rosapi/service_node": ("rosapi/ServiceNode", self.service_node),
            "/rosapi/service_host": ("rosapi/ServiceHost", self.service_host),
            "/rosapi/service_providers": ("rosapi/ServiceProviders", self.service_providers),
            "/rosapi/nodes": ("rosapi/Nodes", self.nodes),
            "/rosapi/node_details": ("rosapi/NodeDetails", self.node_details),
            "/rosapi/action_servers": ("rosapi/GetActionServers", self.action_servers),
            "/rosapi/get_time": ("rosapi/GetTime", self.get_time),
        }

    def get_time(self, request: dict[str, Any], caller: str) -> Answer:
        """The time of the hub's clock, counted from 1970."""
        secs, nsecs = divmod(self._graph.now(), 1_000_000_000)
        return {"time": {"secs": secs, "nsecs": nsecs}}

    # Topics.

    def topics(self, request: dict[str, Any], caller: str) -> Answer:
        """All topics, published or subscribed to, with their types."""
        return self._kept(self._topics)

    def topics_and_raw_types(self, request: dict[str, Any], caller: str) -> Answer:
        """All topics with their types and the full texts of these, as genmsg writes them."""
        return self._kept(self._topics_and_raw_types)

    def topics_for_type(self, request: dict[str, Any], caller: str) -> Answer:
        """The topics of a type."""
        wanted = self._canonical(request["type"])
        topics = self._graph.topics.values()
        found = (each.name for each in topics if each.type is not None and each.type.name == wanted)
        return {"topics": sorted(found)}

    def topic_type(self, request: dict[str, Any], caller: str) -> Answer:
        """The type of a topic."""
        topic = self._graph.topics.get(global_name(request["topic"], caller))
        return {"type": topic.type.name if topic is not None and topic.type is not None else ""}

    def publishers(self, request: dict[str, Any], caller: str) -> Answer:
        """The nodes that publish a topic."""
        topic = self._graph.topics.get(global_name(request["topic"], caller))
        return {"publishers": sorted(topic.publishers) if topic is not None else []}

    def subscribers(self, request: dict[str, Any], caller: str) -> Answer:
        """The nodes that subscribe to a topic."""
        name = global_name(request["topic"], caller)
        topic = self._graph.topics.get(name)
        nodes = set(self._heard.get(name, []))
        if topic is not None:
            nodes.update(subscription.node for subscription in topic.subscriptions())
        return {"subscribers": sorted(nodes)}

    # Services.

    def service_names(self, request: dict[str, Any], caller: str) -> Answer:
        """All services."""
        return self._kept(self._services)

    def services_for_type(self, request: dict[str, Any], caller: str) -> Answer:
        """The services of a type."""
        wanted = self._canonical(request["type"])
        services = self._graph.services.values()
        return {"services": sorted(each.name for each in services if each.type.name == wanted)}

    def service_providers(self, request: dict[str, Any], caller: str) -> Answer:
        """The nodes that provide services of a type, which the request calls the service."""
        wanted = self._canonical(request["service"])
        services = self._graph.services.values()
        return {"providers": sorted({each.node for each in services if each.type.name == wanted})}

    def service_type(self, request: dict[str, Any], caller: str) -> Answer:
        """The type of a service."""
        service = self._graph.services.get(global_name(request["service"], caller))
        return {"type": service.type.name if service is not None else ""}

    def service_node(self, request: dict[str, Any], caller: str) -> Answer:
        """The node that provides a service."""
        service = self._graph.services.get(global_name(request["service"], caller))
        return {"node": service.node if service is not None else ""}

    def service_host(self, request: dict[str, Any], caller: str) -> Answer:
        """The host of a service."""
        known = global_name(request["service"], caller) in self._graph.services
        return {"host": HOST if known else ""}

    # Nodes and actions.

    def nodes(self, request: dict[str, Any], caller: str) -> Answer:
        """All nodes."""
        return self._kept(self._nodes)

    def node_details(self, request: dict[str, Any], caller: str) -> Answer:
        """The topics and services of a node."""
        node = self._graph.nodes.get(global_name(request["node"], caller))
        if node is None:
            return {"subscribing": [], "publishing": [], "services": []}
        return {
            "subscribing": sorted(node.subscribing()),
            "publishing": sorted(node.publishing()),
            "services": sorted(node.providing()),
        }

    def action_servers(self, request: dict[str, Any], caller: str) -> Answer:
        """All actions: those by themselves, as in ROS 2, and those that are topics, as in ROS 1."""
        return self._kept(self._action_servers)

    # The answers that are kept.

    def _topics(self) -> bytes:
        pairs = self._types_of_topics()
        return to_json(
            {"topics": [name for name, _ in pairs], "types": [type_ for _, type_ in pairs]}
        )

    def _topics_and_raw_types(self) -> bytes:
        texts, room = [], MOST_TEXT
        for _, type_ in self._types_of_topics():
            # Once there is no room left, no more texts are made.
            text = self._full_text(type_) if room >= 0 else _NO_TEXT
            room -= len(text)
            texts.append(text if room >= 0 else _NO_TEXT)
        if room < 0:
            self._times_too_long += 1
            if is_power_of_ten(self._times_too_long):
                logger.warning("The types of all topics have more text than rosapi will tell.")
        return b'%b,"typedefs_full_text":[%b]}' % (self._kept(self._topics)[:-1], b",".join(texts))

    def _services(self) -> bytes:
        return to_json({"services": sorted(self._graph.services)})

    def _nodes(self) -> bytes:
        return to_json({"nodes": sorted(self._graph.nodes)})

    def _action_servers(self) -> bytes:
        servers = actions_over_topics(self._graph.topics) | self._graph.actions.keys()
        return to_json({"action_servers": sorted(servers)})

    def _types_of_topics(self) -> list[tuple[str, str]]:
        """All topics, sorted, each with its type's name, which is empty if it has none."""
        return sorted(
            (name, topic.type.name if topic.type is not None else "")
            for name, topic in self._graph.topics.items()
        )

    def _full_text(self, type_: str) -> bytes:
        """The full text of a type as JSON, which is empty if nobody knows it."""
        try:
            return self._full_texts.of(type_) if type_ else _NO_TEXT
        except InterfaceError:
            return _NO_TEXT

    def _canonical(self, type_: str) -> str | None:
        """The type's name as the graph has it, if it is one."""
        try:
            return self._graph.interfaces.canonical(type_)
        except InvalidTypeName:
            return None


def actions_over_topics(topics: Iterable[str]) -> set[str]:
    """The actions that are topics, as in ROS 1: the namespaces that hold all five of these."""
    found: defaultdict[str, set[str]] = defaultdict(set)
    for name in topics:
        namespace, _, topic = name.rpartition("/")
        if topic in ACTION_TOPICS:
            found[namespace].add(topic)
    servers = {namespace for namespace, held in found.items() if held >= ACTION_TOPICS}
    # Topics such as /goal are in no namespace, and so of no action.
    return servers - {""}


def global_name(name: str, caller: str) -> str:
    """The name that the caller means; what is no name stays so, and is nobody's."""
    try:
        return names.resolve(name, node=caller)
    except InvalidName:
        return name
