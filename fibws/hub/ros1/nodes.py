"""The ROS 1 nodes that have registered at the hub's master, as nodes of the graph.

What a node publishes and subscribes to is a source or a sink of the graph's topic, so that every
tool sees one graph. A ROS 1 master refuses nobody: a node that uses a topic with another type than
it has there is registered, and found by other ROS 1 nodes, but it exchanges no messages with the
hub's clients; the topic lists it among its conflicts. The same goes for what the policy forbids.
"""

from __future__ import annotations

import asyncio
import errno
import logging
import os
from collections.abc import Callable, Coroutine, Iterable, Mapping
from contextlib import suppress
from socket import gethostname
from time import perf_counter
from typing import Any, NamedTuple, Protocol
from urllib.parse import urlsplit

from fibws.access.rights import Principal
from fibws.errors import (
    InterfaceError,
    InvalidMessage,
    NodeUnreachable,
    NotAllowed,
    OperationError,
    Ros1Error,
)
from fibws.hub.graph.graph import ExternalNode, Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.service import InternalServer
from fibws.hub.graph.topic import Conflict, LatchQuota, Receiver, SinkReport, Source, Topic
from fibws.hub.graph.types import MessageType
from fibws.hub.log_text import shortened
from fibws.hub.ros1.http import NodeCalls

logger = logging.getLogger("fibws.hub")

MASTER = "/master"
"""The caller_id of the master's own calls."""
ANY = "*"
"""The type of a subscriber that takes every message."""
CHECK_INTERVAL = 10.0
"""Seconds between two checks of a node that is reachable."""
TURN = 0.001
"""Seconds for which topics are updated before others have their turn."""
CHECKS_AT_ONCE = 10
"""Nodes that are checked in a second at most."""


class Links(Protocol):
    """The connections by which ROS 1 nodes exchange messages with the hub's clients."""

    def outlet(self, topic: str) -> Receiver:
        """Return what takes the messages of a topic for all ROS 1 subscribers."""

    def changed(self, topic: Topic) -> None:
        """Take note that publishers or subscribers of a topic have changed."""


class ServiceLinks(Protocol):
    """The connections by which ROS 1 nodes' services are called."""

    def register(self, node: Ros1Node, service: str, uri: str) -> None:
        """Add a service of a ROS 1 node to the graph."""

    def unregister(self, node: Ros1Node, service: str) -> None:
        """Remove it."""


class Link(Receiver, Protocol):
    """A connection to a ROS 1 subscriber."""

    def report(self) -> SinkReport:
        """Return its totals."""


class SavedNode(NamedTuple):
    """A node and its registrations, for a hub that starts later."""

    name: str
    api: str
    hub_host: str
    pid: int | None
    publishers: Mapping[str, str]
    """Topics with their types, as with the subscribers."""
    subscribers: Mapping[str, str]
    services: Mapping[str, str]
    """Services with their URIs."""


class Ros1Publisher:
    """A ROS 1 node's registration as a publisher of a topic.

    Attributes:
        type: ``package/Type`` as it was registered, or ``*``.
        source: the node's source of the graph; None while it may not exchange messages with it.
        is_relayed: whether a link may be opened for it: its type is the topic's, or not known yet.
        fault: why it conflicts with the topic; empty if it does not.
    """

    __slots__ = ("fault", "is_relayed", "node", "source", "topic", "type")

    def __init__(self, node: Ros1Node, topic: str, type_: str) -> None:
        self.node = node
        self.topic = topic
        self.type = type_
        self.source: Source | None = None
        self.is_relayed = True
        self.fault = ""


class Ros1Subscriber:
    """A ROS 1 node's registration as a subscriber of a topic; a `Sink`.

    Attributes:
        type: ``package/Type`` as it was registered, or ``*``.
        sent: the addresses of publishers that it was sent last; None before that.
        link: its connection to the hub, while there is one; the newest of several.
        fault: why it conflicts with the topic; empty if it does not.
    """

    __slots__ = ("_dropped", "_messages", "fault", "link", "node", "owner", "sent", "topic", "type")

    def __init__(self, owner: Ros1Node, topic: str, type_: str) -> None:
        self.owner = owner
        self.node = owner.name
        self.topic = topic
        self.type = type_
        self.sent: list[str] | None = None
        self.link: Link | None = None
        self.fault = ""
        self._messages = 0
        self._dropped = 0

    def receive(self, publication: Publication) -> None:
        """Take a message for this subscriber alone; the topic's outlet takes those for all."""
        if self.link is not None:
            self.link.receive(publication)

    def replay(self, publication: Publication) -> None:
        """Do nothing: latched messages are sent when the subscriber connects."""

    def report(self) -> SinkReport:
        """Return the totals of all its connections."""
        present = self.link.report() if self.link is not None else SinkReport()
        return present._replace(
            messages=present.messages + self._messages, dropped=present.dropped + self._dropped
        )

    def unlink(self, ended: Link, other: Link | None) -> None:
        """Keep the totals of a connection that has ended, and use another one if there is one."""
        totals = ended.report()
        self._messages += totals.messages
        self._dropped += totals.dropped
        if self.link is ended:
            self.link = other


class Ros1Node(ExternalNode):
    """A ROS 1 node; a `Node` of the graph.

    Args:
        name: its global name.
        api: the URI of its XML-RPC server.
        hub_host: the address by which it reached the hub.
        since: when it registered, in nanoseconds since 1970.

    Attributes:
        pid: its process, once it has told it.
        services: the URIs of its services, by their names.
    """

    def __init__(self, name: str, api: str, hub_host: str, since: int, nodes: Ros1Nodes) -> None:
        self.name = name
        self.api = api
        self.hub_host = hub_host
        self.pid: int | None = None
        self.publishers: dict[str, Ros1Publisher] = {}
        self.subscribers: dict[str, Ros1Subscriber] = {}
        self.services: dict[str, str] = {}
        self.fault = ""
        self.since = since
        self._nodes = nodes

    @property
    def is_empty(self) -> bool:
        """Whether it has no registration left."""
        return not (self.publishers or self.subscribers or self.services)

    def publishing(self) -> Iterable[str]:
        """Return the topics that it publishes."""
        return self.publishers

    def subscribing(self) -> Iterable[str]:
        """Return the topics that it subscribes to."""
        return self.subscribers

    def providing(self) -> Iterable[str]:
        """Return the services that it provides."""
        return self.services

    def replaced(self) -> None:
        """End, since another node has taken its name."""
        self._nodes.replaced(self)

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask whether it answers; see `ExternalNode`."""
        return self._nodes.run(self._nodes.ping(self), done)

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        """Ask it to end; see `ExternalNode`."""
        return self._nodes.run(self._nodes.shut_down(self, reason), done)

    def unregister(self) -> None:
        """Remove it; see `ExternalNode`."""
        self._nodes.remove(self)


class Ros1Nodes:
    """All ROS 1 nodes of the hub's master.

    Args:
        principal: whose rights they have; None on a hub without authentication.
        quota: returns the bound of a node's latched messages.
        port: returns the port of the hub's master.

    Attributes:
        by_name: the nodes.
        links: set before the first node registers, as are the service links.
        changed: called after each change of what the state file holds.
    """

    def __init__(
        self,
        graph: Graph,
        calls: NodeCalls,
        *,
        principal: Principal | None,
        quota: Callable[[], LatchQuota],
        port: Callable[[], int],
    ) -> None:
        self.by_name: dict[str, Ros1Node] = {}
        self.links: Links
        self.service_links: ServiceLinks
        self.changed: Callable[[], object] = lambda: None
        self.principal = principal
        self._graph = graph
        self._calls = calls
        self._quota = quota
        self._port = port
        self._publishers: dict[str, dict[str, Ros1Publisher]] = {}
        """By topic and node."""
        self._subscribers: dict[str, dict[str, Ros1Subscriber]] = {}
        self._services: dict[str, Ros1Node] = {}
        self._types_in_conflict: dict[str, MessageType | None] = {}
        """By topic: the type that it had when nodes conflicted with it."""
        self._dirty: dict[str, None] = {}
        """The topics whose publishers or subscribers have changed since they were updated."""
        self._is_update_due = False
        self._tasks: set[asyncio.Task[None]] = set()
        self.gone: Callable[[str], object] = lambda api: None
        """Called with an address at which no node is registered any more."""
        self._is_closed = False
        graph.watch_topics(lambda topic: self._mark(topic.name))

    # Looking up.

    def publishers(self, topic: str) -> list[Ros1Publisher]:
        """Return the ROS 1 publishers of a topic."""
        return list(self._publishers.get(topic, {}).values())

    def subscribers(self, topic: str) -> list[Ros1Subscriber]:
        """Return the ROS 1 subscribers of a topic."""
        return list(self._subscribers.get(topic, {}).values())

    def topics(self) -> Iterable[str]:
        """Return the topics of all registrations."""
        return {**self._publishers, **self._subscribers}

    def subscriber(self, node: str, topic: str) -> Ros1Subscriber | None:
        """Return a node's registration as a subscriber."""
        return self._subscribers.get(topic, {}).get(node)

    def service(self, name: str) -> tuple[Ros1Node, str] | None:
        """Return the node of a service, and the service's URI."""
        node = self._services.get(name)
        return None if node is None else (node, node.services[name])

    def services(self) -> Iterable[tuple[str, Ros1Node]]:
        """Return all services with their nodes."""
        return self._services.items()

    def hub_api(self, hub_host: str, node: str = "") -> str:
        """Return the URI of the hub for those who reach it at a host: its own, or a node's.

        roscpp tells publishers apart by host and port, so that publishers are always the hub.
        """
        host = f"[{hub_host}]" if ":" in hub_host else hub_host
        return f"http://{host}:{self._port()}/{f'node{node}' if node else ''}"

    def publisher_apis(self, topic: str, hub_host: str) -> list[str]:
        """Return the URIs of a topic's publishers, the hub's once for all of its clients."""
        apis = dict.fromkeys(each.node.api for each in self.publishers(topic))
        if self.has_own_sources(topic):
            apis[self.hub_api(hub_host)] = None
        return list(apis)

    def is_publisher(self, node: str, topic: str) -> bool:
        """Return whether a ROS 1 node of this name publishes a topic."""
        return node in self._publishers.get(topic, ())

    def has_own_sources(self, topic: str) -> bool:
        """Return whether a topic has a publisher that is not a ROS 1 node."""
        found = self._graph.topics.get(topic)
        return found is not None and any(node not in self.by_name for node in found.sources)

    def subscriber_apis(self, topic: str, hub_host: str) -> list[str]:
        """Return the URIs of a topic's subscribers, the hub's once for all of its clients."""
        apis = dict.fromkeys(each.owner.api for each in self.subscribers(topic))
        found = self._graph.topics.get(topic)
        if found is not None and any(node not in self.by_name for node in found.subscribers()):
            apis[self.hub_api(hub_host)] = None
        return list(apis)

    # Registering.

    def add_publisher(self, name: str, topic: str, type_: str, api: str, hub_host: str) -> bool:
        """Register a publisher; return whether the node may have its name."""
        node = self._enter(name, api, hub_host)
        if node is None:
            return False
        older = node.publishers.get(topic)
        if older is not None:
            if type_ in (older.type, ANY):
                return True
            self._remove_publisher(older)
        publisher = Ros1Publisher(node, topic, type_)
        node.publishers[topic] = self._publishers.setdefault(topic, {})[name] = publisher
        self._attach_publisher(publisher)
        self._mark(topic)
        self.changed()
        return True

    def add_subscriber(self, name: str, topic: str, type_: str, api: str, hub_host: str) -> bool:
        """Register a subscriber; return whether the node may have its name."""
        node = self._enter(name, api, hub_host)
        if node is None:
            return False
        older = node.subscribers.get(topic)
        if older is not None:
            if type_ in (older.type, ANY):
                return True
            self._remove_subscriber(older)
        subscriber = Ros1Subscriber(node, topic, type_)
        node.subscribers[topic] = self._subscribers.setdefault(topic, {})[name] = subscriber
        self._attach_subscriber(subscriber)
        self._mark(topic)
        self.changed()
        return True

    def add_service(self, name: str, service: str, uri: str, api: str, hub_host: str) -> bool:
        """Register a service, which another node may have had before; return whether it may."""
        present = self._graph.services.get(service)
        if present is not None and isinstance(present.server, InternalServer):
            logger.warning("%s cannot serve %s, which is the hub's own.", name, service)
            return False
        node = self._enter(name, api, hub_host)
        if node is None:
            return False
        older = self._services.get(service)
        if older is not None and (older is not node or node.services[service] != uri):
            self.remove_service(service, older.services[service])
            node = self._enter(name, api, hub_host) or node  # It may have been its last one.
        node.services[service] = uri
        self._services[service] = node
        self.service_links.register(node, service, uri)
        self.changed()
        return True

    def remove_publisher(self, name: str, topic: str, api: str) -> bool:
        """Remove a registration; return whether there was one."""
        publisher = self._publishers.get(topic, {}).get(name)
        if publisher is None or publisher.node.api != api:
            return False
        self._remove_publisher(publisher)
        self._settle(publisher.node)
        return True

    def remove_subscriber(self, name: str, topic: str, api: str) -> bool:
        """Remove a registration; return whether there was one."""
        subscriber = self._subscribers.get(topic, {}).get(name)
        if subscriber is None or subscriber.owner.api != api:
            return False
        self._remove_subscriber(subscriber)
        self._settle(subscriber.owner)
        return True

    def remove_service(self, service: str, uri: str) -> bool:
        """Remove a service, unless another URI has taken its place; return whether it was there."""
        node = self._services.get(service)
        if node is None or node.services[service] != uri:
            return False
        self._remove_service(node, service)
        self._settle(node)
        return True

    def service_displaced(self, service: str) -> None:
        """Forget a service that a client of the hub has taken over."""
        node = self._services.pop(service, None)
        if node is not None:
            del node.services[service]
            self._settle(node)

    def remove(self, node: Ros1Node) -> None:
        """Remove a node that is gone, with all its registrations."""
        self._drop(node)
        self._graph.leave(node, node.name)

    def learn(
        self, publisher: Ros1Publisher, type_: str, definition: str | None, md5sum: str
    ) -> Source | None:
        """Set the type that a publisher has told a link, and return its source.

        Args:
            definition: the text of the type, if the publisher sends it.

        Returns:
            None if it conflicts with the topic's type, the policy forbids it, or the publisher is
            not registered any more.
        """
        if publisher not in self.publishers(publisher.topic):
            return None
        publisher.type = type_
        self._detach_conflict(publisher.topic, publisher.node.name, publishes=True)
        source = publisher.source
        if source is not None and not _is_same(source.type, type_, md5sum):
            # It must not be held to the type that it had before.
            self._detach_source(publisher)
        self._attach_publisher(publisher, definition, md5sum)
        return publisher.source

    def set_fault(self, api: str, fault: str) -> None:
        """Set why the nodes at an address do not answer; empty if they do."""
        for node in self.by_name.values():
            if node.api == api and node.fault != fault:
                if bool(node.fault) != bool(fault):
                    state = f"is unreachable at {api}: {fault}" if fault else "is reachable again"
                    logger.warning("%s %s.", node.name, state)
                node.fault = fault
                self._graph.revision += 1

    # Names.

    def set_principal(self, principal: Principal) -> None:
        """Give the nodes the rights of a principal instead of those that they had."""
        self.principal = principal
        self._graph.revision += 1
        for node in self.by_name.values():
            self._graph.policy.enter(node.name, principal, is_chosen=False, is_taken=False)
        self._start(self._apply_rights())

    async def _apply_rights(self) -> None:
        """Attach what the nodes may use now, and detach what they may not, in slices."""
        graph = self._graph
        for node in list(self.by_name.values()):
            await asyncio.sleep(0)
            if self.by_name.get(node.name) is not node:
                continue
            for topic, publisher in node.publishers.items():
                is_allowed = graph.is_allowed(node.name, "publish", topic)
                if is_allowed is not (publisher.source is not None):
                    self._detach_source(publisher)
                    self._detach_conflict(topic, node.name, publishes=True)
                    self._attach_publisher(publisher)
            for topic, subscriber in node.subscribers.items():
                is_allowed = graph.is_allowed(node.name, "subscribe", topic)
                if is_allowed is not (subscriber in graph.topic(topic).sinks()):
                    graph.unsubscribe(graph.topic(topic), subscriber)
                    self._detach_conflict(topic, node.name, publishes=False)
                    self._attach_subscriber(subscriber)
            for service, uri in node.services.items():
                if not graph.is_allowed(node.name, "provide", service):
                    self.service_links.unregister(node, service)
                self.service_links.register(node, service, uri)
            for topic in (*node.publishers, *node.subscribers):
                self._mark(topic)

    def replaced(self, node: Ros1Node) -> None:
        """Remove a node whose name another one has taken, and end its process."""
        self._drop(node)
        self._start(self._end(node, f"[{node.name}] Reason: new node registered with same name"))

    async def shut_down(self, node: Ros1Node, reason: str) -> None:
        """Ask a node to end; raises `Ros1Error` if it does not answer."""
        await self._calls.call(node.api, "shutdown", MASTER, reason)

    async def _end(self, node: Ros1Node, reason: str) -> None:
        """End a node's process, unless another process has its address by now."""
        try:
            pid = await self._calls.call(node.api, "getPid", MASTER)
            is_known = node.pid is not None
            if (is_known and pid != node.pid) or (not is_known and self.at(node.api)):
                return
            await self.shut_down(node, reason)
        except Ros1Error as error:
            logger.info("%s, which was replaced, did not end: %s.", node.name, error)

    def at(self, api: str) -> list[Ros1Node]:
        """Return the nodes at an address; a process may have several."""
        return [each for each in self.by_name.values() if each.api == api]

    def _enter(self, name: str, api: str, hub_host: str) -> Ros1Node | None:
        """Return the node of this name and address, which may be new; None if it may not be."""
        node = self.by_name.get(name)
        if node is not None and node.api == api:
            node.hub_host = hub_host
            return node
        if name in self._graph.internal:
            logger.warning("%s at %s: this name is the hub's own.", name, api)
            return None
        node = Ros1Node(name, api, hub_host, self._graph.now(), self)
        try:
            self._graph.enter(node, name, self.principal)
        except NotAllowed as error:
            logger.warning("%s at %s may not register: %s.", name, api, error)
            return None
        self.by_name[name] = node
        self._start(self._identify(node))
        return node

    async def _identify(self, node: Ros1Node) -> None:
        """Get a node's process, and remove nodes that had its address before."""
        with suppress(Ros1Error):
            await self.ping(node)

    async def ping(self, node: Ros1Node) -> None:
        """Get the process that answers at a node's address; raises `Ros1Error`."""
        try:
            pid = await self._calls.call(node.api, "getPid", MASTER)
        except Ros1Error as error:
            self.set_fault(node.api, _fault(error))
            raise
        self._set_pid(node, pid)

    def restore(self, saved: SavedNode) -> None:
        """Register a node that was registered at an earlier hub, and ask it what it has now.

        It stays registered if it does not answer, unless another process has its address.
        """
        node = self._enter(saved.name, saved.api, saved.hub_host)
        if node is None:
            return
        node.pid = saved.pid
        for topic, type_ in saved.publishers.items():
            self.add_publisher(node.name, topic, type_, node.api, node.hub_host)
        for topic, type_ in saved.subscribers.items():
            self.add_subscriber(node.name, topic, type_, node.api, node.hub_host)
        for service, uri in saved.services.items():
            self.add_service(node.name, service, uri, node.api, node.hub_host)
        self._start(self._compare(node))

    def saved(self) -> list[SavedNode]:
        """Return all nodes as `restore` takes them."""
        return [
            SavedNode(
                node.name,
                node.api,
                node.hub_host,
                node.pid,
                {topic: each.type for topic, each in node.publishers.items()},
                {topic: each.type for topic, each in node.subscribers.items()},
                dict(node.services),
            )
            for node in self.by_name.values()
        ]

    async def _compare(self, node: Ros1Node) -> None:
        """Bring a node's registrations in line with its own lists."""
        name, api, host = node.name, node.api, node.hub_host
        try:
            publications = dict(await self._calls.call(api, "getPublications", MASTER))
            subscriptions = dict(await self._calls.call(api, "getSubscriptions", MASTER))
        except (Ros1Error, TypeError, ValueError) as error:
            logger.info("%s keeps its registrations unchanged: %s.", name, error)
            return
        if self.by_name.get(name) is not node:
            return
        for topic, type_ in publications.items():
            self.add_publisher(name, str(topic), str(type_), api, host)
        for topic, type_ in subscriptions.items():
            self.add_subscriber(name, str(topic), str(type_), api, host)
        for topic in node.publishers.keys() - publications.keys():
            self.remove_publisher(name, topic, api)
        for topic in node.subscribers.keys() - subscriptions.keys():
            self.remove_subscriber(name, topic, api)

    def _set_pid(self, node: Ros1Node, pid: object) -> None:
        """Set the process that answers at a node's address."""
        if not isinstance(pid, int) or not 0 < pid < 2**31:
            pid = None  # It answers all the same.
        if self.by_name.get(node.name) is not node:
            return
        self.set_fault(node.api, "")
        for each in self.at(node.api):
            if pid is not None and each.pid not in (None, pid):
                logger.info("%s is gone: another process has its address.", each.name)
                self.remove(each)
        if node.pid is None and pid is not None:
            node.pid = pid
            self.changed()

    # Checking that nodes are alive.

    async def watch(self) -> None:
        """Check again and again whether the nodes answer."""
        refused: dict[Ros1Node, int] = {}
        while True:
            nodes = list(self.by_name.values())
            pause = max(1 / CHECKS_AT_ONCE, CHECK_INTERVAL / max(1, len(nodes)))
            for node in nodes:
                await asyncio.sleep(pause)
                if self.by_name.get(node.name) is node:
                    try:
                        await self._check(node, refused)
                    except Exception:
                        logger.exception("%s could not be checked.", node.name)
            refused = {node: times for node, times in refused.items() if node in nodes}
            if not nodes:
                await asyncio.sleep(CHECK_INTERVAL)

    async def _check(self, node: Ros1Node, refused: dict[Ros1Node, int]) -> None:
        """Check a node; remove it once it is certain that its process is gone."""
        try:
            await self.ping(node)
            refused.pop(node, None)
        except NodeUnreachable as error:
            is_refused = error.fault == os.strerror(errno.ECONNREFUSED)
            refused[node] = refused.get(node, 0) + 1 if is_refused else 0
            if refused[node] > 1 and self.by_name.get(node.name) is node and _has_ended(node):
                logger.info("%s is gone: its process has ended.", node.name)
                self.remove(node)
        except Ros1Error:
            pass  # It answers, if only with an error.

    # Attaching to the graph.

    def _attach_publisher(
        self, publisher: Ros1Publisher, definition: str | None = None, md5sum: str | None = None
    ) -> None:
        publisher.is_relayed = True
        if publisher.type == ANY:
            return
        topic = self._graph.topic(publisher.topic)
        node = publisher.node.name
        if node not in topic.sources:
            topic.watching_sources.unlinked(node)
        try:
            publisher.source = self._graph.advertise(
                topic,
                node,
                publisher.type,
                definition,
                quota=self._quota(),
                serialized=md5sum is not None,
                md5sum=md5sum,
            )
        except (NotAllowed, OperationError, InterfaceError, InvalidMessage) as error:
            # An unknown type may become known by the definition that the publisher tells a link.
            publisher.is_relayed = isinstance(error, InterfaceError) and md5sum is None
            if publisher.source is None:
                topic.watching_sources.left(node)
            self._detach_source(publisher)
            self._conflict(topic, publisher, node, str(error), publishes=True)
        else:
            publisher.fault = ""

    def _attach_subscriber(self, subscriber: Ros1Subscriber) -> None:
        topic = self._graph.topic(subscriber.topic)
        type_ = None if subscriber.type == ANY else subscriber.type
        topic.watching_sinks.unlinked(subscriber.node)
        try:
            receiver = self.links.outlet(topic.name)
            self._graph.subscribe(topic, subscriber, type_, receiver=receiver)
        except (NotAllowed, OperationError, InterfaceError) as error:
            topic.watching_sinks.left(subscriber.node)
            self._conflict(topic, subscriber, subscriber.node, str(error), publishes=False)
        else:
            subscriber.fault = ""

    def _conflict(
        self,
        topic: Topic,
        registration: Ros1Publisher | Ros1Subscriber,
        node: str,
        fault: str,
        *,
        publishes: bool,
    ) -> None:
        """List a conflict at its topic; it is logged once, although it is tried again often."""
        if registration.fault != fault:
            text = f"{node} exchanges no messages on {topic.name}: {fault}"
            logger.warning("%s", shortened(text))
        registration.fault = fault
        self._graph.add_conflict(topic, Conflict(node, registration.type, publishes, fault))
        self._types_in_conflict[topic.name] = topic.type

    def _detach_conflict(self, topic: str, node: str, *, publishes: bool) -> None:
        found = self._graph.topics.get(topic)
        if found is not None:
            self._graph.remove_conflict(found, node, publishes=publishes)

    def _detach_source(self, publisher: Ros1Publisher) -> None:
        source, publisher.source = publisher.source, None
        if source is not None:
            self._graph.remove_source(source)

    # Removing.

    def _remove_publisher(self, publisher: Ros1Publisher) -> None:
        node, topic = publisher.node, publisher.topic
        del node.publishers[topic]
        _remove(self._publishers, topic, node.name)
        self._detach_source(publisher)
        self._detach_conflict(topic, node.name, publishes=True)
        self._mark(topic)
        self.changed()

    def _remove_subscriber(self, subscriber: Ros1Subscriber) -> None:
        node, topic = subscriber.owner, subscriber.topic
        del node.subscribers[topic]
        _remove(self._subscribers, topic, node.name)
        found = self._graph.topics.get(topic)
        if found is not None:
            self._graph.unsubscribe(found, subscriber)
        self._detach_conflict(topic, node.name, publishes=False)
        self._mark(topic)
        self.changed()

    def _remove_service(self, node: Ros1Node, service: str) -> None:
        del node.services[service]
        self._services.pop(service, None)
        self.service_links.unregister(node, service)
        self.changed()

    def _settle(self, node: Ros1Node) -> None:
        """Remove a node without registrations, as ROS's master does."""
        if node.is_empty and self.by_name.get(node.name) is node:
            self.remove(node)

    def _drop(self, node: Ros1Node) -> None:
        """Remove all registrations of a node."""
        for publisher in list(node.publishers.values()):
            self._remove_publisher(publisher)
        for subscriber in list(node.subscribers.values()):
            self._remove_subscriber(subscriber)
        for service in list(node.services):
            self._remove_service(node, service)
        if self.by_name.get(node.name) is node:
            del self.by_name[node.name]
        if not self.at(node.api):
            self._calls.forget(node.api)
            self.gone(node.api)
        self.changed()

    # Telling others.

    def _mark(self, topic: str) -> None:
        if self._is_closed:
            return
        self._graph.revision += 1
        self._dirty[topic] = None
        if not self._is_update_due:
            self._is_update_due = True
            asyncio.get_running_loop().call_soon(self._update)

    def _update(self) -> None:
        """Update the topics that have changed, for as long as a turn lasts."""
        until = perf_counter() + TURN
        try:
            for _ in range(len(self._dirty)):
                if self._is_closed:
                    return
                name = next(iter(self._dirty))
                del self._dirty[name]
                self._update_topic(name)
                if perf_counter() > until:
                    return
        finally:
            self._is_update_due = bool(self._dirty) and not self._is_closed
            if self._is_update_due:
                asyncio.get_running_loop().call_soon(self._update)

    def _update_topic(self, name: str) -> None:
        """Bring links up to date, and send subscribers the publishers that have changed."""
        topic = self._graph.topic(name)
        if topic.conflicts:
            self._retry(topic)
        else:
            self._types_in_conflict.pop(name, None)
        # An action's status may have no ROS 1 node, and decide who its goals are for.
        self.links.changed(self._graph.topic(name))
        for subscriber in self.subscribers(name):
            apis = self.publisher_apis(name, subscriber.owner.hub_host)
            if subscriber.sent != apis:
                subscriber.sent = apis
                self._calls.notify(
                    subscriber.owner.api, name, "publisherUpdate", MASTER, name, apis
                )

    def _retry(self, topic: Topic) -> None:
        """Attach the registrations that conflicted with a topic's type, if it has another now."""
        name = topic.name
        if topic.type is self._types_in_conflict.get(name):
            return
        for node, _, publishes, _ in list(topic.conflicts):
            if self._graph.topic(name).held:
                break
            self._detach_conflict(name, node, publishes=publishes)
            if publishes:
                publisher = self._publishers.get(name, {}).get(node)
                if publisher is not None:
                    self._attach_publisher(publisher)
            else:
                subscriber = self.subscriber(node, name)
                if subscriber is not None:
                    self._attach_subscriber(subscriber)
        self._types_in_conflict[name] = self._graph.topic(name).type

    def run(
        self, coroutine: Coroutine[Any, Any, None], done: Callable[[str], object]
    ) -> Callable[[], object]:
        """Run a coroutine, and call ``done`` with the text of its `Ros1Error`, or an empty one.

        Returns:
            A function that cancels it, whereupon ``done`` is not called.
        """

        async def run() -> None:
            try:
                await coroutine
            except Ros1Error as error:
                done(str(error))
            else:
                done("")

        return self._start(run()).cancel

    def _start(self, coroutine: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def close(self) -> None:
        """Remove the nodes from the graph; the next hub finds them by the state file."""
        self._is_closed = True
        for node in list(self.by_name.values()):
            self.remove(node)
        tasks = list(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def is_api(uri: str) -> bool:
    """Return whether a URI can be that of a node's XML-RPC server."""
    try:
        url = urlsplit(uri)
        return url.scheme == "http" and bool(url.hostname) and url.port is not None
    except ValueError:
        return False


def _is_same(present: MessageType, type_: str, md5sum: str) -> bool:
    """Return whether the type that a publisher tells a link is the one that it had before."""
    if present.md5sum is None or md5sum == ANY:
        return present.name == type_
    return present.md5sum == md5sum


def _remove(registrations: dict[str, dict[str, Any]], topic: str, node: str) -> None:
    del registrations[topic][node]
    if not registrations[topic]:
        del registrations[topic]


def _fault(error: Ros1Error) -> str:
    return error.fault if isinstance(error, NodeUnreachable) else str(error)


def _has_ended(node: Ros1Node) -> bool:
    """Return whether a node ran on this machine and its process has ended."""
    host = urlsplit(node.api).hostname
    if node.pid is None or host not in (node.hub_host, "localhost", "127.0.0.1", gethostname()):
        return False
    try:
        os.kill(node.pid, 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False
    return False
