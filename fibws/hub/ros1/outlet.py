"""Outlets: connections by which ROS 1 subscribers take the messages of the hub's clients."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Iterable, Iterator, Mapping

from fibws.errors import FibwsError
from fibws.hub.errors import TcprosError
from fibws.hub.graph.graph import ROSBRIDGE, Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import SinkReport, Source, Topic
from fibws.hub.graph.type_group import TypeGroup
from fibws.hub.graph.types import Buffer, MessageType
from fibws.hub.log.text import is_power_of_ten, printable
from fibws.hub.ros1.connection import TcprosConnection
from fibws.hub.ros1.nodes import Ros1Nodes
from fibws.hub.ros1.tcpros import ANY, frame, require
from fibws.hub.ros1.topic_registrations import Ros1Subscriber
from fibws.interfaces.catalogue import Definitions

logger = logging.getLogger("fibws.hub")

JOINED = 32 * 1024
"""Bytes of a message up to which copying it costs less than writing its length by itself."""


class TcprosOutlet:
    """All links of one topic; the `Receiver` of its ROS 1 subscribers.

    Args:
        max_queued: most bytes that wait for one subscriber.
        numbers: gives each link its id.
    """

    def __init__(
        self, name: str, graph: Graph, nodes: Ros1Nodes, max_queued: int, numbers: Iterator[int]
    ) -> None:
        self.name = name
        self.links: dict[OutletLink, None] = {}
        self._by_md5: dict[str | None, dict[OutletLink, None]] = {}
        """The same by the md5 of their types: a topic may have several."""
        self.queue_length = 0
        """Messages that may wait for one subscriber: the queue_size of all publishers together;
        0 for no limit."""
        self.max_queued = max_queued
        self._graph = graph
        self._nodes = nodes
        self._numbers = numbers
        self._faults = 0

    def receive(self, publication: Publication) -> None:
        """Send a message to all subscribers that are connected."""
        links = self._by_md5.get(publication.type.md5sum) if self.links else None
        if not links or self._nodes.topics.is_publisher(publication.node, self.name):
            return  # ROS 1 publishers send their messages themselves.
        try:
            message = OutgoingMessage(publication.ros1())
        except FibwsError as error:
            self._log(error)
            return
        for link in tuple(links):
            link.send(message)

    def accept(
        self, header: Mapping[str, str], subscriber: Ros1Subscriber, connection: TcprosConnection
    ) -> OutletLink:
        """Answer a subscriber's header, and send it what the topic has latched.

        Raises:
            TcprosError: the subscriber knows the type by another definition.
        """
        topic = self._graph.topic(self.name)
        self._nodes.topics.name_md5(subscriber, header.get("md5sum", ANY))
        group = self._group_for(topic, header, subscriber)
        type_ = group.type if group is not None else None
        if group is None or type_ is None:
            raise TcprosError(f"[{ROSBRIDGE}] is not a publisher of [{self.name}]")
        sources = self.own_sources(group)
        md5sum, definitions = _check_type(header, topic, type_)
        connection.answer(
            {
                "callerid": sources[0].node if len(sources) == 1 else ROSBRIDGE,
                "latching": "1" if any(source.latch for source in sources) else "0",
                "md5sum": md5sum,
                "message_definition": definitions.full_text(type_.name),
                "topic": self.name,
                "type": type_.name,
            }
        )
        self.queue_length = _queue_length(self._all_own_sources(topic))
        link = OutletLink(next(self._numbers), self, group, subscriber, md5sum, connection)
        for source in sources:
            try:
                publication = source.recall()
                if publication is not None:
                    link.send(OutgoingMessage(publication.ros1()))
            except FibwsError as error:
                self._log(error)
        self.links[link] = None
        self._by_md5.setdefault(md5sum, {})[link] = None
        subscriber.link = link
        topic.sink_linked(subscriber, group)
        return link

    def own_sources(self, group: TypeGroup) -> list[Source]:
        """Return the publishers of a type of the topic that are not ROS 1 nodes."""
        external = self._nodes.by_name
        return [each for node, each in group.sources.items() if node not in external]

    def _all_own_sources(self, topic: Topic) -> list[Source]:
        return [each for group in topic.groups for each in self.own_sources(group)]

    def _group_for(
        self, topic: Topic, header: Mapping[str, str], subscriber: Ros1Subscriber
    ) -> TypeGroup | None:
        """Return the publishers of the type that a subscriber wants, or else any it may have."""
        groups = [each for each in topic.groups_for(subscriber) if self.own_sources(each)]
        wanted = header.get("md5sum", ANY)
        fitting = (each for each in groups if each.type is not None and each.type.md5sum == wanted)
        return next(fitting, groups[0] if groups else None)

    def settle(self, topic: Topic) -> None:
        """Close the links that the topic's publishers and type do not fit any more."""
        self.queue_length = _queue_length(self._all_own_sources(topic))
        used = {each: each.type for each in topic.groups if self.own_sources(each)}
        for link in list(self.links):
            is_subscribed = link.subscriber.owner.subscribed.get(self.name) is link.subscriber
            type_ = used.get(link.group)
            if type_ is None or link.md5sum != type_.md5sum or not is_subscribed:
                link.close()

    def remove(self, link: OutletLink) -> None:
        """Forget a link that is closed; nothing happens if that has been done."""
        if link not in self.links:
            return
        del self.links[link]
        alike = self._by_md5[link.md5sum]
        del alike[link]
        if not alike:
            del self._by_md5[link.md5sum]
        subscriber = link.subscriber
        others = [each for each in self.links if each.subscriber is subscriber]
        subscriber.unlink(link, others[-1] if others else None)
        topic = self._graph.topics.get(self.name)
        if not others and topic is not None and topic.has_sink(subscriber):
            topic.sink_unlinked(subscriber)

    def _log(self, error: FibwsError) -> None:
        self._faults += 1
        if is_power_of_ten(self._faults):
            text = printable(f"{self.name}: no message for ROS 1 nodes: {error}")
            logger.warning("%s (%d so far)", text, self._faults)


class OutgoingMessage:
    """A message with its length before it, as links write it.

    Attributes:
        size: bytes without the length.
        parts: what is written; one part unless it is large.
    """

    __slots__ = ("parts", "size")

    def __init__(self, data: Buffer) -> None:
        self.size = len(data)
        length = frame(self.size)
        self.parts = (length + data,) if self.size <= JOINED else (length, data)


class OutletLink:
    """The link to one subscriber; a `Handler` of its connection.

    Args:
        number: its id among the links of the hub.
        group: the publishers whose messages it gets.
    """

    def __init__(
        self,
        number: int,
        outlet: TcprosOutlet,
        group: TypeGroup,
        subscriber: Ros1Subscriber,
        md5sum: str,
        connection: TcprosConnection,
    ) -> None:
        self.number = number
        self.group = group
        self.subscriber = subscriber
        self.md5sum = md5sum
        self.connection = connection
        self.messages = 0
        self.bytes = 0
        self.dropped = 0
        self._outlet = outlet
        self._write = connection.transport.write
        self._queue: deque[OutgoingMessage] = deque()
        self._queued = 0

    def receive(self, publication: Publication) -> None:
        """Send a message."""
        self.send(OutgoingMessage(publication.ros1()))

    def send(self, message: OutgoingMessage) -> None:
        """Send a message, or let it wait while the subscriber reads slowly."""
        self.messages += 1
        if self.connection.is_paused:
            self._queue.append(message)
            self._queued += message.size
            self._trim()
            return
        self.bytes += message.size
        for part in message.parts:
            self._write(part)

    @property
    def waiting_bytes(self) -> int:
        """Bytes of the messages that wait."""
        return self._queued

    @property
    def incomplete_bytes(self) -> int:
        """Return 0: subscribers send nothing."""
        return 0

    def shorten(self, size: int, least: int) -> None:
        """Drop the oldest messages until ``size`` bytes wait, or ``least`` messages."""
        while len(self._queue) > least and self._queued > size:
            self._queued -= self._queue.popleft().size
            self.dropped += 1

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(self._outlet.queue_length, messages=self.messages, dropped=self.dropped)

    def close(self) -> None:
        """Close the connection after what has been written; what waits is dropped."""
        self._end()
        self.connection.close()

    def data_received(self, data: bytes) -> None:
        """Ignore bytes: subscribers send nothing."""

    def pause_writing(self) -> None:
        """Do nothing: the connection is marked as paused."""

    def resume_writing(self) -> None:
        """Send the messages that wait."""
        while self._queue and not self.connection.is_paused:
            message = self._queue.popleft()
            self._queued -= message.size
            self.bytes += message.size
            for part in message.parts:
                self._write(part)

    def connection_lost(self) -> None:
        """End."""
        self._end()

    def _trim(self) -> None:
        """Drop the oldest messages that are too many; the newest one stays, however large."""
        queue, most, outlet = self._queue, self._outlet.queue_length, self._outlet
        while len(queue) > 1 and (self._queued > outlet.max_queued or (most and len(queue) > most)):
            self._queued -= queue.popleft().size
            self.dropped += 1

    def _end(self) -> None:
        self.dropped += len(self._queue)
        self._queue.clear()
        self._queued = 0
        self._outlet.remove(self)


def _queue_length(sources: Iterable[Source]) -> int:
    """Return how many messages of some publishers may wait; 0 for any number."""
    sizes = [source.queue_size for source in sources]
    return sum(sizes) if all(size > 0 for size in sizes) else 0


def _check_type(
    header: Mapping[str, str], topic: Topic, type_: MessageType
) -> tuple[str, Definitions]:
    """Return the md5sum of a topic, and the definitions that have its type.

    Raises:
        TcprosError: a subscriber expects another type, or this one is unknown.
    """
    require(header, "topic", "md5sum", "callerid")
    if type_.md5sum is None or type_.codecs is None:
        raise TcprosError(
            f"topic [{topic.name}] has type [{type_.name}], whose definition is unknown to the "
            "hub; start it with the folder of its package: --interfaces DIR"
        )
    wanted, named = header["md5sum"], header.get("type", type_.name)
    if wanted in (ANY, type_.md5sum):
        return type_.md5sum, type_.codecs.definitions
    if named != type_.name:
        raise TcprosError(f"topic types do not match: [{named}] vs. [{type_.name}]")
    raise TcprosError(
        f"Client [{header['callerid']}] wants topic {topic.name} to have datatype/md5sum "
        f"[{named}/{wanted}], but our version has [{type_.name}/{type_.md5sum}]. "
        "Dropping connection."
    )
