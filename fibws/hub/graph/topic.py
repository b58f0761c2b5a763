"""Topics: sources publish on them, sinks subscribe to them.

A message passes from `Source.publish` (values) or `Source.publish_serialized` (bytes), which check
it, as a `Publication` to every sink of the topic. A sink is anything with the methods of `Sink`:
a client's subscription, a part of the hub, a bridge. Only `Graph` adds and removes sources and
sinks; ROS calls a source a publisher.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple, Protocol, TypeAlias

from pydantic_core import to_json

from fibws.errors import LimitReached
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.peers import PeerWatch
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.types import Buffer, MessageType

logger = logging.getLogger("fibws.hub")

QUEUE_SIZE = 100
"""The queue_size of publishers that name none, as in rosbridge."""
LONGEST_QUEUE = 2**31 - 1
"""The largest queue_size that is kept; it is an int32 in ROS."""


class SinkReport(NamedTuple):
    """A sink's settings and totals, for rosapi and the page."""

    queue_length: int = 0
    """Messages that may wait for it; 0 if it takes every message at once."""
    throttle_rate: float = 0.0
    """Least milliseconds between two messages; 0 for no throttle."""
    encoding: str = "none"
    """The requested compression of rosbridge."""
    messages: int = 0
    """Messages that it was sent."""
    dropped: int = 0
    """Messages that it was sent and that were dropped, since it was too slow."""
    throttled: int = 0
    """Messages that its throttle_rate or its credit left out."""


class Receiver(Protocol):
    """Takes the messages of a topic."""

    def receive(self, publication: Publication) -> None:
        """Take a message; it must not be changed."""


class Sink(Receiver, Protocol):
    """A subscriber of a topic."""

    @property
    def node(self) -> str:
        """The global name of its node."""

    def replay(self, publication: Publication) -> None:
        """Take a latched message, which was published before this subscribed."""

    def report(self) -> SinkReport:
        """Return its settings and totals."""


class Conflict(NamedTuple):
    """A node that uses a topic with another type than it has, and so exchanges no messages."""

    node: str
    type: str
    publishes: bool
    """Whether it publishes; else it subscribes."""
    fault: str
    """How the types differ."""


Guard: TypeAlias = Callable[[str, Mapping[str, Any]], None]
"""Checks the values of a node's message, and raises `OperationError` to refuse it."""


class Topic:
    """One topic of the graph.

    It has a type while a source publishes on it, or a sink was subscribed with a type; sinks that
    name no type wait for one.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.number = 0
        """Stands for it and its type in binary frames while it is in the graph; 0 before."""
        self.type: MessageType | None = None
        self.last_type: tuple[str, str | None] | None = None
        """The name and the md5 of the type that it has, or had last, if its fields were known."""
        self.sources: dict[str, Source] = {}
        """By their nodes' names."""
        self.conflicts: list[Conflict] = []
        """The ROS 1 nodes that use it with another type; a ROS 1 master refuses none."""
        self.watching_sources = PeerWatch(self.sources)
        """The sinks that watch who publishes."""
        self._sinks: dict[Sink, Receiver] = {}
        self._holding: dict[Sink, bool] = {}
        """The sinks that were subscribed with a type, and whether they need its definition."""
        self._by_node: dict[str, list[Sink]] = {}
        self.watching_sinks = PeerWatch(self._by_node)
        """The sources that watch who subscribes."""
        self._receivers: tuple[Receiver, ...] | None = ()
        """A tuple, since a sink may leave, or bring another one, while it is given a message; None
        until the next message if they, or the sources that sinks watch, have changed."""
        self._uses: dict[Receiver, int] = {}
        """How many sinks share each receiver."""
        self.first: Receiver | None = None
        """Gets each message before the other receivers, while it is one of them."""

    @property
    def idle(self) -> bool:
        """Whether the topic has no user left."""
        return not (self.sources or self._sinks or self.conflicts)

    @property
    def held(self) -> bool:
        """Whether a user holds the topic to its type."""
        return bool(self.sources or self._holding)

    @property
    def needs_definition(self) -> bool:
        """Whether a user needs the definition of its type, and not only the name."""
        return bool(self.sources) or any(self._holding.values())

    def holder(self) -> str:
        """Return one of the nodes that hold the topic to its type; it must be `held`."""
        return next(iter(self.sources), None) or next(iter(self._holding)).node

    def sinks(self) -> Collection[Sink]:
        """Return all sinks."""
        return self._sinks

    def sinks_of(self, node: str) -> Collection[Sink]:
        """Return the sinks of one node."""
        return self._by_node.get(node, ())

    def subscribers(self) -> Collection[str]:
        """Return the nodes of all sinks, each once."""
        return self._by_node.keys()

    def attach(
        self, sink: Sink, receiver: Receiver, *, holds_type: bool, needs_definition: bool = False
    ) -> None:
        """Add a sink, or change how it is subscribed.

        Args:
            receiver: takes its messages: the sink itself, or a group that it shares with others,
                which gets each message once for all of them.
            holds_type: whether the topic keeps its type while the sink is there.
            needs_definition: whether it keeps the definition of that, too.
        """
        older = self._sinks.get(sink)
        if older is None:
            sinks = self._by_node.get(sink.node)
            if sinks is None:
                self._by_node[sink.node] = [sink]
                self.watching_sinks.joined(sink.node)
            else:
                sinks.append(sink)
        if older is not receiver:
            self._sinks[sink] = receiver
            self._use(receiver, 1)
            if older is not None:
                self._use(older, -1)
        self._holding.pop(sink, None)
        if holds_type:
            self._holding[sink] = needs_definition

    def detach(self, sink: Sink) -> None:
        """Remove a sink; nothing happens if it is not there."""
        self.watching_sources.forget(sink)
        receiver = self._sinks.pop(sink, None)
        if receiver is None:
            return
        self._use(receiver, -1)
        self._holding.pop(sink, None)
        others = self._by_node[sink.node]
        others.remove(sink)
        if not others:
            del self._by_node[sink.node]
            self.watching_sinks.left(sink.node)

    def add(self, source: Source) -> None:
        """Add a source."""
        self.sources[source.node] = source
        self.watching_sources.joined(source.node)
        self._receivers = None

    def remove(self, source: Source) -> None:
        """Remove a source."""
        self.watching_sinks.forget(source)
        if self.sources.get(source.node) is source:
            del self.sources[source.node]
            self.watching_sources.left(source.node)

    def source_linked(self, node: str) -> None:
        """Take note that messages of a ROS 1 node's source arrive from now on."""
        self.watching_sources.linked(node)
        self._receivers = None

    def replay(self, sink: Sink) -> None:
        """Replay latched messages to a sink; raise the last error of `Sink.replay`."""
        failure: Exception | None = None
        for source in tuple(self.sources.values()):  # A sink may advertise here.
            try:
                publication = source.recall()
                if publication is not None:
                    sink.replay(publication)
            except Exception as error:
                # One message that fails must not hide those of the other sources.
                failure = error
        if failure is not None:
            raise failure

    def deliver(self, publication: Publication) -> None:
        """Give a message to all sinks."""
        receivers = self._receivers
        if receivers is None:
            receivers = self._prepare()
        for receiver in receivers:
            try:
                receiver.receive(publication)
            except Exception:
                # One sink that fails must not silence the others.
                logger.exception("%s: a subscriber failed.", self.name)

    def deliver_to(self, node: str, publication: Publication) -> None:
        """Give a message to the sinks of one node."""
        if self._receivers is None:
            self._prepare()
        for sink in tuple(self._by_node.get(node, ())):
            try:
                sink.receive(publication)
            except Exception:
                logger.exception("%s: a subscriber failed.", self.name)

    def _prepare(self) -> tuple[Receiver, ...]:
        """Return the receivers; watchers are informed of a new source before its messages."""
        self.watching_sources.report()
        self._receivers = tuple(sorted(self._uses, key=lambda each: each is not self.first))
        return self._receivers

    def _use(self, receiver: Receiver, change: int) -> None:
        """Count one sink more or less that shares a receiver."""
        uses = self._uses.get(receiver, 0) + change
        if uses and receiver in self._uses:
            self._uses[receiver] = uses
            return
        if uses:
            self._uses[receiver] = uses
        else:
            del self._uses[receiver]
        self._receivers = None


class Source:
    """A node's right to publish on a topic, which it has while it advertises the topic.

    Args:
        node: its global name.
        now: returns the nanoseconds since 1970.
        latch: keep the last message for later subscribers (ROS's latched topics).
        quota: bounds the latched messages of the node.
        queue_size: most messages that wait for one ROS 1 subscriber that is too slow; 0 or less
            for no limit. Clients choose it, so that it may be any integer; the attribute is 0 to
            `LONGEST_QUEUE`.
    """

    __slots__ = (
        "__weakref__",
        "_latched",
        "_latched_bytes",
        "_now",
        "_quota",
        "_sequence",
        "bytes",
        "header",
        "keeps_sequence",
        "latch",
        "make_latest",
        "messages",
        "node",
        "on_next",
        "queue_size",
        "topic",
        "type",
    )

    def __init__(
        self,
        node: str,
        topic: Topic,
        type_: MessageType,
        now: Callable[[], int],
        *,
        latch: bool,
        quota: LatchQuota,
        queue_size: int = QUEUE_SIZE,
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = type_
        self.latch = latch
        self.queue_size = min(max(0, queue_size), LONGEST_QUEUE)
        self.keeps_sequence = False
        """Whether messages keep their ``header.seq``, as those of a recording do."""
        self.header = b""
        """The connection header of its messages, as JSON."""
        self.set_headers({})
        self.make_latest: Callable[[], dict[str, Any]] | None = None
        """Makes the message for later subscribers, where it costs less than to keep each one."""
        self.on_next: Callable[[], object] | None = None
        """Called at the next message, and removed."""
        self.messages = 0
        """Messages published."""
        self.bytes = 0
        """Bytes of these messages as they arrived."""
        self._latched: Publication | None = None
        self._latched_bytes = 0
        self._now = now
        self._quota = quota
        self._sequence = 0

    @property
    def name(self) -> str:
        """The topic's name."""
        return self.topic.name

    @property
    def is_attached(self) -> bool:
        """Whether it is its node's source of the topic, and not removed."""
        return self.topic.sources.get(self.node) is self

    def set_headers(self, headers: Mapping[str, str]) -> None:
        """Set the connection header of the messages from now on, beside callerid and latching."""
        latching = "1" if self.latch else "0"
        self.header = to_json({"callerid": self.node, "latching": latching, **headers})

    def publish(self, msg: object, size: int | None = None, to: str | None = None) -> None:
        """Check a message's values and deliver them; None stands for the type's default message.

        Args:
            size: the bytes in which it arrived; None counts those of its JSON.
            to: the only node that is to get it; it is not latched then.

        Raises:
            InvalidMessage: it does not fit the topic's type.
            LimitReached: it was delivered, but is too large to be latched.
        """
        type_ = self.type
        values = type_.validate({} if msg is None else msg)
        if type_.sequenced and not self.keeps_sequence:
            self._sequence += 1
            values["header"]["seq"] = self._sequence & 0xFFFFFFFF
        publication = Publication(type_, self.node, self.header, self._now(), values)
        self.messages += 1
        if self.on_next is not None:
            self._report_next(self.on_next)
        self.bytes += len(publication.json()) if size is None else size
        if to is not None:
            self.topic.deliver_to(to, publication)
            return
        self.topic.deliver(publication)
        if self.latch:
            self._keep(publication)

    def publish_serialized(self, data: Buffer, to: str | None = None) -> None:
        """Check a message in ROS 1's serialization and deliver it; raises as `publish` does.

        Args:
            data: its bytes, which belong to the hub from now on.
            to: as in `publish`.
        """
        self.type.check(data)
        if self.type.sequenced and not self.keeps_sequence:
            self._sequence += 1
            data = _numbered(data, self._sequence & 0xFFFFFFFF)
        self._deliver_serialized(data, to)

    def relay(self, data: Buffer) -> None:
        """Check and deliver a serialized message whose publisher has set ``header.seq`` itself.

        It raises as `publish` does. Nothing happens once the source is removed: what relays may
        learn that later.
        """
        if self.is_attached:
            self.type.check(data)
            self._deliver_serialized(data, None)

    def _deliver_serialized(self, data: Buffer, to: str | None) -> None:
        publication = Publication(self.type, self.node, self.header, self._now(), None, data)
        self.messages += 1
        if self.on_next is not None:
            self._report_next(self.on_next)
        self.bytes += len(data)
        if to is not None:
            self.topic.deliver_to(to, publication)
            return
        self.topic.deliver(publication)
        if self.latch:
            self._keep(publication)

    def forward(self, publication: Publication) -> None:
        """Deliver a message of another topic of the same type."""
        self.messages += 1
        if self.on_next is not None:
            self._report_next(self.on_next)
        self.bytes += publication.size
        self.topic.deliver(publication)

    def recall(self) -> Publication | None:
        """Return the message for later subscribers, if there is one."""
        if self.make_latest is not None:
            values = self.type.validate(self.make_latest())
            return Publication(self.type, self.node, self.header, self._now(), values)
        return self._latched

    def forget_latched(self) -> None:
        """Keep no latched message any more."""
        quota = self._quota
        quota.latched.pop(self, None)
        quota.add(-self._latched_bytes)
        self._latched_bytes = 0
        self._latched = None

    def _report_next(self, report: Callable[[], object]) -> None:
        self.on_next = None
        report()

    def _keep(self, publication: Publication) -> None:
        if self.topic.sources.get(self.node) is not self:
            return  # A sink has removed it while it was given the message.
        self.forget_latched()
        self._latched_bytes = publication.compact()
        self._latched = publication
        quota = self._quota
        quota.latched[self] = None
        quota.add(self._latched_bytes)
        if quota.exceeded:
            self.forget_latched()
            raise LimitReached(
                f"a message of {self.topic.name} was delivered but not latched: the latched "
                f"messages of one client may take {quota.limit} bytes (--max-latched-bytes)"
            )


class GuardedSource(Source):
    """A source whose messages are checked for more than their type.

    Args:
        guard: takes the node and each message's values, and raises `OperationError` to refuse it.
        arguments: those of `Source`.
    """

    __slots__ = ("_guard",)

    def __init__(self, guard: Guard, *args: Any, **arguments: Any) -> None:
        super().__init__(*args, **arguments)
        self._guard = guard

    def publish(self, msg: object, size: int | None = None, to: str | None = None) -> None:
        """Check a message and deliver it, as `Source` does."""
        values = self.type.validate({} if msg is None else msg)
        self._guard(self.node, values)
        super().publish(values, size, to)

    def publish_serialized(self, data: Buffer, to: str | None = None) -> None:
        """Check a message and deliver it, as `Source` does."""
        self.type.check(data)
        self._guard(self.node, self.type.deserialize(data)[0])
        super().publish_serialized(data, to)

    def relay(self, data: Buffer) -> None:
        """Check a message and deliver it, as `Source` does."""
        self.type.check(data)
        self._guard(self.node, self.type.deserialize(data)[0])
        super().relay(data)


def _numbered(data: Buffer, sequence: int) -> Buffer:
    """Return a message whose first field, header.seq, is this number."""
    number = sequence.to_bytes(4, "little")
    if isinstance(data, memoryview) and not data.readonly:
        data[:4] = number  # A large message, in the buffer that it was read into.
        return data
    return b"".join((number, data[4:]))
