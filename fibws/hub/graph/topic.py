"""A topic: its type, who publishes it and who hears it.

The way of a message through here: `Publisher.publish` checks and encodes it, `Topic.deliver` hands
the text to each `Channel`, which makes one frame of it for all its subscriptions.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any, Protocol

from pydantic_core import to_json

from fibws.errors import OperationError
from fibws.hub.framing import text_header
from fibws.hub.graph.subscription import MAX_REGISTRATIONS, Subscription
from fibws.hub.outbox import Outbox
from fibws.protocol.operations import Id

_AFTER = b"}"


class MessageType(Protocol):
    """Checks the messages of one type."""

    @property
    def type(self) -> str:
        """The type's name, ``package/Type``."""

    @property
    def has_sequenced_header(self) -> bool:
        """Whether the publisher counts its messages in ``header.seq``, as rospy's does."""

    def validate(self, msg: object) -> dict[str, Any]:
        """The message with every field filled; raises `InvalidMessage`."""

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """The fields that a message leaves to their defaults."""


class Channel:
    """The subscriptions of one topic that spelled its name alike, since each hears its own."""

    def __init__(self, spelling: str) -> None:
        self._before = b'{"op":"publish","topic":%b,"msg":' % to_json(spelling)
        self._around = len(self._before) + len(_AFTER)
        self._direct: dict[Outbox, Subscription] = {}
        self._throttled: dict[Outbox, Subscription] = {}

    def __bool__(self) -> bool:
        return bool(self._direct or self._throttled)

    def subscriptions(self) -> Iterator[Subscription]:
        """All of them."""
        return chain(self._direct.values(), self._throttled.values())

    def update(self, subscription: Subscription) -> None:
        """Add a subscription, or take note that it changed or ended."""
        self._direct.pop(subscription.outbox, None)
        self._throttled.pop(subscription.outbox, None)
        if subscription.requests:
            chosen = self._direct if subscription.direct else self._throttled
            chosen[subscription.outbox] = subscription

    def frame(self, body: bytes) -> bytes:
        """The frame of a message whose JSON text is ``body``."""
        return b"".join((text_header(self._around + len(body)), self._before, body, _AFTER))

    def send(self, body: bytes) -> None:
        """Send a message to every subscription; they share the bytes of its frame."""
        frame = self.frame(body)
        # The hub's innermost loop: `Outbox.put`, written out.
        for outbox, subscription in self._direct.items():
            if outbox.paused:
                outbox.keep(frame, subscription.queue)
                continue
            if not outbox.frames:
                outbox.flusher.add(outbox)
            outbox.frames.append(frame)
        for subscription in self._throttled.values():
            subscription.offer(frame)


class Topic:
    """One topic of the graph.

    It has a type while somebody publishes it or subscribes to it with a type; subscriptions that
    name no type wait for one.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.type: MessageType | None = None
        self.publishers: dict[str, Publisher] = {}
        self.channels: dict[str, Channel] = {}

    @property
    def idle(self) -> bool:
        """Whether nobody has to do with it any more."""
        return not self.publishers and not self.channels

    @property
    def held(self) -> bool:
        """Whether somebody keeps the topic to its type."""
        return bool(self.publishers) or any(each.typed for each in self.subscriptions())

    def holder(self) -> str:
        """One of the nodes that keep a held topic to its type."""
        typed = (each.node for each in self.subscriptions() if each.typed)
        return next(chain(self.publishers, typed))

    def subscriptions(self) -> Iterator[Subscription]:
        """All subscriptions, however they spelled the name."""
        return chain.from_iterable(each.subscriptions() for each in self.channels.values())

    def update(self, subscription: Subscription) -> None:
        """Take note that a subscription has begun, changed or ended."""
        spelling = subscription.spelling
        channel = self.channels.get(spelling)
        if channel is None:
            channel = self.channels[spelling] = Channel(spelling)
        channel.update(subscription)
        if not channel:
            del self.channels[spelling]

    def replay(self, subscription: Subscription) -> bool:
        """Send what publishers have latched to one subscription; tell whether there was any."""
        latched = [each.latched for each in self.publishers.values() if each.latched is not None]
        for body in latched:
            subscription.send(self.channels[subscription.spelling].frame(body))
        return bool(latched)

    def deliver(self, body: bytes) -> None:
        """Send a message, as JSON text, to all who hear the topic."""
        for channel in self.channels.values():
            channel.send(body)


class Publisher:
    """One client's right to publish on one topic, kept while an advertisement of its stands.

    Args:
        node: the client's name.
        latch: keep the last message for those who subscribe later (ROS's latched topics).
    """

    __slots__ = ("_advertisements", "_sequence", "latch", "latched", "node", "topic", "type")

    def __init__(self, node: str, topic: Topic, type_: MessageType, *, latch: bool) -> None:
        self.node = node
        self.topic = topic
        self.type = type_
        self.latch = latch
        self.latched: bytes | None = None
        self._advertisements: set[Id] = set()
        self._sequence = 0

    def advertise(self, id_: Id) -> None:
        """Add an advertisement.

        Raises:
            OperationError: there are too many.
        """
        if len(self._advertisements) >= MAX_REGISTRATIONS and id_ not in self._advertisements:
            raise OperationError(f"{MAX_REGISTRATIONS} advertisements of one topic are enough")
        self._advertisements.add(id_)

    def unadvertise(self, id_: Id) -> bool:
        """Take back the advertisement of this id, or all if it is None; tell whether one stands."""
        if id_ is None:
            self._advertisements.clear()
        self._advertisements.discard(id_)
        return bool(self._advertisements)

    def publish(self, msg: object) -> None:
        """Check a message and send it on; None stands for the default. Raises `InvalidMessage`."""
        message = self.type.validate({} if msg is None else msg)
        if self.type.has_sequenced_header:
            self._sequence += 1
            message["header"]["seq"] = self._sequence & 0xFFFFFFFF
        body = to_json(message, inf_nan_mode="null")
        if self.latch:
            self.latched = body
        self.topic.deliver(body)
