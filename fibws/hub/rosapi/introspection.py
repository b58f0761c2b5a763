"""rosapi's lists of topics, nodes, services and actions, and the time.

Every open page asks some of these services every few seconds. Their responses are cached as JSON
until the graph changes, and the text of a type for as long as there is room.
"""

from __future__ import annotations

import logging
from collections import defaultdict
from collections.abc import Iterable
from typing import Any

from pydantic_core import to_json

from fibws.errors import InterfaceError, InvalidName, InvalidTypeName
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Function, Response, Service
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.types import MessageType
from fibws.hub.log.text import is_power_of_ten
from fibws.hub.rosapi.cache import ResponseCache, TextCache
from fibws.interfaces import Interfaces

logger = logging.getLogger("fibws.hub")

HOST = "127.0.0.1"
"""The host of all services: their callers reach them through the hub."""
MOST_TEXT = 2**23
"""Bytes that the full texts of all topics' types may have in one response: half of what the hub
keeps for a client that falls behind."""
ACTION_TOPICS = frozenset({"goal", "cancel", "feedback", "status", "result"})
"""The topics in the namespace of an actionlib server."""

GOAL_SUFFIX = "ActionGoal"
"""How the type of an actionlib server's goals ends, which begins with the action's type."""

_NO_TEXT = b'""'


class Introspection:
    """The services that list the graph.

    Names in a request may be relative to the caller. Unknown names give empty strings and lists,
    and so do those that the policy hides from the caller.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._full_texts = TextCache(lambda known, name: to_json(known.full_text(name)))
        self._cached = ResponseCache(graph).get
        self._times_too_long = 0

    def services(self) -> dict[str, tuple[str, Function]]:
        """Return all services by their global names, each with its type and handler."""
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
            "/rosapi/action_type": ("rosapi/ActionType", self.action_type),
            "/rosapi/interfaces": ("rosapi/Interfaces", self.interfaces),
            "/rosapi/get_time": ("rosapi/GetTime", self.get_time),
        }

    def get_time(self, request: dict[str, Any], caller: str) -> Response:
        """Return the time of the graph: counted from 1970, unless it is simulated."""
        secs, nsecs = divmod(self._graph.clock.now(), 1_000_000_000)
        return {"time": {"secs": secs, "nsecs": nsecs}}

    # Topics.

    def topics(self, request: dict[str, Any], caller: str) -> Response:
        """Return all topics, published or subscribed to, with their types."""
        return self._cached(self._topics, caller)

    def topics_and_raw_types(self, request: dict[str, Any], caller: str) -> Response:
        """Return all topics with their types and the full texts of these, as genmsg writes them."""
        return self._cached(self._topics_and_raw_types, caller)

    def topics_for_type(self, request: dict[str, Any], caller: str) -> Response:
        """Return the topics of a type."""
        wanted = self._canonical(request["type"])
        found = self._types_of_topics(caller)
        return {"topics": [name for name, type_ in found if type_ == wanted]}

    def topic_type(self, request: dict[str, Any], caller: str) -> Response:
        """Return the type of a topic."""
        topic = self._topic(request["topic"], caller)
        return {"type": topic.type.name if topic is not None and topic.type is not None else ""}

    def publishers(self, request: dict[str, Any], caller: str) -> Response:
        """Return the nodes that publish on a topic."""
        topic = self._topic(request["topic"], caller)
        publishers = self._graph.view(caller).publishers(topic) if topic is not None else ()
        return {"publishers": sorted(publishers)}

    def subscribers(self, request: dict[str, Any], caller: str) -> Response:
        """Return the nodes that subscribe to a topic."""
        topic = self._topic(request["topic"], caller)
        subscribers = self._graph.view(caller).subscribers(topic) if topic is not None else ()
        return {"subscribers": sorted(subscribers)}

    # Services.

    def service_names(self, request: dict[str, Any], caller: str) -> Response:
        """Return all services."""
        return self._cached(self._services, caller)

    def services_for_type(self, request: dict[str, Any], caller: str) -> Response:
        """Return the services of a type."""
        wanted = self._canonical(request["type"])
        return {"services": [each.name for each in self._of_type(wanted, caller)]}

    def service_providers(self, request: dict[str, Any], caller: str) -> Response:
        """Return the nodes that serve a type, which the request calls the service."""
        wanted = self._canonical(request["service"])
        return {"providers": sorted({each.node for each in self._of_type(wanted, caller)})}

    def service_type(self, request: dict[str, Any], caller: str) -> Response:
        """Return the type of a service."""
        service = self._service(request["service"], caller)
        return {"type": service.type.name if service is not None else ""}

    def service_node(self, request: dict[str, Any], caller: str) -> Response:
        """Return the node that serves a service."""
        service = self._service(request["service"], caller)
        return {"node": service.node if service is not None else ""}

    def service_host(self, request: dict[str, Any], caller: str) -> Response:
        """Return the host of a service."""
        return {"host": HOST if self._service(request["service"], caller) is not None else ""}

    # Nodes and actions.

    def nodes(self, request: dict[str, Any], caller: str) -> Response:
        """Return all nodes."""
        return self._cached(self._nodes, caller)

    def node_details(self, request: dict[str, Any], caller: str) -> Response:
        """Return the topics and services of a node."""
        view = self._graph.view(caller)
        node = view.node(global_name(self._graph, request["node"], caller))
        if node is None:
            return {"subscribing": [], "publishing": [], "services": []}
        return {
            "subscribing": view.subscribed_by(node),
            "publishing": view.published_by(node),
            "services": view.provided_by(node),
        }

    def action_servers(self, request: dict[str, Any], caller: str) -> Response:
        """Return all actions: those of ROS 2's kind, and those over topics, as in ROS 1."""
        return self._cached(self._action_servers, caller)

    def action_type(self, request: dict[str, Any], caller: str) -> Response:
        """Return the type of an action, ``package/action/Name`` as in `interfaces`."""
        view, name = self._graph.view(caller), global_name(self._graph, request["action"], caller)
        if (action := view.action(name)) is not None:
            return {"type": _in_ros2(action.type.name)}
        goals = view.topic(f"{name}/goal") if name in actions_over_topics(view.topics()) else None
        if goals is None or goals.type is None or not goals.type.name.endswith(GOAL_SUFFIX):
            return {"type": ""}
        return {"type": _in_ros2(goals.type.name.removesuffix(GOAL_SUFFIX))}

    def interfaces(self, request: dict[str, Any], caller: str) -> Response:
        """Return all types of messages, services and actions, as ROS 2 names them."""
        return self._cached(self._interfaces, caller)

    # The responses that are cached.

    def _topics(self, caller: str) -> bytes:
        pairs = self._types_of_topics(caller)
        return to_json(
            {"topics": [name for name, _ in pairs], "types": [type_ for _, type_ in pairs]}
        )

    def _topics_and_raw_types(self, caller: str) -> bytes:
        texts, room = [], MOST_TEXT
        for topic in self._graph.view(caller).all_topics():
            # Once there is no room left, no more texts are made.
            text = self._full_text(topic.type, caller) if room >= 0 else _NO_TEXT
            room -= len(text)
            texts.append(text if room >= 0 else _NO_TEXT)
        if room < 0:
            self._times_too_long += 1
            if is_power_of_ten(self._times_too_long):
                logger.warning(
                    "/rosapi/topics_and_raw_types leaves out types: their text has more than "
                    "%d bytes.",
                    MOST_TEXT,
                )
        topics = self._cached(self._topics, caller)
        return b'%b,"typedefs_full_text":[%b]}' % (topics[:-1], b",".join(texts))

    def _services(self, caller: str) -> bytes:
        return to_json({"services": self._graph.view(caller).services()})

    def _nodes(self, caller: str) -> bytes:
        return to_json({"nodes": self._graph.view(caller).nodes()})

    def _action_servers(self, caller: str) -> bytes:
        view = self._graph.view(caller)
        servers = actions_over_topics(view.topics()).union(view.actions())
        return to_json({"action_servers": sorted(servers)})

    def _interfaces(self, caller: str) -> bytes:
        return to_json({"interfaces": self._graph.definitions.all_types(caller)})

    def _types_of_topics(self, caller: str) -> list[tuple[str, str]]:
        """Return all topics, sorted, each with its type's name, which is empty without a type."""
        types = ((each.name, each.type) for each in self._graph.view(caller).all_topics())
        return [(name, type_.name if type_ is not None else "") for name, type_ in types]

    def _of_type(self, type_: str | None, caller: str) -> list[Service]:
        """Return the services of a type, sorted by their names."""
        return [each for each in self._graph.view(caller).all_services() if each.type.name == type_]

    # Looking up.

    def _topic(self, name: str, caller: str) -> Topic | None:
        """Return a topic that the caller may see."""
        return self._graph.view(caller).topic(global_name(self._graph, name, caller))

    def _service(self, name: str, caller: str) -> Service | None:
        """Return a service that the caller may see."""
        return self._graph.view(caller).service(global_name(self._graph, name, caller))

    def _full_text(self, type_: MessageType | None, caller: str) -> bytes:
        """Return the full text of a topic's type as JSON, which is empty if that is unknown."""
        if type_ is None:
            return _NO_TEXT
        try:
            if type_.codecs is not None:
                return self._full_texts.get(type_.codecs.definitions, type_.name)
            known = self._graph.definitions.known_to(caller, "msg", type_.name)
            return self._full_texts.get(known, type_.name)
        except InterfaceError:
            return _NO_TEXT

    def _canonical(self, type_: str) -> str | None:
        """Return the type's name as the graph has it, or None if it is not a type's name."""
        try:
            return Interfaces.canonical(type_)
        except InvalidTypeName:
            return None


def _in_ros2(action_type: str) -> str:
    return action_type.replace("/", "/action/")


def actions_over_topics(topics: Iterable[str]) -> set[str]:
    """Return the actions that are topics, as in ROS 1: namespaces that hold all five of these."""
    found: defaultdict[str, set[str]] = defaultdict(set)
    for name in topics:
        namespace, _, topic = name.rpartition("/")
        if topic in ACTION_TOPICS:
            found[namespace].add(topic)
    servers = {namespace for namespace, held in found.items() if held >= ACTION_TOPICS}
    # Topics such as /goal are in no namespace, and so of no action.
    return servers - {""}


def global_name(graph: Graph, name: str, caller: str) -> str:
    """Resolve a name for the caller; return it unchanged if it is invalid."""
    try:
        return graph.resolve(name, caller)
    except InvalidName:
        return name
