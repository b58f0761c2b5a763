"""Publishers and subscribers of foreign nodes in this graph.

None is refused: one that the graph cannot attach, because of its type or its rights, is listed
among the conflicts of its topic, and tried again when the topic has another type.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Generic, TypeVar

from fibws.errors import FibwsError
from fibws.hub.foreign.nodes import ForeignNode
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Conflict, Receiver, SinkReport, Source, Topic

LINGER = 2.0
"""Seconds for which messages still come when nobody subscribes any more."""
NOT_TRIED: Any = object()
"""Stands for a type of a topic that is unlike all others, and unlike None."""

K = TypeVar("K", bound=Hashable)
U = TypeVar("U", bound="ForeignPublisher | ForeignSubscriber")
P = TypeVar("P", bound="ForeignPublisher")
S = TypeVar("S", bound="ForeignSubscriber")


class ForeignPublisher:
    """A foreign node as a publisher of a topic.

    Attributes:
        type: the name of its type, and its hash or md5; only the name at ROS 1's.
        source: None while it cannot be attached.
        tried_with: the topic's types by which that failed; see `ForeignTopics.type_of`.
        offer: all that it is made of; another one replaces it.
    """

    __slots__ = ("node", "offer", "source", "tried_with", "type")

    publishes = True

    def __init__(self, node: ForeignNode, type_: Any, *offer: Any) -> None:
        self.node = node
        self.type: Any = type_
        self.offer: tuple[Any, ...] = node, type_, *offer
        self.source: Source | None = None
        self.tried_with: Any = NOT_TRIED

    @property
    def is_attached(self) -> bool:
        """Whether it is in the graph."""
        return self.source is not None

    @property
    def name(self) -> str:
        """The name of its node."""
        return self.node.name

    @property
    def type_name(self) -> str:
        """The name of its type."""
        return str(self.type[0])


class ForeignSubscriber:
    """A foreign node as a subscriber of a topic; a `Sink`, whose messages the outlet takes.

    Attributes:
        owner: its node.
        is_attached: whether it is in the graph; otherwise as a `ForeignPublisher`.
    """

    __slots__ = ("is_attached", "node", "offer", "outlet", "owner", "tried_with", "type")

    publishes = False

    def __init__(self, owner: ForeignNode, type_: Any, outlet: Receiver) -> None:
        self.owner = owner
        self.node = owner.name
        self.type: Any = type_
        self.offer: tuple[Any, ...] = owner, type_
        self.outlet = outlet
        self.is_attached = False
        self.tried_with: Any = NOT_TRIED

    @property
    def name(self) -> str:
        """The name of its node."""
        return self.node

    @property
    def type_name(self) -> str:
        """The name of its type."""
        return str(self.type[0])

    def receive(self, publication: Publication) -> None:
        """Take a message for this subscriber alone, which all of its graph get."""
        self.outlet.receive(publication)

    def replay(self, publication: Publication) -> None:
        """Do nothing: the bridge sends latched messages."""

    def report(self) -> SinkReport:
        """Return no totals: only the other graph knows what has arrived."""
        return SinkReport()


@dataclass(slots=True)
class ForeignUsers(Generic[P, S]):
    """The foreign publishers and subscribers of a topic, attached or not."""

    publishers: dict[str, P] = field(default_factory=dict)
    """By node."""
    subscribers: dict[Any, S] = field(default_factory=dict)
    """By node, or by node and type."""


class ForeignTopics(ABC, Generic[P, S]):
    """Attaches foreign publishers and subscribers to the topics of a graph.

    Args:
        warn: logs a text, once.
    """

    def __init__(self, graph: Graph, warn: Callable[[str], object]) -> None:
        self._graph = graph
        self._warn = warn

    # A bridge gives these.

    @abstractmethod
    def advertise(self, topic: Topic, publisher: P) -> Source | None:
        """Return the source of a publisher; None if it has to wait for something else.

        Raises:
            FibwsError: it cannot be attached; a source that it has is removed.
        """

    @abstractmethod
    def subscribe(self, topic: Topic, subscriber: S) -> None:
        """Subscribe; raises as `advertise`."""

    def type_of(self, topic: Topic, user: P | S) -> Any:
        """Return what a user is attached again for when it changes: the types of the topic."""
        return NOT_TRIED if user.is_attached else topic.types()

    # Attaching.

    def settle_users(
        self,
        name: str,
        users: ForeignUsers[P, S],
        publishers: Mapping[str, tuple[Any, ...]],
        subscribers: Mapping[Any, tuple[Any, ...]],
        publisher: Callable[..., P],
        subscriber: Callable[..., S],
    ) -> None:
        """Attach the users of a topic that are wanted, and detach all others.

        Args:
            publishers: the offers of those that are wanted, by node.
            publisher: makes one of an offer; as ``subscriber``, behind which is its outlet.
        """
        for new in self._replace(name, users.publishers, publishers, publisher):
            new.node.published[name] = new
            self.attach_publisher(name, new)
        for sink in self._replace(name, users.subscribers, subscribers, subscriber):
            sink.owner.subscribed.setdefault(name, []).append(sink)
            self.attach_subscriber(name, sink)

    def _replace(
        self,
        name: str,
        present: dict[K, U],
        wanted: Mapping[K, tuple[Any, ...]],
        make: Callable[..., U],
    ) -> Iterator[U]:
        """Detach what is not wanted any more, and yield what is new."""
        for key, old in list(present.items()):
            topic = self._graph.topic(name)
            if wanted.get(key) != old.offer or self.is_due_again(topic, old):
                self.drop_user(name, present.pop(key))
        for key, offer in wanted.items():
            if key not in present:
                present[key] = make(*offer)
                yield present[key]

    def is_due_again(self, topic: Topic, user: Any) -> bool:
        """Return whether the type with which a user was tried has changed."""
        return bool(user.tried_with != self.type_of(topic, user))

    def drop_user(self, name: str, user: Any) -> None:
        """Detach a publisher or subscriber that its node has removed."""
        if isinstance(user, ForeignPublisher):
            user.node.published.pop(name, None)
        else:
            sinks = user.owner.subscribed[name]
            sinks.remove(user)
            if not sinks:
                del user.owner.subscribed[name]
        self.detach_user(name, user)

    def attach_publisher(self, name: str, new: P, **given: Any) -> None:
        """Attach a publisher, or list it among the conflicts of its topic.

        Args:
            given: further arguments of `advertise`.
        """
        topic = self._graph.topic(name)
        try:
            new.source = self.advertise(topic, new, **given)
        except FibwsError as error:
            self._detach_source(new)
            self._conflict(name, new, error)
        new.tried_with = self.type_of(self._graph.topic(name), new)

    def attach_subscriber(self, name: str, new: S) -> None:
        """Attach a subscriber, or list it among the conflicts of its topic."""
        topic = self._graph.topic(name)
        try:
            self.subscribe(topic, new)
            new.is_attached = True
        except FibwsError as error:
            if new.is_attached:
                new.is_attached = False
                self._graph.unsubscribe(topic, new)
            self._conflict(name, new, error)
        new.tried_with = self.type_of(self._graph.topic(name), new)

    def attach_again(self, name: str, user: Any) -> None:
        """Attach a publisher or subscriber, after its rights or the type of its topic changed."""
        self.detach_user(name, user)
        if user.publishes:
            self.attach_publisher(name, user)
        else:
            self.attach_subscriber(name, user)

    def detach_user(self, name: str, old: Any) -> None:
        """Detach a publisher or subscriber."""
        topic = self._graph.topics.get(name)
        if isinstance(old, ForeignPublisher):
            self._detach_source(old)
        elif topic is not None and old.is_attached:
            old.is_attached = False
            self._graph.unsubscribe(topic, old)
        if topic is not None and topic.unattached:
            self._graph.remove_conflict(topic, old.name, publishes=old.publishes)

    def _detach_source(self, publisher: ForeignPublisher) -> None:
        source, publisher.source = publisher.source, None
        if source is not None:
            self._graph.remove_source(source)

    def abandon(self, publishers: Iterable[P], subscribers: Iterable[S]) -> None:
        """Let no message pass of a node that has left, whose users are detached later."""
        sources = (each.source for each in publishers)
        self._graph.abandon(source for source in sources if source is not None)
        self._graph.abandon(sink for sink in subscribers if sink.is_attached)

    # Conflicts.

    def reporter(self, user: ForeignPublisher | ForeignSubscriber) -> Callable[[str], object]:
        """Return what reports an attached user's conflicts with others."""
        return partial(self._report, user.name)

    def _report(self, node: str, text: str) -> None:
        if text:
            self._warn(f"{node}: {text}")

    def _conflict(self, name: str, user: P | S, error: FibwsError) -> None:
        self._warn(f"{user.name} exchanges no messages on {name}: {error}")
        conflict = Conflict(user.name, user.type_name, user.publishes, str(error))
        self._graph.add_conflict(self._graph.topic(name), conflict)
