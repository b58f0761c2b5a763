"""Type groups: the publishers and subscribers of a topic that have one type.

They exchange messages, whatever other types the topic has: a message passes from a source to the
sinks of its own group, and to those that name no type, without a look at the other groups.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Iterable, Iterator, Set
from itertools import chain
from typing import TYPE_CHECKING, TypeVar

from fibws.hub.graph.peers import PeerWatch
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.types import MessageType

if TYPE_CHECKING:
    from fibws.hub.graph.topic import Receiver, Sink, Source, Topic

logger = logging.getLogger("fibws.hub")

T = TypeVar("T")


class SinkSet:
    """Some sinks, with the receivers that take their messages."""

    __slots__ = ("by_node", "receivers", "uses")

    def __init__(self) -> None:
        self.receivers: dict[Sink, Receiver] = {}
        self.by_node: dict[str, list[Sink]] = {}
        self.uses: dict[Receiver, int] = {}
        """How many sinks share each receiver."""

    def put(self, sink: Sink, receiver: Receiver) -> bool:
        """Add a sink, or change its receiver; return whether it is its node's first one."""
        older = self.receivers.get(sink)
        is_first = False
        if older is None:
            sinks = self.by_node.setdefault(sink.node, [])
            is_first = not sinks
            sinks.append(sink)
        if older is not receiver:
            self.receivers[sink] = receiver
            self.uses[receiver] = self.uses.get(receiver, 0) + 1
            if older is not None:
                self._release(older)
        return is_first

    def remove(self, sink: Sink) -> bool:
        """Remove a sink that is there; return whether it was its node's last one."""
        self._release(self.receivers.pop(sink))
        others = self.by_node[sink.node]
        others.remove(sink)
        if not others:
            del self.by_node[sink.node]
        return not others

    def _release(self, receiver: Receiver) -> None:
        self.uses[receiver] -= 1
        if not self.uses[receiver]:
            del self.uses[receiver]


class Union(Set[str]):
    """The nodes of two sets of sinks."""

    __slots__ = ("_first", "_second")

    def __init__(self, first: SinkSet, second: SinkSet) -> None:
        self._first = first.by_node
        self._second = second.by_node

    def __contains__(self, node: object) -> bool:
        return node in self._first or node in self._second

    def __iter__(self) -> Iterator[str]:
        yield from self._first
        for node in self._second:
            if node not in self._first:
                yield node

    @classmethod
    def _from_iterable(cls, nodes: Iterable[T]) -> set[T]:
        return set(nodes)

    def __len__(self) -> int:
        fewer, more = sorted((self._first, self._second), key=len)
        return len(more) + sum(node not in more for node in fewer)


class TypeGroup:
    """The sources and sinks of a topic that have one type.

    Sinks that name no type get the messages of all groups; `Topic.untyped` has them.
    """

    def __init__(self, topic: Topic) -> None:
        self.topic = topic
        self.number = 0
        """Stands for the topic and this type in binary frames while it is in the graph; 0
        before."""
        self.type: MessageType | None = None
        self.last_type: tuple[str, str | None] | None = None
        """The name and the md5 of the type that it has, or had last, if its fields were known."""
        self.sources: dict[str, Source] = {}
        """By their nodes' names."""
        self.typed = SinkSet()
        """The sinks that name this type, and get its messages alone."""
        self.also: set[Sink] = set()
        """The sinks that name its type, and get the messages of all types."""
        self.holding: dict[Sink, bool] = {}
        """The sinks that hold the topic to its type, and whether they need the definition."""
        self.followers: dict[Sink, Callable[[], object]] = {}
        """The sinks that only name its type, with what lets them subscribe to another definition
        of it."""
        self.is_left = False
        """Whether they are about to do that."""
        self.told: tuple[tuple[str, bool], ...] = ()
        """The other types that its members were told of, and whether these were published."""
        self.reports: dict[Source | Sink, Callable[[str], object]] = {}
        """The functions that tell members of conflicts; see `Graph.advertise`."""
        self.watching_sources = PeerWatch(self.sources)
        """The typed sinks that watch who publishes."""
        self.listeners = Union(self.typed, topic.untyped)
        """The nodes that get its messages."""
        self.watching_sinks = PeerWatch(self.listeners)
        """The sources that watch who subscribes."""
        self._receivers: tuple[Receiver, ...] | None = None
        """A tuple, since a sink may leave, or bring another one, while it is given a message; None
        until the next message if they, or the sources that sinks watch, have changed."""

    @property
    def name(self) -> str:
        """The topic's name."""
        return self.topic.name

    @property
    def is_used(self) -> bool:
        """Whether somebody names its type."""
        return bool(self.sources or self.typed.receivers or self.also)

    @property
    def is_held(self) -> bool:
        """Whether somebody who may publish names its type."""
        return bool(self.sources or self.holding)

    @property
    def needs_definition(self) -> bool:
        """Whether somebody needs the definition of its type, and not only the name."""
        return bool(self.sources) or any(self.holding.values())

    @property
    def has_sinks(self) -> bool:
        """Whether anybody gets its messages."""
        return bool(self.typed.receivers or self.topic.untyped.receivers)

    def members(self) -> list[str]:
        """Return the publishing nodes; without any, the subscribing nodes that hold its type."""
        return list(self.sources) or [sink.node for sink in self.holding]

    def sinks(self) -> Collection[Sink]:
        """Return all sinks that get its messages."""
        typed, untyped = self.typed.receivers, self.topic.untyped.receivers
        if not typed or not untyped:
            return (typed or untyped).keys()
        return [*typed, *untyped]

    def names(self, sink: Sink) -> bool:
        """Return whether a sink names this type."""
        return sink in self.typed.receivers or sink in self.also

    def naming(self) -> set[str]:
        """Return the nodes of the sinks that name this type."""
        return self.typed.by_node.keys() | {sink.node for sink in self.also}

    def sinks_of(self, node: str) -> list[Sink]:
        """Return the sinks of one node that get its messages."""
        sets = self.typed, self.topic.untyped
        return [sink for each in sets for sink in each.by_node.get(node, ())]

    def attach(self, sink: Sink, receiver: Receiver, *, linked: bool) -> None:
        """Add a sink that names the type, or change its receiver; as `Topic.attach`."""
        if not linked and sink not in self.typed.receivers:
            self.watching_sinks.unlinked(sink.node)
        if self.typed.put(sink, receiver) and sink.node not in self.topic.untyped.by_node:
            self.watching_sinks.joined(sink.node)
        self.changed()

    def detach(self, sink: Sink) -> None:
        """Remove a sink that names the type, if it is there."""
        self.watching_sources.forget(sink)
        self.holding.pop(sink, None)
        self.reports.pop(sink, None)
        self.followers.pop(sink, None)
        self.also.discard(sink)
        if sink not in self.typed.receivers:
            return
        if self.typed.remove(sink) and sink.node not in self.topic.untyped.by_node:
            self.watching_sinks.left(sink.node)
        self.changed()

    def changed(self) -> None:
        """Called when receivers, or the sources that sinks watch, have changed."""
        self._receivers = None

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
        for sink in self.sinks_of(node):
            try:
                sink.receive(publication)
            except Exception:
                logger.exception("%s: a subscriber failed.", self.name)

    def _prepare(self) -> tuple[Receiver, ...]:
        """Return the receivers; watchers are informed of a new source before its messages."""
        self.watching_sources.report()
        self.topic.watching_publishers.report()
        receivers = dict.fromkeys(chain(self.typed.uses, self.topic.untyped.uses))
        first = self.topic.first
        self._receivers = tuple(sorted(receivers, key=lambda each: each is not first))
        return self._receivers
