"""Publishers and subscribers of other hubs in this hub's graph."""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

from fibws.errors import FibwsError, OperationError
from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.errors import LimitReached
from fibws.hub.federation.announced import Announced, PeerGraph
from fibws.hub.federation.definitions import DefinitionPending, RemoteDefinitions
from fibws.hub.federation.outlets import Outlets
from fibws.hub.federation.records import LinkMessage, PublisherRecord
from fibws.hub.federation.remote_logs import ROSOUT
from fibws.hub.federation.remote_nodes import RemoteNode, attached_node
from fibws.hub.foreign.topics import (
    LINGER,
    NOT_TRIED,
    ForeignPublisher,
    ForeignSubscriber,
    ForeignTopics,
    ForeignUsers,
)
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.topic import Source, Topic
from fibws.hub.log.text import is_power_of_ten, printable

logger = logging.getLogger("fibws.hub")

MOST_REMEMBERED = 10_000
"""Publishers whose last sequence number is remembered after their hub was lost."""

PublisherId: TypeAlias = tuple[str, int]
"""The id of a publisher's hub, and the publisher's number there."""


class RemotePublisher(ForeignPublisher):
    """A publisher of another hub, with its source in this graph.

    Attributes:
        is_wanted: whether the hub was asked for its messages.
        is_flowing: whether they pass.
        sequence: that of the last message; None before the first.
        stamp: that of the last message; see `LinkMessage`.
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
        "publisher",
        "sequence",
        "stamp",
    )

    node: RemoteNode
    type: tuple[str, str]

    def __init__(
        self, node: RemoteNode, type_: tuple[str, str], publisher: PublisherRecord
    ) -> None:
        super().__init__(node, type_, publisher)
        self.home = node.home
        self.publisher = publisher
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

    def receive(self, message: LinkMessage) -> None:
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


class RemoteSubscriber(ForeignSubscriber):
    """A subscriber of another hub."""

    __slots__ = ()


class RemoteTopics(ForeignTopics[RemotePublisher, RemoteSubscriber]):
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
        super().__init__(graph, warn)
        self.by_source: dict[Source, RemotePublisher] = {}
        self._announced = announced
        self._definitions = definitions
        self._outlets = outlets
        self._clock = clock
        self._flowing = flowing
        self._attached: dict[str, ForeignUsers[RemotePublisher, RemoteSubscriber]] = {}
        """By topic. Subscribers are by node and type: one without a type of its own is announced
        for all types of its hub's topic."""
        self._by_number: dict[tuple[PeerGraph, int], RemotePublisher] = {}
        self._remembered: OrderedDict[PublisherId, int] = OrderedDict()
        """The last sequence numbers of publishers whose hubs were lost."""

    # Messages.

    def received(self, home: PeerGraph, message: LinkMessage) -> None:
        """Deliver a message."""
        publisher = self._by_number.get((home, message.number))
        if publisher is not None:
            publisher.receive(message)

    def is_flowing(self, home: PeerGraph, number: int) -> None:
        """Called when messages of a publisher begin to pass."""
        publisher = self._by_number.get((home, number))
        if publisher is not None and publisher.is_wanted and publisher.source is not None:
            publisher.is_flowing = True
            publisher.source.link()
            self._flowing(publisher)

    # Attaching.

    def uses(self, topic: str) -> bool:
        """Return whether other hubs use a topic."""
        return topic in self._attached or bool(self._announced.of("topics", topic))

    def settle(self, name: str) -> None:
        """Attach what should be attached to a topic, and detach what should not."""
        attached = self._attached.setdefault(name, ForeignUsers())
        self.settle_users(
            name,
            attached,
            *self._wanted(name),
            RemotePublisher,
            lambda node, type_: RemoteSubscriber(node, type_, self._outlets.outlet(name)),
        )
        for sink in attached.subscribers.values():
            if self._has_interest(topic := self._graph.topic(name), sink.node):
                topic.sink_linked(sink)  # Its hub may be reached by several ways.
        if attached.publishers:
            self._settle_interest(attached)
        elif not attached.subscribers:
            del self._attached[name]

    def _wanted(
        self, name: str
    ) -> tuple[dict[str, tuple[Any, ...]], dict[tuple[str, str], tuple[Any, ...]]]:
        """Return the offers of publishers and subscribers whose nodes are attached."""
        publishers: dict[str, tuple[Any, ...]] = {}
        subscribers: dict[tuple[str, str], tuple[Any, ...]] = {}
        for home, record in self._announced.of("topics", name).items():
            for users in record.by_type:
                type_ = users.type, users.md5sum
                for node, publisher in users.publishers.items():
                    if remote := attached_node(self._graph, node, home):
                        publishers[node] = remote, type_, publisher
                for node in users.subscribers:
                    if remote := attached_node(self._graph, node, home):
                        subscribers[node, users.type] = remote, type_
        return publishers, subscribers

    def try_again(self, topic: str) -> None:
        """Attach the publishers that wait for a definition in the next `settle`."""
        for publisher in self._attached.get(topic, ForeignUsers()).publishers.values():
            if publisher.source is None:
                publisher.tried_with = NOT_TRIED

    def advertise(self, topic: Topic, publisher: RemotePublisher) -> Source | None:
        """See `ForeignTopics`; None if its definition is asked for."""
        type_, md5sum = publisher.type
        home, offer = publisher.home, publisher.publisher
        if not md5sum:
            hub = printable(publisher.node.hub.name)
            raise OperationError(f"hub {hub} does not know the fields of {type_}")
        try:
            text = self._definitions.find(home.peer, "msg", type_, md5sum, ("topics", topic.name))
        except DefinitionPending:
            return None
        source = self._graph.advertise(
            topic,
            publisher.name,
            type_,
            text,
            latch=offer.latch,
            quota=home.quota,
            queue_size=offer.queue_size,
            serialized=True,
            md5sum=md5sum,
            linked=False,
            on_conflict=self.reporter(publisher),
        )
        publisher.sequence = self._remembered.pop(publisher.id, None)
        self._by_number[home, offer.number] = publisher
        self.by_source[source] = publisher
        return source

    def subscribe(self, topic: Topic, subscriber: RemoteSubscriber) -> None:
        """See `ForeignTopics`."""
        self._graph.subscribe(
            topic,
            subscriber,
            subscriber.type_name or None,
            md5sum=subscriber.type[1] or None,
            receiver=lambda group: subscriber.outlet,
            linked=self._has_interest(topic, subscriber.node),
            on_conflict=self.reporter(subscriber),
        )

    def detach_user(self, name: str, old: RemotePublisher | RemoteSubscriber) -> None:
        """Detach a publisher or subscriber, and cease to ask for its messages."""
        if isinstance(old, RemotePublisher):
            if old.lingering is not None:
                old.lingering.cancel()
            if self._by_number.get((old.home, old.publisher.number)) is old:
                del self._by_number[old.home, old.publisher.number]
            if old.source is not None:
                if old.is_wanted:
                    self._end(old)
                del self.by_source[old.source]
        super().detach_user(name, old)

    def _end(self, old: RemotePublisher) -> None:
        """End the messages of a publisher that is detached, and remember the last one."""
        if not old.home.is_lost:
            peer, number = old.home.peer, old.publisher.number
            peer.backplane.interest(peer, number, wanted=False)
        if old.sequence is not None:
            self._remembered[old.id] = old.sequence
            if len(self._remembered) > MOST_REMEMBERED:
                self._remembered.popitem(last=False)

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

    def _settle_interest(self, attached: ForeignUsers[RemotePublisher, RemoteSubscriber]) -> None:
        """Ask for the messages that are needed; cease to ask some time after they are not."""
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
        is_log = source.topic.name in self._graph.rights.guards
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
