"""The topics of ROS 1 nodes: registrations of publishers and subscribers in the graph.

What a node publishes and subscribes to is a source or a sink of the graph's topic, so that every
tool sees one graph. A ROS 1 master refuses nobody: a node that uses a topic with another type than
it has there is registered, and found by other ROS 1 nodes, but it exchanges no messages with the
hub's clients; the topic lists it among its conflicts. The same goes for what the policy forbids.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Container, Iterable, Iterator
from functools import partial
from itertools import chain
from typing import Any, Protocol

from fibws.errors import InterfaceError, InvalidMessage, NotAllowed, OperationError
from fibws.hub.foreign.nodes import ForeignNode
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.graph import ExternalNode, Graph
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Conflict, Receiver, SinkReport, Source, Topic
from fibws.hub.graph.types import MessageType
from fibws.hub.log_text import shortened
from fibws.hub.ros1.http import NodeCalls

logger = logging.getLogger("fibws.hub")

CLIENT = "ros1"
"""The policy's name for all ROS 1 programs, because their own names are not proven. Names of nodes
begin with a slash, so that none is equal to it."""
MASTER = "/master"
"""The caller_id of the master's own calls."""
ANY = "*"
"""The type of a subscriber that takes every message."""


class Links(Protocol):
    """The connections by which ROS 1 nodes exchange messages with the hub's clients."""

    def outlet(self, topic: str) -> Receiver:
        """Return what takes the messages of a topic for all ROS 1 subscribers."""

    def changed(self, topic: Topic) -> None:
        """Take note that publishers or subscribers of a topic have changed."""


class Link(Receiver, Protocol):
    """A connection to a ROS 1 subscriber."""

    def report(self) -> SinkReport:
        """Return its totals."""


class Registrant(ForeignNode, ExternalNode):
    """A ROS 1 node, as its registrations know it.

    Attributes:
        api: the URI of its XML-RPC server.
        hub_host: the address by which it reached the hub.
    """

    hub_host: str
    published: dict[str, Ros1Publisher]
    subscribed: dict[str, Ros1Subscriber]


class Ros1Publisher:
    """A ROS 1 node's registration as a publisher of a topic.

    Attributes:
        type: ``package/Type`` as it was registered, or ``*``.
        source: the node's source of the graph; None while it may not exchange messages with it.
        is_relayed: whether a link may be opened for it: its type is the topic's, or not known yet.
        fault: why it conflicts with the topic; empty if it does not.
    """

    __slots__ = ("fault", "is_relayed", "node", "source", "topic", "type")

    def __init__(self, node: Registrant, topic: str, type_: str) -> None:
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

    def __init__(self, owner: Registrant, topic: str, type_: str) -> None:
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


class TopicRegistrations:
    """The publishers and subscribers of all ROS 1 nodes.

    Args:
        names: the names of the registered nodes.
        quota: returns the bound of a node's latched messages.
        port: returns the port of the hub's master.
        changed: called after each change of the registrations.

    Attributes:
        links: set before the first node registers.
    """

    def __init__(
        self,
        graph: Graph,
        calls: NodeCalls,
        names: Container[str],
        *,
        quota: Callable[[], LatchQuota],
        port: Callable[[], int],
        changed: Callable[[], object],
    ) -> None:
        self.links: Links
        self._graph = graph
        self._calls = calls
        self._names = names
        self._quota = quota
        self._port = port
        self._changed = changed
        self._publishers: dict[str, dict[str, Ros1Publisher]] = {}
        """By topic and node."""
        self._subscribers: dict[str, dict[str, Ros1Subscriber]] = {}
        self._types_in_conflict: dict[str, MessageType | None] = {}
        """By topic: the type that it had when nodes conflicted with it."""
        self._work = Worklist(
            lambda run: asyncio.get_running_loop().call_soon(run), {"topics": self._update_topic}
        )
        """The topics whose publishers or subscribers have changed since they were updated."""
        graph.watch_topics(lambda topic: self._mark(topic.name))

    def close(self) -> None:
        """Send no more updates to nodes."""
        self._work.close()

    # Looking up.

    def publishers(self, topic: str) -> list[Ros1Publisher]:
        """Return the ROS 1 publishers of a topic."""
        return list(self._publishers.get(topic, {}).values())

    def subscribers(self, topic: str) -> list[Ros1Subscriber]:
        """Return the ROS 1 subscribers of a topic."""
        return list(self._subscribers.get(topic, {}).values())

    def names(self) -> Iterable[str]:
        """Return the topics of all registrations."""
        return {**self._publishers, **self._subscribers}

    def subscriber(self, node: str, topic: str) -> Ros1Subscriber | None:
        """Return a node's registration as a subscriber."""
        return self._subscribers.get(topic, {}).get(node)

    def hub_api(self, hub_host: str, node: str = "") -> str:
        """Return the URI of the hub, or of a node, for clients that reach the hub at this host.

        roscpp identifies publishers by host and port, so that publishers are always the hub.
        """
        host = f"[{hub_host}]" if ":" in hub_host else hub_host
        return f"http://{host}:{self._port()}/{f'node{node}' if node else ''}"

    def publisher_apis(
        self, topic: str, hub_host: str, subscriber: Ros1Subscriber | None
    ) -> list[str]:
        """Return the URIs of a topic's publishers, the hub's once for all of its clients.

        The hub is left out where ROS 1 may not subscribe, and where none of its clients publishes
        with the type of the subscriber.
        """
        apis = dict.fromkeys(each.node.api for each in self.publishers(topic))
        if self.has_own_sources(topic, subscriber):
            apis[self.hub_api(hub_host)] = None
        return list(apis)

    def is_publisher(self, node: str, topic: str) -> bool:
        """Return whether a ROS 1 node of this name publishes a topic."""
        return node in self._publishers.get(topic, ())

    def has_own_sources(self, topic: str, subscriber: Ros1Subscriber | None = None) -> bool:
        """Return whether ROS 1 may subscribe to a topic, and others than ROS 1 nodes publish it.

        Args:
            subscriber: the one for which their type must fit; None for any type.
        """
        if not self._graph.is_allowed(CLIENT, "subscribe", topic):
            return False
        found = self._graph.topics.get(topic)
        if found is None:
            return False
        groups = found.groups if subscriber is None else found.groups_for(subscriber)
        return any(
            node not in self._names and not self._graph.has_left(source)
            for group in groups
            for node, source in group.sources.items()
        )

    def subscriber_apis(self, topic: str, hub_host: str) -> list[str]:
        """Return the URIs of a topic's subscribers, the hub's once for all of its clients.

        The hub is left out where ROS 1 may not publish.
        """
        apis = dict.fromkeys(each.owner.api for each in self.subscribers(topic))
        may_publish = self._graph.is_allowed(CLIENT, "publish", topic)
        found = self._graph.topics.get(topic) if may_publish else None
        if found is not None and any(
            sink.node not in self._names and not self._graph.has_left(sink)
            for sink in found.all_sinks()
        ):
            apis[self.hub_api(hub_host)] = None
        return list(apis)

    # Registering.

    def add_publisher(self, node: Registrant, topic: str, type_: str) -> None:
        """Register a publisher."""
        older = self._publishers.get(topic, {}).get(node.name)
        if older is not None:
            if older.node is node and type_ in (older.type, ANY):
                return
            self.remove_publisher(older)
        publisher = Ros1Publisher(node, topic, type_)
        node.published[topic] = self._publishers.setdefault(topic, {})[node.name] = publisher
        self._attach_publisher(publisher)
        self._mark(topic)
        self._changed()

    def add_subscriber(self, node: Registrant, topic: str, type_: str) -> None:
        """Register a subscriber."""
        older = self._subscribers.get(topic, {}).get(node.name)
        if older is not None:
            if older.owner is node and type_ in (older.type, ANY):
                return
            self.remove_subscriber(older)
        subscriber = Ros1Subscriber(node, topic, type_)
        node.subscribed[topic] = self._subscribers.setdefault(topic, {})[node.name] = subscriber
        self._attach_subscriber(subscriber)
        self._mark(topic)
        self._changed()

    def remove_publisher(self, publisher: Ros1Publisher) -> None:
        """Remove a registration; the second time nothing happens."""
        node, topic = publisher.node, publisher.topic
        if node.published.pop(topic, None) is None:
            return
        _remove(self._publishers, topic, node.name)
        self._detach_source(publisher)
        self._detach_conflict(topic, node.name, publishes=True)
        self._mark(topic)
        self._changed()

    def remove_subscriber(self, subscriber: Ros1Subscriber) -> None:
        """Remove a registration; the second time nothing happens."""
        node, topic = subscriber.owner, subscriber.topic
        if node.subscribed.pop(topic, None) is None:
            return
        _remove(self._subscribers, topic, node.name)
        found = self._graph.topics.get(topic)
        if found is not None:
            self._graph.unsubscribe(found, subscriber)
        self._detach_conflict(topic, node.name, publishes=False)
        self._mark(topic)
        self._changed()

    def learn(
        self, publisher: Ros1Publisher, type_: str, definition: str | None, md5sum: str
    ) -> Source | None:
        """Set the type that a publisher has sent to a link, and return its source.

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

    def apply_rights(self, node: Registrant) -> None:
        """Attach what a node may use now, and detach what it may not."""
        graph = self._graph
        for topic, publisher in node.published.items():
            is_allowed = graph.is_allowed(node.name, "publish", topic)
            if is_allowed is not (publisher.source is not None):
                self._detach_source(publisher)
                self._detach_conflict(topic, node.name, publishes=True)
                self._attach_publisher(publisher)
        for topic, subscriber in node.subscribed.items():
            is_allowed = graph.is_allowed(node.name, "subscribe", topic)
            if is_allowed is not graph.topic(topic).has_sink(subscriber):
                graph.unsubscribe(graph.topic(topic), subscriber)
                self._detach_conflict(topic, node.name, publishes=False)
                self._attach_subscriber(subscriber)
        for topic in (*node.published, *node.subscribed):
            self._mark(topic)

    # Attaching to the graph.

    def _attach_publisher(
        self, publisher: Ros1Publisher, definition: str | None = None, md5sum: str | None = None
    ) -> None:
        publisher.is_relayed = True
        if publisher.type == ANY:
            return
        topic = self._graph.topic(publisher.topic)
        node = publisher.node.name
        try:
            publisher.source = self._graph.advertise(
                topic,
                node,
                publisher.type,
                definition,
                quota=self._quota(),
                serialized=md5sum is not None,
                md5sum=md5sum,
                linked=False,
                on_conflict=partial(self._log_conflict, node),
            )
        except (NotAllowed, OperationError, InterfaceError, InvalidMessage) as error:
            # An unknown type may become known by the definition that the publisher sends.
            publisher.is_relayed = isinstance(error, InterfaceError) and md5sum is None
            self._detach_source(publisher)
            self._conflict(topic, publisher, node, str(error), publishes=True)
        else:
            publisher.fault = ""

    def name_md5(self, subscriber: Ros1Subscriber, md5sum: str) -> None:
        """Subscribe with the md5 that a subscriber tells, if others publish that type."""
        topic = self._graph.topic(subscriber.topic)
        own = topic.type_for(subscriber)
        is_known = own is None or md5sum in (ANY, own.md5sum) or own.name != subscriber.type
        if not is_known and any(each and each.md5sum == md5sum for each in topic.types()):
            self._attach_subscriber(subscriber, md5sum)

    def _attach_subscriber(self, subscriber: Ros1Subscriber, md5sum: str | None = None) -> None:
        topic = self._graph.topic(subscriber.topic)
        type_ = None if subscriber.type == ANY else subscriber.type
        try:
            outlet = self.links.outlet(topic.name)
            report = partial(self._log_conflict, subscriber.node)
            self._graph.subscribe(
                topic,
                subscriber,
                type_,
                receiver=lambda group: outlet,
                follow=partial(self._attach_subscriber, subscriber) if md5sum is None else None,
                md5sum=md5sum,
                linked=False,
                on_conflict=report,
            )
        except (NotAllowed, OperationError, InterfaceError) as error:
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

    def _log_conflict(self, node: str, text: str) -> None:
        if text:
            logger.warning("%s", shortened(f"{node}: {text}"))

    def _detach_conflict(self, topic: str, node: str, *, publishes: bool) -> None:
        found = self._graph.topics.get(topic)
        if found is not None:
            self._graph.remove_conflict(found, node, publishes=publishes)

    def _detach_source(self, publisher: Ros1Publisher) -> None:
        source, publisher.source = publisher.source, None
        if source is not None:
            self._graph.remove_source(source)

    # Removing.

    def abandon(self, node: Registrant) -> Iterator[Callable[[], None]]:
        """Take note that a node has left; return functions that remove its registrations."""
        publishers, subscribers = list(node.published.values()), list(node.subscribed.values())
        sources = (each.source for each in publishers)
        self._graph.abandon(source for source in sources if source is not None)
        self._graph.abandon(each for each in subscribers if not each.fault)
        return chain(
            (partial(self.remove_publisher, each) for each in publishers),
            (partial(self.remove_subscriber, each) for each in subscribers),
        )

    # Sending updates.

    def _mark(self, topic: str) -> None:
        self._graph.revision += 1
        self._work.add("topics", topic)

    def _update_topic(self, name: str) -> None:
        """Bring links up to date, and send subscribers the publishers that have changed."""
        topic = self._graph.topic(name)
        if topic.unattached:
            self._retry(topic)
        else:
            self._types_in_conflict.pop(name, None)
        # An action's status may have no ROS 1 node, and decide who its goals are for.
        self.links.changed(self._graph.topic(name))
        for subscriber in self.subscribers(name):
            apis = self.publisher_apis(name, subscriber.owner.hub_host, subscriber)
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
        for node, _, publishes, _ in list(topic.unattached):
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


def _is_same(present: MessageType, type_: str, md5sum: str) -> bool:
    """Return whether the type that a publisher sends to a link is its present one."""
    if present.md5sum is None or md5sum == ANY:
        return present.name == type_
    return present.md5sum == md5sum


def _remove(registrations: dict[str, dict[str, Any]], topic: str, node: str) -> None:
    del registrations[topic][node]
    if not registrations[topic]:
        del registrations[topic]
