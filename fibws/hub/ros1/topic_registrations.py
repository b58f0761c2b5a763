"""The topics of ROS 1 nodes: registrations of publishers and subscribers in the graph.

What a node publishes and subscribes to is a source or a sink of the graph's topic, so that every
tool sees one graph. A ROS 1 master refuses nobody: a node that uses a topic with another type than
it has there is registered, and found by other ROS 1 nodes, but it exchanges no messages with the
hub's clients; the topic lists it among its conflicts. The same goes for what the policy forbids.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Container, Iterable, Iterator
from functools import partial
from itertools import chain
from typing import Any, Protocol

from fibws.errors import FibwsError, InterfaceError
from fibws.hub.foreign.nodes import ForeignNode
from fibws.hub.foreign.topics import ForeignPublisher, ForeignSubscriber, ForeignTopics
from fibws.hub.foreign.warnings import OneTimeWarnings
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.nodes import ExternalNode
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Receiver, SinkReport, Source, Topic
from fibws.hub.graph.types import MessageType
from fibws.hub.ros1.http import NodeCalls

CLIENT = "ros1"
"""The policy's name for all ROS 1 programs, because their own names are not proven. Names of nodes
begin with a slash, so that none is equal to it."""
MASTER = "/master"
"""The caller_id of the master's own calls."""
ANY = "*"
"""The type of a subscriber that takes every message."""


class RegisteredLinks(Protocol):
    """The connections by which ROS 1 nodes exchange messages with the hub's clients."""

    def outlet(self, topic: str) -> Receiver:
        """Return what takes the messages of a topic for all ROS 1 subscribers."""

    def changed(self, topic: Topic) -> None:
        """Called when publishers or subscribers of a topic have changed."""


class TopicLink(Receiver, Protocol):
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


class Ros1Publisher(ForeignPublisher):
    """A ROS 1 node's registration as a publisher of a topic.

    Attributes:
        type: ``package/Type`` as it was registered, or ``*``.
        is_relayed: whether a link may be opened for it: its type is the topic's, or not known yet.
    """

    __slots__ = ("is_relayed", "topic")

    node: Registrant
    type: str

    def __init__(self, node: Registrant, topic: str, type_: str) -> None:
        super().__init__(node, type_)
        self.topic = topic
        self.is_relayed = True

    @property
    def type_name(self) -> str:
        """The name of its type."""
        return self.type


class Ros1Subscriber(ForeignSubscriber):
    """A ROS 1 node's registration as a subscriber of a topic.

    Attributes:
        type: ``package/Type`` as it was registered, or ``*``.
        sent: the addresses of publishers that it was sent last; None before that.
        md5sum: of the type that it names, if it has told one that others publish.
        link: its connection to the hub, while there is one; the newest of several.
    """

    __slots__ = ("_dropped", "_messages", "link", "md5sum", "sent", "topic")

    owner: Registrant
    type: str

    def __init__(self, owner: Registrant, topic: str, type_: str, outlet: Receiver) -> None:
        super().__init__(owner, type_, outlet)
        self.topic = topic
        self.sent: list[str] | None = None
        self.md5sum: str | None = None
        self.link: TopicLink | None = None
        self._messages = 0
        self._dropped = 0

    @property
    def type_name(self) -> str:
        """The name of its type."""
        return self.type

    def receive(self, publication: Publication) -> None:
        """Take a message for this subscriber alone; the topic's outlet takes those for all."""
        if self.link is not None:
            self.link.receive(publication)

    def report(self) -> SinkReport:
        """Return the totals of all its connections."""
        present = self.link.report() if self.link is not None else SinkReport()
        return present._replace(
            messages=present.messages + self._messages, dropped=present.dropped + self._dropped
        )

    def unlink(self, ended: TopicLink, other: TopicLink | None) -> None:
        """Keep the totals of a connection that has ended, and use another one if there is one."""
        totals = ended.report()
        self._messages += totals.messages
        self._dropped += totals.dropped
        if self.link is ended:
            self.link = other


class TopicRegistrations(ForeignTopics[Ros1Publisher, Ros1Subscriber]):
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
        super().__init__(graph, OneTimeWarnings())
        self.links: RegisteredLinks
        self._calls = calls
        self._names = names
        self._quota = quota
        self._port = port
        self._changed = changed
        self._publishers: dict[str, dict[str, Ros1Publisher]] = {}
        """By topic and node."""
        self._subscribers: dict[str, dict[str, Ros1Subscriber]] = {}
        self._work = Worklist(
            lambda run: asyncio.get_running_loop().call_soon(run), {"topics": self._update_topic}
        )
        """The topics whose publishers or subscribers have changed since they were updated."""
        graph.watch_topics(lambda topic: self._mark(topic.name))

    def close(self) -> None:
        """Stop sending updates to nodes."""
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
        if not self._graph.rights.allows(CLIENT, "subscribe", topic):
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
        may_publish = self._graph.rights.allows(CLIENT, "publish", topic)
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
        self.attach_publisher(topic, publisher)
        self._mark(topic)
        self._changed()

    def add_subscriber(self, node: Registrant, topic: str, type_: str) -> None:
        """Register a subscriber."""
        older = self._subscribers.get(topic, {}).get(node.name)
        if older is not None:
            if older.owner is node and type_ in (older.type, ANY):
                return
            self.remove_subscriber(older)
        subscriber = Ros1Subscriber(node, topic, type_, self.links.outlet(topic))
        node.subscribed[topic] = self._subscribers.setdefault(topic, {})[node.name] = subscriber
        self.attach_subscriber(topic, subscriber)
        self._mark(topic)
        self._changed()

    def remove_publisher(self, publisher: Ros1Publisher) -> None:
        """Remove a registration; the second time nothing happens."""
        node, topic = publisher.node, publisher.topic
        if node.published.pop(topic, None) is None:
            return
        _remove(self._publishers, topic, node.name)
        self.detach_user(topic, publisher)
        self._mark(topic)
        self._changed()

    def remove_subscriber(self, subscriber: Ros1Subscriber) -> None:
        """Remove a registration; the second time nothing happens."""
        node, topic = subscriber.owner, subscriber.topic
        if node.subscribed.pop(topic, None) is None:
            return
        _remove(self._subscribers, topic, node.name)
        self.detach_user(topic, subscriber)
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
        source = publisher.source
        if source is None or not _is_same(source.type, type_, md5sum):
            # It must not be held to the type that it had before.
            self.detach_user(publisher.topic, publisher)
        self.attach_publisher(publisher.topic, publisher, definition=definition, md5sum=md5sum)
        return publisher.source

    def apply_rights(self, node: Registrant) -> None:
        """Attach what a node may use now, and detach what it may not."""
        graph = self._graph
        for topic, publisher in node.published.items():
            if graph.rights.allows(node.name, "publish", topic) is not publisher.is_attached:
                self.attach_again(topic, publisher)
        for topic, subscriber in node.subscribed.items():
            if graph.rights.allows(node.name, "subscribe", topic) is not subscriber.is_attached:
                self.attach_again(topic, subscriber)
        for topic in (*node.published, *node.subscribed):
            self._mark(topic)

    # Attaching to the graph.

    def advertise(
        self,
        topic: Topic,
        publisher: Ros1Publisher,
        definition: str | None = None,
        md5sum: str | None = None,
    ) -> Source | None:
        """See `ForeignTopics`."""
        publisher.is_relayed = True
        if publisher.type == ANY:
            return publisher.source
        try:
            return self._graph.advertise(
                topic,
                publisher.name,
                publisher.type,
                definition,
                quota=self._quota(),
                serialized=md5sum is not None,
                md5sum=md5sum,
                linked=False,
                on_conflict=self.reporter(publisher),
            )
        except FibwsError as error:
            # An unknown type may become known by the definition that the publisher sends.
            publisher.is_relayed = isinstance(error, InterfaceError) and md5sum is None
            raise

    def name_md5(self, subscriber: Ros1Subscriber, md5sum: str) -> None:
        """Subscribe with the md5 that a subscriber tells, if others publish that type."""
        topic = self._graph.topic(subscriber.topic)
        own = topic.type_for(subscriber)
        is_known = own is None or md5sum in (ANY, own.md5sum) or own.name != subscriber.type
        if not is_known and any(each and each.md5sum == md5sum for each in topic.types()):
            subscriber.md5sum = md5sum
            self.attach_subscriber(topic.name, subscriber)

    def subscribe(self, topic: Topic, subscriber: Ros1Subscriber) -> None:
        """See `ForeignTopics`."""
        follow = partial(self.attach_subscriber, topic.name, subscriber)
        self._graph.subscribe(
            topic,
            subscriber,
            None if subscriber.type == ANY else subscriber.type,
            receiver=lambda group: subscriber.outlet,
            follow=follow if subscriber.md5sum is None else None,
            md5sum=subscriber.md5sum,
            linked=False,
            on_conflict=self.reporter(subscriber),
        )

    # Removing.

    def removals(self, node: Registrant) -> Iterator[Callable[[], None]]:
        """Return functions that remove the registrations of a node that has left."""
        publishers, subscribers = list(node.published.values()), list(node.subscribed.values())
        self.abandon(publishers, subscribers)
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
        if self._graph.topic(name).unattached:
            for user in (*self.publishers(name), *self.subscribers(name)):
                if self.is_due_again(self._graph.topic(name), user):
                    self.attach_again(name, user)
        # An action's status may have no ROS 1 node, and decide who its goals are for.
        self.links.changed(self._graph.topic(name))
        for subscriber in self.subscribers(name):
            apis = self.publisher_apis(name, subscriber.owner.hub_host, subscriber)
            if subscriber.sent != apis:
                subscriber.sent = apis
                self._calls.notify(
                    subscriber.owner.api, name, "publisherUpdate", MASTER, name, apis
                )


def _is_same(present: MessageType, type_: str, md5sum: str) -> bool:
    """Return whether the type that a publisher sends to a link is its present one."""
    if present.md5sum is None or md5sum == ANY:
        return present.name == type_
    return present.md5sum == md5sum


def _remove(registrations: dict[str, dict[str, Any]], topic: str, node: str) -> None:
    del registrations[topic][node]
    if not registrations[topic]:
        del registrations[topic]
