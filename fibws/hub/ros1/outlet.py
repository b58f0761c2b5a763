"""Outlets: connections by which ROS 1 subscribers take the messages of the hub's clients."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Collection, Mapping

from fibws.errors import FibwsError, TcprosError
from fibws.hub.graph.graph import ROSBRIDGE, Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import SinkReport, Source, Topic
from fibws.hub.graph.types import Buffer, MessageType
from fibws.hub.log_text import is_power_of_ten, shortened
from fibws.hub.ros1.connection import TcprosConnection
from fibws.hub.ros1.nodes import Ros1Subscriber
from fibws.hub.ros1.tcpros import ANY, frame, require

logger = logging.getLogger("fibws.hub")

QUEUE = 100
"""Messages that wait for a subscriber that reads slowly; older ones are dropped."""
JOINED = 4096
"""Bytes of a message up to which copying it is cheaper than writing its length by itself."""


class Outlet:
    """All links of one topic; the `Receiver` of its ROS 1 subscribers.

    Args:
        external: the names of ROS 1 nodes, whose messages do not pass through the hub.
        max_queued: most bytes that wait for one subscriber.
    """

    def __init__(self, name: str, graph: Graph, external: Collection[str], max_queued: int) -> None:
        self.name = name
        self.links: dict[OutletLink, None] = {}
        self._graph = graph
        self._external = external
        self._max_queued = max_queued
        self._faults = 0

    def receive(self, publication: Publication) -> None:
        """Send a message to all subscribers that are connected."""
        if not self.links or publication.node in self._external:
            return
        try:
            data = publication.ros1()
        except FibwsError as error:
            self._faults += 1
            if is_power_of_ten(self._faults):
                text = shortened(f"{self.name}: no message for ROS 1 nodes: {error}")
                logger.warning("%s (%d so far)", text, self._faults)
            return
        for link in tuple(self.links):
            link.send(data)

    def accept(
        self, header: Mapping[str, str], subscriber: Ros1Subscriber, connection: TcprosConnection
    ) -> OutletLink:
        """Answer a subscriber's header, and send it what the topic has latched.

        Raises:
            TcprosError: the subscriber knows the type by another definition.
        """
        topic = self._graph.topic(self.name)
        sources = self.own_sources(topic)
        if not sources or topic.type is None:
            raise TcprosError(f"[{ROSBRIDGE}] is not a publisher of [{self.name}]")
        md5sum = _check_type(header, topic, topic.type)
        connection.answer(
            {
                "callerid": sources[0].node if len(sources) == 1 else ROSBRIDGE,
                "latching": "1" if any(source.latch for source in sources) else "0",
                "md5sum": md5sum,
                "message_definition": self._graph.definitions.full_text(topic.type.name),
                "topic": self.name,
                "type": topic.type.name,
            }
        )
        link = OutletLink(subscriber, md5sum, connection, self._max_queued, self._removed)
        for source in sources:
            publication = source.recall()
            if publication is not None:
                link.send(publication.ros1())
        self.links[link] = None
        subscriber.link = link
        topic.watching_sinks.linked(subscriber.node)
        return link

    def own_sources(self, topic: Topic) -> list[Source]:
        """Return the publishers of the topic that are not ROS 1 nodes."""
        return [each for node, each in topic.sources.items() if node not in self._external]

    def settle(self, topic: Topic) -> None:
        """Close the links that the topic's publishers and type do not fit any more."""
        type_ = topic.type if self.own_sources(topic) else None
        for link in list(self.links):
            is_subscribed = link.subscriber.owner.subscribers.get(self.name) is link.subscriber
            if type_ is None or link.md5sum != type_.md5sum or not is_subscribed:
                link.close()

    def _removed(self, link: OutletLink) -> None:
        self.links.pop(link, None)
        if link.subscriber.link is link:
            link.subscriber.link = None
            topic = self._graph.topics.get(self.name)
            if topic is not None and link.subscriber in topic.sinks():
                topic.watching_sinks.unlinked(link.subscriber.node)


class OutletLink:
    """The link to one subscriber; a `Handler` of its connection.

    Args:
        removed: called once it has ended.
    """

    def __init__(
        self,
        subscriber: Ros1Subscriber,
        md5sum: str,
        connection: TcprosConnection,
        max_queued: int,
        removed: Callable[[OutletLink], object],
    ) -> None:
        self.subscriber = subscriber
        self.md5sum = md5sum
        self.peer = connection.peer
        self.messages = 0
        self.bytes = 0
        self.dropped = 0
        self._transport: asyncio.Transport = connection.transport
        self._max_queued = max_queued
        self._removed = removed
        self._queue: deque[Buffer] = deque()
        self._queued = 0
        self._is_paused = False

    def receive(self, publication: Publication) -> None:
        """Send a message."""
        self.send(publication.ros1())

    def send(self, data: Buffer) -> None:
        """Send a message, or let it wait while the subscriber reads slowly."""
        self.messages += 1
        if self._is_paused:
            self._queue.append(data)
            self._queued += len(data)
            while len(self._queue) > QUEUE or self._queued > self._max_queued:
                self._queued -= len(self._queue.popleft())
                self.dropped += 1
        else:
            self._write(data)

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(queue_length=QUEUE, messages=self.messages, dropped=self.dropped)

    def close(self) -> None:
        """Close the connection, after what has been written."""
        self._transport.close()

    def data_received(self, data: bytes) -> None:
        """Ignore bytes: subscribers send nothing."""

    def pause_writing(self) -> None:
        """Let messages wait."""
        self._is_paused = True

    def resume_writing(self) -> None:
        """Send the messages that wait."""
        self._is_paused = False
        while self._queue and not self._is_paused:
            data = self._queue.popleft()
            self._queued -= len(data)
            self._write(data)

    def connection_lost(self) -> None:
        """End."""
        self._queue.clear()
        self._removed(self)

    def _write(self, data: Buffer) -> None:
        size = len(data)
        self.bytes += size
        if size <= JOINED:
            self._transport.write(frame(size) + data)
        else:
            self._transport.write(frame(size))
            self._transport.write(data)


def _check_type(header: Mapping[str, str], topic: Topic, type_: MessageType) -> str:
    """Return the md5sum of a topic; raise `TcprosError` if a subscriber expects another one."""
    require(header, "topic", "md5sum", "callerid")
    if type_.md5sum is None:
        raise TcprosError(
            f"topic [{topic.name}] has type [{type_.name}], whose definition is unknown to the "
            "hub; start it with the folder of its package: --interfaces DIR"
        )
    wanted, named = header["md5sum"], header.get("type", type_.name)
    if wanted in (ANY, type_.md5sum):
        return type_.md5sum
    if named != type_.name:
        raise TcprosError(f"topic types do not match: [{named}] vs. [{type_.name}]")
    raise TcprosError(
        f"Client [{header['callerid']}] wants topic {topic.name} to have datatype/md5sum "
        f"[{named}/{wanted}], but our version has [{type_.name}/{type_.md5sum}]. "
        "Dropping connection."
    )
