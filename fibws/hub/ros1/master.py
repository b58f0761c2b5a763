"""The Master API and the parameter server of ROS 1, on the hub's graph.

Source: http://wiki.ros.org/ROS/Master_API and http://wiki.ros.org/ROS/Parameter%20Server%20API;
where they leave something open, rosmaster's behaviour.
"""

from __future__ import annotations

import asyncio
import ipaddress
import logging
import os
from collections.abc import Awaitable, Callable, Collection, Iterable
from typing import Any

from pydantic_core import from_json

from fibws.errors import ParameterNotSet
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.parameters import Prepared, native, prepare
from fibws.hub.log.audit import Audit
from fibws.hub.ros1 import api
from fibws.hub.ros1.api import Answer, Check, Method
from fibws.hub.ros1.http import NodeCalls, XmlRpcCaller
from fibws.hub.ros1.nodes import Ros1Nodes
from fibws.hub.ros1.topic_registrations import ANY, CLIENT, MASTER
from fibws.hub.ros1.xmlrpc import Written, escaped, write_value

logger = logging.getLogger("fibws.hub")

MOST_PARAMETER_SUBSCRIPTIONS = 10_000
LARGE = 32 * 1024
"""Bytes from which on a parameter is read, or written, in a thread."""

_topic, _service, _node = api.resolved("topic"), api.resolved("service"), api.resolved("node")
_caller_api, _service_api = api.api("caller_api"), api.api("service_api")


class Master:
    """The methods of the Master API, by their names.

    Args:
        shut_down: ends the hub; takes the caller's reason.
    """

    def __init__(
        self,
        graph: Graph,
        nodes: Ros1Nodes,
        calls: NodeCalls,
        audit: Audit,
        shut_down: Callable[[str], object],
    ) -> None:
        self._graph = graph
        self._nodes = nodes
        self._calls = calls
        self._audit = audit
        self._shut_down = shut_down
        self._parameter_subscribers: dict[str, dict[str, str]] = {}
        """By keys with a slash at their ends: the names of nodes and their URIs."""
        self._answers: dict[str, tuple[int, Written]] = {}
        """The answers that list the graph, with the revision they are of."""
        self._setter = ""
        self._view = graph.view(CLIENT)
        graph.parameters.watch(self._parameter_changed)
        self.methods = self._methods()

    def _methods(self) -> dict[str, Method]:
        parameter: tuple[Check, ...] = (api.key,)
        topic: tuple[Check, ...] = (_topic, api.type_name, _caller_api)
        return {
            "registerPublisher": Method(self.register_publisher, [], topic),
            "registerSubscriber": Method(self.register_subscriber, [], topic),
            "unregisterPublisher": Method(self.unregister_publisher, 0, (_topic, _caller_api)),
            "unregisterSubscriber": Method(self.unregister_subscriber, 0, (_topic, _caller_api)),
            "registerService": Method(
                self.register_service, 0, (_service, _service_api, _caller_api)
            ),
            "unregisterService": Method(self.unregister_service, 0, (_service, _service_api)),
            "lookupService": Method(self.lookup_service, "", (_service,)),
            "lookupNode": Method(self.lookup_node, "", (_node,)),
            "getPublishedTopics": Method(
                self.get_published_topics, 0, (api.resolved("subgraph", may_be_empty=True),)
            ),
            "getTopicTypes": Method(self.get_topic_types, []),
            "getSystemState": Method(self.get_system_state, [[], [], []]),
            "getUri": Method(self.get_uri, ""),
            "getPid": Method(self.get_pid, -1),
            "shutdown": Method(self.shutdown, 0, (api.anything,), optional=1),
            "setParam": Method(self.set_param, 0, (api.key, api.value)),
            "getParam": Method(self.get_param, 0, parameter),
            "deleteParam": Method(self.delete_param, 0, parameter),
            "hasParam": Method(self.has_param, False, parameter),
            "searchParam": Method(self.search_param, 0, (api.search_key,)),
            "getParamNames": Method(self.get_param_names, []),
            "subscribeParam": Method(self.subscribe_param, 0, (_caller_api, api.key)),
            "unsubscribeParam": Method(self.unsubscribe_param, 0, (_caller_api, api.key)),
        }

    # Topics.

    def register_publisher(
        self, caller: XmlRpcCaller, node: str, topic: str, type_: str, uri: str
    ) -> Answer:
        """Register a publisher; the value is the URIs of the topic's subscribers."""
        self._nodes.add_publisher(node, topic, type_, uri, caller.hub_host)
        text = f"Registered [{node}] as publisher of [{topic}]"
        return 1, text, self._nodes.topics.subscriber_apis(topic, caller.hub_host)

    def register_subscriber(
        self, caller: XmlRpcCaller, node: str, topic: str, type_: str, uri: str
    ) -> Answer:
        """Register a subscriber; the value is the URIs of the topic's publishers."""
        self._nodes.add_subscriber(node, topic, type_, uri, caller.hub_host)
        subscriber = self._nodes.topics.subscriber(node, topic)
        apis = self._nodes.topics.publisher_apis(topic, caller.hub_host, subscriber)
        if subscriber is not None:
            subscriber.sent = apis
        return 1, f"Subscribed to [{topic}]", apis

    def unregister_publisher(self, caller: XmlRpcCaller, node: str, topic: str, uri: str) -> Answer:
        """Remove a publisher; the value is how many were removed."""
        return self._removed(self._nodes.remove_publisher(node, topic, uri), node, topic)

    def unregister_subscriber(
        self, caller: XmlRpcCaller, node: str, topic: str, uri: str
    ) -> Answer:
        """Remove a subscriber; the value is how many were removed."""
        return self._removed(self._nodes.remove_subscriber(node, topic, uri), node, topic)

    def _removed(self, was_there: bool, node: str, topic: str) -> Answer:
        if was_there:
            return 1, f"Unregistered [{node}] as provider of [{topic}]", 1
        if node not in self._nodes.by_name:
            return 1, f"[{node}] is not a registered node", 0
        return 1, f"[{node}] is not a known provider of [{topic}]", 0

    def get_published_topics(self, caller: XmlRpcCaller, node: str, namespace: str) -> Answer:
        """Return the topics with publishers in a namespace, with their types."""
        below = f"{namespace}/" if namespace else ""
        found = [
            [topic, self._type_of(topic)]
            for topic, publishers, _ in self._topics()
            if publishers and topic.startswith(below)
        ]
        return 1, "current topics", found

    def get_topic_types(self, caller: XmlRpcCaller, node: str) -> Answer:
        """Return all topics with their types."""
        found = [[topic, self._type_of(topic)] for topic, _, _ in self._topics()]
        return 1, "current system state", found

    # Services.

    def register_service(
        self, caller: XmlRpcCaller, node: str, service: str, service_uri: str, uri: str
    ) -> Answer:
        """Register a service, which takes the place of an older one of its name."""
        self._nodes.add_service(node, service, service_uri, uri, caller.hub_host)
        return 1, f"Registered [{node}] as provider of [{service}]", 1

    def unregister_service(self, caller: XmlRpcCaller, node: str, service: str, uri: str) -> Answer:
        """Remove a service; the value is how many were removed."""
        if not self._nodes.remove_service(service, uri):
            text = f"[{uri}] is no longer the current service api handle for [{service}]"
            return 1, text, 0
        return 1, f"Unregistered [{node}] as provider of [{service}]", 1

    def lookup_service(self, caller: XmlRpcCaller, node: str, service: str) -> Answer:
        """Return the URI of a service: a ROS 1 node's own, or the hub's."""
        found = self._nodes.service(service)
        uri = found[1] if found is not None else ""
        if not uri and self._view.service(service) is not None:
            uri = (
                self._nodes.topics.hub_api(caller.hub_host).replace("http:", "rosrpc:").rstrip("/")
            )
        return (1, f"rosrpc URI: [{uri}]", uri) if uri else (-1, "no provider", "")

    # The graph.

    def lookup_node(self, caller: XmlRpcCaller, node: str, name: str) -> Answer:
        """Return the URI of a node; of a node of the hub, a path at the hub."""
        found = self._nodes.by_name.get(name)
        if found is not None:
            return 1, "node api", found.api
        if self._view.node(name) is not None:
            return 1, "node api", self._nodes.topics.hub_api(caller.hub_host, name)
        return -1, f"unknown node [{name}]", ""

    def get_system_state(self, caller: XmlRpcCaller, node: str) -> Answer:
        """Return the publishers and subscribers of all topics, and the nodes of all services."""
        return 1, "current system state", self._cached("state", self._system_state)

    def get_uri(self, caller: XmlRpcCaller, node: str) -> Answer:
        """Return the master's URI."""
        return 1, "", self._nodes.topics.hub_api(caller.hub_host)

    def get_pid(self, caller: XmlRpcCaller, node: str) -> Answer:
        """Return the hub's process."""
        return 1, "", os.getpid()

    def shutdown(self, caller: XmlRpcCaller, node: str, reason: Any = "") -> Answer:
        """End the hub, if the caller is on this machine."""
        if not is_loopback(caller.host) or not self._graph.policy.allows_all:
            logger.warning("%s (%s) may not end the hub.", node, caller.host)
            return -1, "shutdown is only for programs on the master's own machine", 0
        self._shut_down(f"{node}: {reason}")
        return 1, "shutdown", 0

    def _system_state(self) -> str:
        topics = list(self._topics())
        publishers = _registrations((name, nodes) for name, nodes, _ in topics)
        subscribers = _registrations((name, nodes) for name, _, nodes in topics)
        of_services = {each.name: each.node for each in self._view.all_services()}
        of_services.update((name, node.name) for name, node in self._nodes.services())
        found = _registrations((name, [node]) for name, node in of_services.items())
        return f"<value><array><data>{publishers}{subscribers}{found}</data></array></value>"

    def _topics(self) -> Iterable[tuple[str, Collection[str], Collection[str]]]:
        """Yield all topics, with the nodes that publish them and those that subscribe to them."""
        view, nodes = self._view, self._nodes
        # ROS 1 nodes are always listed, also those that exchange no messages with the hub.
        names = dict.fromkeys(view.topics())
        names.update(dict.fromkeys(nodes.topics.names()))
        for name in names:
            topic = view.topic(name)
            conflicts = view.conflicts(topic) if topic is not None else []
            if topic is not None and not conflicts:
                yield name, view.publishers(topic), view.subscribers(topic)
                continue
            publishers = dict.fromkeys(view.publishers(topic) if topic is not None else ())
            subscribers = dict.fromkeys(view.subscribers(topic) if topic is not None else ())
            for each in conflicts:
                (publishers if each.publishes else subscribers)[each.node] = None
            publishers.update((each.node.name, None) for each in nodes.topics.publishers(name))
            subscribers.update((each.node, None) for each in nodes.topics.subscribers(name))
            yield name, publishers, subscribers

    def _type_of(self, name: str) -> str:
        topic = self._view.topic(name)
        if topic is not None and topic.type is not None:
            return topic.type.name
        types = [each.type for each in self._nodes.topics.publishers(name)]
        types += [each.type for each in self._nodes.topics.subscribers(name)]
        return next((type_ for type_ in types if type_ != ANY), ANY)

    def _cached(self, name: str, make: Callable[[], str]) -> Written:
        revision, answer = self._answers.get(name, (-1, None))
        if answer is None or revision != self._graph.revision:
            answer = Written(make())
            self._answers[name] = (self._graph.revision, answer)
        return answer

    # Parameters.

    def set_param(
        self, caller: XmlRpcCaller, node: str, key: str, value: Any
    ) -> Answer | Awaitable[Answer]:
        """Set a parameter, or a namespace, which replaces the one that was there."""
        if caller.size > LARGE and isinstance(value, dict | list):
            return self._set_large(node, key, value)
        return self._set(node, key, value)

    async def _set_large(self, node: str, key: str, value: Any) -> Answer:
        return self._set(node, key, value, await asyncio.to_thread(prepare, key, value))

    def _set(self, node: str, key: str, value: Any, prepared: Prepared | None = None) -> Answer:
        self._setter = node
        try:
            self._graph.set_parameter(CLIENT, key, value, prepared)
        finally:
            self._setter = ""
        self._audit.parameter_written(key, node=node)
        return 1, f"parameter {key} set", 0

    def get_param(self, caller: XmlRpcCaller, node: str, key: str) -> Answer | Awaitable[Answer]:
        """Return a parameter, or a namespace as a struct."""
        try:
            text = self._view.parameter(key)
        except ParameterNotSet:
            return -1, f"Parameter [{key}] is not set", 0
        if len(text) > LARGE:
            return self._get_large(key, text)
        return 1, f"Parameter [{key}]", _native(text)

    async def _get_large(self, key: str, text: bytes) -> Answer:
        return 1, f"Parameter [{key}]", await asyncio.to_thread(_native, text)

    def delete_param(self, caller: XmlRpcCaller, node: str, key: str) -> Answer:
        """Delete a parameter, or a namespace."""
        if not self._view.has_parameter(key):
            return -1, f"parameter [{key}] is not set", 0
        self._setter = node
        try:
            self._graph.delete_parameter(CLIENT, key)
        finally:
            self._setter = ""
        self._audit.parameter_written(key, node=node, deleted=True)
        return 1, f"parameter {key} deleted", 0

    def has_param(self, caller: XmlRpcCaller, node: str, key: str) -> Answer:
        """Return whether there is a parameter or a namespace of this name."""
        return 1, key, self._view.has_parameter(key)

    def search_param(self, caller: XmlRpcCaller, node: str, key: str) -> Answer:
        """Return the nearest parameter of a name, in the caller's namespace and those above it."""
        found = self._view.search_parameter(key, node)
        if found:
            return 1, f"Found [{found}]", found
        return -1, f"Cannot find parameter [{key}] in an upwards search", ""

    def get_param_names(self, caller: XmlRpcCaller, node: str) -> Answer:
        """Return the names of all parameters."""
        return 1, "Parameter names", self._view.parameters()

    def subscribe_param(self, caller: XmlRpcCaller, node: str, uri: str, key: str) -> Answer:
        """Report changes of a parameter to a node; the value is the present one, or {}."""
        subscribers = self._parameter_subscribers
        if sum(map(len, subscribers.values())) >= MOST_PARAMETER_SUBSCRIPTIONS:
            return 0, f"too many subscriptions, limit is {MOST_PARAMETER_SUBSCRIPTIONS}", 0
        subscribers.setdefault(_namespace(key), {})[node] = uri
        return 1, f"Subscribed to parameter [{key}]", self._parameter_or_empty(key)

    def unsubscribe_param(self, caller: XmlRpcCaller, node: str, uri: str, key: str) -> Answer:
        """Stop reporting changes of a parameter."""
        namespace = _namespace(key)
        subscribers = self._parameter_subscribers.get(namespace, {})
        was_there = subscribers.get(node) == uri
        if was_there:
            del subscribers[node]
            if not subscribers:
                del self._parameter_subscribers[namespace]
        return 1, f"Unsubscribe to parameter [{key}]", 1

    def forget(self, uri: str) -> None:
        """Report no changes of parameters to a node that is gone."""
        for namespace, nodes in list(self._parameter_subscribers.items()):
            for node in [node for node, of_node in nodes.items() if of_node == uri]:
                del nodes[node]
            if not nodes:
                del self._parameter_subscribers[namespace]

    def _parameter(self, key: str) -> object:
        return _native(self._view.parameter(key))

    def _parameter_or_empty(self, key: str) -> object:
        try:
            return self._parameter(key)
        except ParameterNotSet:
            return {}

    def _parameter_changed(self, name: str, _: str) -> None:
        """Report a change to the subscribers of the parameter, and of all above and below it.

        The node that has set it gets no update, as with rosmaster.
        """
        changed = _namespace(name)
        for subscribed, nodes in self._parameter_subscribers.items():
            if changed.startswith(subscribed):
                key = changed
            elif subscribed.startswith(changed):
                key = subscribed
            else:
                continue
            value = Written(write_value(self._parameter_or_empty(key.rstrip("/") or "/")))
            for node, uri in nodes.items():
                if node != self._setter:
                    self._calls.notify(uri, ("parameter", key), "paramUpdate", MASTER, key, value)


def is_loopback(host: str) -> bool:
    """Return whether an IP address is of this machine's own network."""
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return False
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback


def _native(text: bytes) -> object:
    return native(from_json(text))


def _namespace(key: str) -> str:
    return key if key.endswith("/") else f"{key}/"


def _registrations(found: Iterable[tuple[str, Collection[str]]]) -> str:
    """Return the XML of ``[[name, [node, ...]], ...]``, without names that no node has."""
    listed = [each for each in found if each[1]]
    # Names rarely need escapes: all are looked at together.
    text = "".join([name for name, _ in listed] + [node for _, nodes in listed for node in nodes])
    if escaped(text) != text:
        listed = [(escaped(name), [*map(escaped, nodes)]) for name, nodes in listed]
    between = "</string></value><value><string>"
    parts = [
        f"<value><array><data><value><string>{name}</string></value><value><array><data><value>"
        f"<string>{between.join(nodes)}</string></value></data></array></value></data></array>"
        "</value>"
        for name, nodes in listed
    ]
    return f"<value><array><data>{''.join(parts)}</data></array></value>"
