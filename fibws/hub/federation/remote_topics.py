"""Publishers and subscribers of other hubs in this hub's graph."""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeAlias

from fibws.errors import FibwsError, InterfaceError, LimitReached, OperationError
from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.federation.announced import Announced, PeerGraph, RemoteUsers
from fibws.hub.federation.definitions import DefinitionPending, RemoteDefinitions
from fibws.hub.federation.outlets import Outlet, Outlets
from fibws.hub.federation.records import Message, Publisher
from fibws.hub.federation.remote_logs import ROSOUT
from fibws.hub.federation.remote_nodes import RemoteNode, attached_node
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Conflict, SinkReport, Source, Topic
from fibws.hub.log_text import is_power_of_ten, printable

logger = logging.getLogger("fibws.hub")

LINGER = 2.0
"""Seconds for which messages still come when nobody subscribes any more."""
MOST_REMEMBERED = 10_000
"""Publishers whose last sequence number is remembered after their hub was lost."""

PublisherId: TypeAlias = tuple[str, int]
"""The id of a publisher's hub, and the publisher's number there."""
NOT_TRIED: Any = object()
"""Stands for a type of a topic that is unlike all others, and unlike None."""


class RemotePublisher:
    """A publisher of another hub, with its source in this graph.

    Attributes:
        type: the name and the md5 of its type.
        source: None while it cannot be attached.
        tried_with: the topic's types when that failed.
        is_wanted: whether the hub was asked for its messages.
        is_flowing: whether they pass.
        sequence: that of the last message; None before the first.
        stamp: that of the last message; see `Message`.
        lost: messages that it has sent and that have not arrived.
    """

    __slots__ = (
        "_invalid",
        "_is_first",
        "home",
        "is_flowing",
        "is_wanted",
        "lingering",
        "lost",
        "node",
        "publisher",
        "sequence",
        "source",
        "stamp",
        "tried_with",
        "type",
    )

    def __init__(
        self, home: PeerGraph, node: RemoteNode, publisher: Publisher, type_: tuple[str, str]
    ) -> None:
        self.home = home
        self.node = node
        self.publisher = publisher
        self.type = type_
        self.source: Source | None = None
        self.tried_with: Any = NOT_TRIED
        self.is_wanted = False
        self.is_flowing = False
        self.lingering: Timer | None = None
        self.sequence: int | None = None
        self.stamp = 0
        self.lost = 0
        self._invalid = 0
        self._is_first = True

    @property
    def id(self) -> PublisherId:
        """Its identity on all ways to it."""
        return self.node.hub.id, self.publisher.origin

    def receive(self, message: Message) -> None:
        """Deliver a message, unless it has been delivered before."""
        source, last, is_first = self.source, self.sequence, self._is_first
        if source is None or not self.is_wanted:
            return
        self._is_first = False
        if last is not None:
            # A latched message comes again after a hub was lost: nobody else keeps it.
            if message.sequence <= last and not (is_first and source.latch):
                return
            lost = max(0, message.sequence - last - 1)
            self.lost += lost
            self.home.peer.traffic.lost += lost
        self.sequence = message.sequence
        self.stamp = message.stamp
        try:
            source.relay(message.data)
        except LimitReached as error:
            logger.warning("%s: %s", self.node.name, error)
        except FibwsError as error:
            self._invalid += 1
            if is_power_of_ten(self._invalid):
                text = "%s (hub %s): invalid message of %s (%d so far): %s"
                hub, topic = printable(self.node.hub.name), source.topic.name
                logger.warning(text, self.node.name, hub, topic, self._invalid, error)


class RemoteSubscriber:
    """A subscriber of another hub; a `Sink`, for which the topic's outlet takes messages.

    Attributes:
        type: the name and the md5 of its type.
        is_stuck: whether it could not be attached; then ``tried_with`` are the topic's types
            by which that failed.
    """

    __slots__ = ("is_stuck", "node", "outlet", "remote", "tried_with", "type")

    def __init__(self, remote: RemoteNode, type_: tuple[str, str], outlet: Outlet) -> None:
        self.node = remote.name
        self.remote = remote
        self.type = type_
        self.outlet = outlet
        self.is_stuck = False
        self.tried_with: Any = NOT_TRIED

    def receive(self, publication: Publication) -> None:
        """Take a message for this subscriber alone, which goes to all of its hub."""
        self.outlet.receive(publication)

    def replay(self, publication: Publication) -> None:
        """Do nothing: its hub gets latched messages once it asks for their publisher."""

    def report(self) -> SinkReport:
        """Return no totals: only the other hub knows what it was sent."""
        return SinkReport()


@dataclass(slots=True)
class Attached:
    """The publishers and subscribers of other hubs that are attached to a topic.

    Publishers are by node, subscribers by node and type: one without a type of its own is
    announced for all types of its hub's topic.
    """

    publishers: dict[str, RemotePublisher] = field(default_factory=dict)
    subscribers: dict[tuple[str, str], RemoteSubscriber] = field(default_factory=dict)


WantedPublishers: TypeAlias = dict[str, tuple[RemoteNode, Publisher, RemoteUsers]]
WantedSubscribers: TypeAlias = dict[tuple[str, str], tuple[RemoteNode, RemoteUsers]]


class RemoteTopics:
    """Attaches the publishers and subscribers that other hubs announce.

    Args:
        flowing: called when messages of a remote publisher pass.
        warn: logs a warning, once.

    Attributes:
        by_source: the remote publisher of each source.
    """

    def __init__(
        self,
        graph: Graph,
        announced: Announced,
        definitions: RemoteDefinitions,
        outlets: Outlets,
        clock: Clock,
        *,
        flowing: Callable[[RemotePublisher], None],
        warn: Callable[[str], None],
    ) -> None:
        self.by_source: dict[Source, RemotePublisher] = {}
        self._graph = graph
        self._announced = announced
        self._definitions = definitions
        self._outlets = outlets
        self._clock = clock
        self._flowing = flowing
        self._warn = warn
        self._attached: dict[str, Attached] = {}
        """By topic."""
        self._by_number: dict[tuple[PeerGraph, int], RemotePublisher] = {}
        self._remembered: OrderedDict[PublisherId, int] = OrderedDict()
        """The last sequence numbers of publishers whose hubs were lost."""

    # Messages.

    def received(self, home: PeerGraph, message: Message) -> None:
        """Deliver a message."""
        publisher = self._by_number.get((home, message.number))
        if publisher is not None:
            publisher.receive(message)

    def is_flowing(self, home: PeerGraph, number: int) -> None:
        """Take note that messages of a publisher pass."""
        publisher = self._by_number.get((home, number))
        if publisher is not None and publisher.is_wanted and publisher.source is not None:
            publisher.is_flowing = True
            publisher.source.link()
            self._flowing(publisher)

    # Attaching.

    def uses(self, topic: str) -> bool:
        """Return whether other hubs use a topic."""
        return topic in self._attached or bool(self._announced.of("topics", topic))

    def users_of(self, node: RemoteNode) -> Iterator[Source | RemoteSubscriber]:
        """Yield the sources and the sinks of a node that are attached."""
        for topic in node.published:
            publisher = self._attached[topic].publishers.get(node.name)
            if publisher is not None and publisher.node is node and publisher.source is not None:
                yield publisher.source
        for topic in node.subscribed:
            for sink in self._attached[topic].subscribers.values():
                if sink.remote is node:
                    yield sink

    def settle(self, name: str) -> None:
        """Attach what should be attached to a topic, and detach what should not."""
        attached = self._attached.setdefault(name, Attached())
        publishers: WantedPublishers = {}
        subscribers: WantedSubscribers = {}
        graph = self._graph
        for home, record in self._announced.of("topics", name).items():
            for users in record.by_type:
                for node, publisher in users.publishers.items():
                    if remote := attached_node(graph, node, home):
                        publishers[node] = remote, publisher, users
                for node in users.subscribers:
                    if remote := attached_node(graph, node, home):
                        subscribers[node, users.type] = remote, users
        self._settle_publishers(name, attached, publishers)
        self._settle_subscribers(name, attached, subscribers)
        if attached.publishers:
            self._settle_interest(attached)
        elif not attached.subscribers:
            del self._attached[name]

    def try_again(self, topic: str) -> None:
        """Attach the publishers that wait for a definition in the next `settle`."""
        for publisher in self._attached.get(topic, Attached()).publishers.values():
            if publisher.source is None:
                publisher.tried_with = NOT_TRIED

    def _settle_publishers(self, name: str, attached: Attached, wanted: WantedPublishers) -> None:
        for node, old in list(attached.publishers.items()):
            found = wanted.get(node)
            is_same = found is not None and (
                (old.node, old.publisher, old.type)
                == (found[0], found[1], (found[2].type, found[2].md5sum))
            )
            is_due = old.source is None and old.tried_with != self._graph.topic(name).types()
            if not is_same or is_due:
                self._detach_publisher(name, attached, old)
        for node, (remote, publisher, record) in wanted.items():
            if node not in attached.publishers:
                type_ = record.type, record.md5sum
                new = RemotePublisher(remote.home, remote, publisher, type_)
                self._attach_publisher(name, attached, new)

    def _attach_publisher(self, name: str, attached: Attached, new: RemotePublisher) -> None:
        topic, node = self._graph.topic(name), new.node.name
        attached.publishers[node] = new
        new.node.published[name] = None
        try:
            new.source = self._advertise(topic, new)
        except DefinitionPending:
            pass
        except (OperationError, InterfaceError) as error:
            self._conflict(topic, node, new.type[0], error, publishes=True)
        if new.source is None:
            new.tried_with = self._graph.topic(name).types()
            return
        new.sequence = self._remembered.pop(new.id, None)
        self._by_number[new.home, new.publisher.number] = new
        self.by_source[new.source] = new

    def _advertise(self, topic: Topic, new: RemotePublisher) -> Source:
        """Return the source of a publisher.

        Raises:
            DefinitionPending: its definition is asked for.
            OperationError, InterfaceError: as `Graph.advertise`.
        """
        type_, md5sum = new.type
        if not md5sum:
            hub = printable(new.node.hub.name)
            raise OperationError(f"hub {hub} does not know the fields of {type_}")
        return self._graph.advertise(
            topic,
            new.node.name,
            type_,
            self._definitions.find(new.home.peer, "msg", type_, md5sum, ("topics", topic.name)),
            latch=new.publisher.latch,
            quota=new.home.quota,
            queue_size=new.publisher.queue_size,
            serialized=True,
            md5sum=md5sum,
            linked=False,
            on_conflict=partial(self._warn_of_conflict, new.node.name),
        )

    def _detach_publisher(self, name: str, attached: Attached, old: RemotePublisher) -> None:
        node = old.node.name
        del attached.publishers[node]
        old.node.published.pop(name, None)
        if old.lingering is not None:
            old.lingering.cancel()
        if self._by_number.get((old.home, old.publisher.number)) is old:
            del self._by_number[old.home, old.publisher.number]
        if old.source is not None:
            if old.is_wanted:
                self._end(old)
            del self.by_source[old.source]
            self._graph.remove_source(old.source)
            old.source = None
        self._remove_conflict(name, node, publishes=True)

    def _end(self, old: RemotePublisher) -> None:
        """End the messages of a publisher that is detached, and remember the last one."""
        if not old.home.is_lost:
            peer, number = old.home.peer, old.publisher.number
            peer.backplane.interest(peer, number, wanted=False)
        if old.sequence is not None:
            self._remembered[old.id] = old.sequence
            if len(self._remembered) > MOST_REMEMBERED:
                self._remembered.popitem(last=False)

    def _settle_subscribers(self, name: str, attached: Attached, wanted: WantedSubscribers) -> None:
        for key, sink in list(attached.subscribers.items()):
            found = wanted.get(key)
            type_ = (found[1].type, found[1].md5sum) if found is not None else None
            is_due = sink.is_stuck and sink.tried_with != self._graph.topic(name).types()
            if found is None or sink.remote is not found[0] or sink.type != type_ or is_due:
                self._detach_subscriber(name, attached, key)
        for key, (remote, record) in wanted.items():
            if key not in attached.subscribers:
                type_ = record.type, record.md5sum
                sink = RemoteSubscriber(remote, type_, self._outlets.outlet(name))
                attached.subscribers[key] = sink
                self._attach_subscriber(name, sink)
            elif self._has_interest(topic := self._graph.topic(name), key[0]):
                # Its hub may be reached by several ways.
                topic.sink_linked(attached.subscribers[key])

    def _attach_subscriber(self, name: str, sink: RemoteSubscriber) -> None:
        topic = self._graph.topic(name)
        sink.remote.subscribed[name] = None
        try:
            self._graph.subscribe(
                topic,
                sink,
                sink.type[0] or None,
                md5sum=sink.type[1] or None,
                receiver=lambda group: sink.outlet,
                linked=self._has_interest(topic, sink.node),
                on_conflict=partial(self._warn_of_conflict, sink.node),
            )
        except (OperationError, InterfaceError) as error:
            self._conflict(topic, sink.node, sink.type[0], error, publishes=False)
            sink.is_stuck, sink.tried_with = True, self._graph.topic(name).types()

    def _detach_subscriber(self, name: str, attached: Attached, key: tuple[str, str]) -> None:
        sink = attached.subscribers.pop(key)
        if topic := self._graph.topics.get(name):
            self._graph.unsubscribe(topic, sink)
        self._remove_conflict(name, sink.node, publishes=False)
        if all(each.remote is not sink.remote for each in attached.subscribers.values()):
            sink.remote.subscribed.pop(name, None)

    def _conflict(
        self, topic: Topic, node: str, type_: str, error: Exception, *, publishes: bool
    ) -> None:
        """List a conflict at its topic, for all tools."""
        self._warn(f"{node} exchanges no messages on {topic.name}: {error}")
        self._graph.add_conflict(topic, Conflict(node, type_, publishes, str(error)))

    def _warn_of_conflict(self, node: str, text: str) -> None:
        if text:
            self._warn(f"{node}: {text}")

    def _remove_conflict(self, topic: str, node: str, *, publishes: bool) -> None:
        found = self._graph.topics.get(topic)
        if found is not None and found.unattached:
            self._graph.remove_conflict(found, node, publishes=publishes)

    # Asking for messages.

    def subscribers(self, topic: str, home: PeerGraph) -> frozenset[str]:
        """Return the nodes that a hub has announced as subscribers of a topic."""
        record = self._announced.of("topics", topic).get(home)
        return record.subscribers if record is not None else frozenset()

    def _has_interest(self, topic: Topic, node: str) -> bool:
        """Return whether a hub has asked for messages of a topic for one of its nodes."""
        return any(
            node in record.subscribers and self._outlets.has_interest(home.peer.backplane, topic)
            for home, record in self._announced.of("topics", topic.name).items()
        )

    def _settle_interest(self, attached: Attached) -> None:
        """Ask for the messages that are needed, and some time later for no more."""
        for publisher in attached.publishers.values():
            if publisher.source is None:
                continue
            if self._is_needed(publisher.source, publisher.home):
                if publisher.lingering is not None:
                    publisher.lingering.cancel()
                    publisher.lingering = None
                self._set_interest(publisher, wanted=True)
            elif publisher.is_wanted and publisher.lingering is None:
                publisher.lingering = self._clock.call_later(
                    LINGER, partial(self._lingered, publisher)
                )

    def _lingered(self, publisher: RemotePublisher) -> None:
        publisher.lingering = None
        if publisher.source is not None and not self._is_needed(publisher.source, publisher.home):
            self._set_interest(publisher, wanted=False)

    def _is_needed(self, source: Source, home: PeerGraph) -> bool:
        """Return whether this hub, or one behind it, needs the messages of a remote publisher.

        The hub's aggregator of the log does not count: `LogReader` subscribes while somebody reads
        what it aggregates.
        """
        is_log = source.topic.name in self._graph.guards
        for sink in source.group.sinks():
            is_aggregator = is_log and sink.node == ROSOUT
            if not isinstance(sink, RemoteSubscriber) and not is_aggregator:
                return True
        return self._outlets.is_wanted(source, home.peer.backplane)

    def _set_interest(self, publisher: RemotePublisher, *, wanted: bool) -> None:
        if publisher.is_wanted is wanted:
            return
        publisher.is_wanted = wanted
        if not wanted and publisher.source is not None:
            publisher.is_flowing = False
            publisher.sequence = None
            publisher.source.forget_latched()
            publisher.source.unlink()
        peer = publisher.home.peer
        peer.backplane.interest(peer, publisher.publisher.number, wanted=wanted)
