"""Topics: sources publish on them, sinks subscribe to them.

A message passes from `Source.publish` (values) or `Source.publish_serialized` (bytes), which check
it, as a `Publication` to every sink of its type group. A sink is anything with the methods of
`Sink`: a client's subscription, a part of the hub, a bridge. Only `Graph` adds and removes sources
and sinks; ROS calls a source a publisher.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple, Protocol, TypeAlias

from pydantic_core import to_json

from fibws.hub.errors import LimitReached
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.peers import PeerWatch
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.type_group import SinkSet, TypeGroup
from fibws.hub.graph.types import Buffer, MessageType

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
    md5sum: str = ""
    """That of the type, if the topic has another one of the same name; else empty."""


Guard: TypeAlias = Callable[[str, Mapping[str, Any]], None]
"""Checks the values of a node's message, and raises `OperationError` to refuse it."""


class Topic:
    """One topic of the graph, with a group of sources and sinks for each of its types.

    Sources and sinks that name different types are in conflict: none of them is refused, and those
    of one type exchange messages. The topic's own type is that of the main group: the first one
    that has sources, or else the first one that is held by a sink. A topic that only sinks without
    a type use has none.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.untyped = SinkSet()
        """The sinks that name no type, and get the messages of all groups."""
        self.groups = [TypeGroup(self)]
        """At least one; the first is the main group."""
        self.publishers: dict[str, Source] = {}
        """The sources of all groups, by their nodes' names."""
        self.watching_publishers = PeerWatch(self.publishers)
        """The sinks without a type that watch who publishes."""
        self.unattached: list[Conflict] = []
        """The nodes outside the hub that use it as the graph cannot."""
        self.first: Receiver | None = None
        """Gets each message before the other receivers, while it is one of them."""

    @property
    def idle(self) -> bool:
        """Whether the topic has no user left."""
        is_used = self.publishers or self.untyped.receivers or self.unattached
        return not (is_used or any(each.is_used for each in self.groups))

    @property
    def main(self) -> TypeGroup:
        """The group that stands for the topic."""
        return self.groups[0]

    @property
    def type(self) -> MessageType | None:
        """The type of the main group, if somebody who may publish names it."""
        main = self.groups[0]
        return main.type if main.is_held else None

    def types(self) -> list[MessageType | None]:
        """Return the types of all groups, the main one first."""
        return [each.type for each in self.groups]

    @property
    def number(self) -> int:
        """The number of the main group."""
        return self.groups[0].number

    @property
    def sources(self) -> dict[str, Source]:
        """The sources of the main group, by their nodes' names."""
        return self.groups[0].sources

    @property
    def held(self) -> bool:
        """Whether a user holds the topic to its type."""
        return self.groups[0].is_held

    def sinks(self) -> Collection[Sink]:
        """Return the sinks that get the messages of the main group."""
        return self.groups[0].sinks()

    def all_sinks(self) -> list[Sink]:
        """Return the sinks of all groups."""
        sets = (self.untyped, *(each.typed for each in self.groups))
        return [sink for each in sets for sink in each.receivers]

    def subscribers(self) -> Collection[str]:
        """Return the nodes of the sinks, each once."""
        return self.groups[0].listeners

    def all_subscribers(self) -> set[str]:
        """Return the nodes of the sinks of all groups."""
        return self.untyped.by_node.keys() | {
            node for group in self.groups for node in group.typed.by_node
        }

    def sinks_of(self, node: str) -> list[Sink]:
        """Return all sinks of one node."""
        sets = (self.untyped, *(each.typed for each in self.groups))
        return [sink for each in sets for sink in each.by_node.get(node, ())]

    def has_sink(self, sink: Sink) -> bool:
        """Return whether a sink is subscribed, with whatever type."""
        return sink in self.untyped.receivers or self.group_of(sink) is not None

    def group_of(self, sink: Sink) -> TypeGroup | None:
        """Return the group of a sink that gets the messages of one type."""
        return next((each for each in self.groups if sink in each.typed.receivers), None)

    def named_by(self, sink: Sink) -> TypeGroup | None:
        """Return the group of the type that a sink names."""
        return next((each for each in self.groups if each.names(sink)), None)

    def groups_for(self, sink: Sink) -> list[TypeGroup]:
        """Return the groups whose messages a sink gets, the main one first."""
        group = self.group_of(sink)
        return self.groups if group is None else [group]

    def watching(self, sink: Sink) -> PeerWatch:
        """Return the sources that a sink may watch: those whose messages it gets."""
        group = self.group_of(sink)
        return self.watching_publishers if group is None else group.watching_sources

    def type_for(self, sink: Sink) -> MessageType | None:
        """Return the type that a sink names, or that of the topic."""
        group = self.group_of(sink)
        return self.type if group is None else group.type

    def has_number(self, number: int) -> bool:
        """Return whether one of its types has this number."""
        return any(each.number == number for each in self.groups)

    def number_of(self, type_: MessageType) -> int:
        """Return the number of the group of a type, in which one of its messages was published."""
        groups = self.groups
        if len(groups) > 1:
            for group in groups:
                if group.type is type_:
                    return group.number
        return groups[0].number

    def add_group(self) -> TypeGroup:
        """Return another group, behind all others."""
        group = TypeGroup(self)
        group.watching_sinks.copy_unlinked(self.groups[0].watching_sinks, self.untyped.by_node)
        self.groups.append(group)
        return group

    def attach(
        self,
        sink: Sink,
        receiver: Receiver,
        group: TypeGroup | None = None,
        *,
        follow: Callable[[], object] | None = None,
        takes_all: bool = False,
        holds_type: bool = False,
        needs_definition: bool = False,
        linked: bool = True,
    ) -> None:
        """Add a sink, or change how it is subscribed.

        Args:
            receiver: takes its messages: the sink itself, or something that it shares with others
                of its group, which gets each message once for all of them.
            group: that of the type that it names; None if it names none.
            follow: as of `Graph.subscribe`.
            takes_all: whether it gets the messages of all types although it names one.
            holds_type: whether the group keeps its type while the sink is there.
            needs_definition: whether it keeps the definition of that, too.
            linked: False while no messages pass to a sink outside the hub.
        """
        older = self.named_by(sink)
        # First the new and then the old one, so that its node is there all the time.
        if group is None or takes_all:
            self._attach_untyped(sink, receiver, linked=linked)
            if older is not None:
                older.detach(sink)
            if group is not None:
                group.also.add(sink)
        else:
            group.attach(sink, receiver, linked=linked)
            group.also.discard(sink)
            if older is not None and older is not group:
                older.detach(sink)
            self._detach_untyped(sink)
        if group is not None:
            group.followers.pop(sink, None)
            if follow is not None and not takes_all:
                group.followers[sink] = follow
            group.holding.pop(sink, None)
            if holds_type:
                group.holding[sink] = needs_definition

    def detach(self, sink: Sink) -> None:
        """Remove a sink; nothing happens if it is not there."""
        group = self.named_by(sink)
        if group is not None:
            group.detach(sink)
        self._detach_untyped(sink)

    def _attach_untyped(self, sink: Sink, receiver: Receiver, *, linked: bool) -> None:
        is_new = sink not in self.untyped.receivers
        is_first = self.untyped.put(sink, receiver)
        for group in self.groups:
            if is_new and not linked:
                group.watching_sinks.unlinked(sink.node)
            if is_first and sink.node not in group.typed.by_node:
                group.watching_sinks.joined(sink.node)
            group.changed()

    def _detach_untyped(self, sink: Sink) -> None:
        self.watching_publishers.forget(sink)
        if sink not in self.untyped.receivers:
            return
        is_last = self.untyped.remove(sink)
        for group in self.groups:
            if is_last and sink.node not in group.typed.by_node:
                group.watching_sinks.left(sink.node)
            group.changed()

    def add(self, source: Source, *, linked: bool = True) -> None:
        """Add a source to its group.

        Args:
            linked: False while no messages arrive of a source outside the hub.
        """
        group, node = source.group, source.node
        if not linked:
            source.unlink()
        self.publishers[node] = group.sources[node] = source
        group.watching_sources.joined(node)
        self.watching_publishers.joined(node)
        group.changed()

    def remove(self, source: Source) -> None:
        """Remove a source."""
        group, node = source.group, source.node
        group.watching_sinks.forget(source)
        group.reports.pop(source, None)
        if group.sources.get(node) is source:
            del group.sources[node], self.publishers[node]
            group.watching_sources.left(node)
            self.watching_publishers.left(node)

    def sink_linked(self, sink: Sink, group: TypeGroup | None = None) -> None:
        """Record that messages pass to a sink outside the hub.

        Args:
            group: the only group whose messages pass; None for all.
        """
        for each in self.groups_for(sink):
            if group in (None, each):
                each.watching_sinks.linked(sink.node)

    def sink_unlinked(self, sink: Sink) -> None:
        """Record that messages have ceased to pass to a sink outside the hub."""
        for each in self.groups_for(sink):
            each.watching_sinks.unlinked(sink.node)

    def replay(self, sink: Sink) -> None:
        """Replay latched messages to a sink; raise the last error of `Sink.replay`."""
        failure: Exception | None = None
        groups = self.groups_for(sink)
        for source in [each for group in groups for each in group.sources.values()]:
            # A list, since a sink may advertise here.
            try:
                publication = source.recall()
                if publication is not None:
                    sink.replay(publication)
            except Exception as error:
                # One message that fails must not hide those of the other sources.
                failure = error
        if failure is not None:
            raise failure


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
        "group",
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
        group: TypeGroup,
        type_: MessageType,
        now: Callable[[], int],
        *,
        latch: bool,
        quota: LatchQuota,
        queue_size: int = QUEUE_SIZE,
    ) -> None:
        self.node = node
        self.topic = group.topic
        self.group = group
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
        """Bytes of the published messages as they arrived."""
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
        return self.group.sources.get(self.node) is self

    def link(self) -> None:
        """Record that messages of a source outside the hub arrive from now on."""
        self.group.watching_sources.linked(self.node)
        self.topic.watching_publishers.linked(self.node)
        self.group.changed()

    def unlink(self) -> None:
        """Record that no messages of a source outside the hub arrive."""
        self.group.watching_sources.unlinked(self.node)
        self.topic.watching_publishers.unlinked(self.node)

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
            self.group.deliver_to(to, publication)
            return
        self.group.deliver(publication)
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
            self.group.deliver_to(to, publication)
            return
        self.group.deliver(publication)
        if self.latch:
            self._keep(publication)

    def forward(self, publication: Publication) -> None:
        """Deliver a message of another topic of the same type."""
        self.messages += 1
        if self.on_next is not None:
            self._report_next(self.on_next)
        self.bytes += publication.size
        self.group.deliver(publication)

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
        if not self.is_attached:
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
