"""A node's publishers and subscriptions, as its hub knows them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from typing import Any

from fibws.errors import NodeClosed, NodeError, OperationRejected
from fibws.node.advertisement import Advertisement
from fibws.node.fault import throw
from fibws.node.part import Part
from fibws.node.session import Session
from fibws.node.subscription import Subscription
from fibws.protocol.operations import (
    Advertise,
    Peers,
    Publish,
    Reply,
    Unadvertise,
    Unsubscribe,
    encode,
)


class Topics(Part):
    """The part of a session that publishes and listens."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._advertisements: dict[str, Advertisement] = {}
        self._subscriptions: dict[str, Subscription[Any]] = {}
        self._listeners: defaultdict[str, list[Subscription[Any]]] = defaultdict(list)
        session.join(self)
        session.hand_messages_to(self._hear)

    # What the node does

    def advertise(
        self, operation: Advertise, refused: Callable[[NodeError], None] | None = None
    ) -> Advertisement:
        """Register a publisher; ``refused`` is told if the hub will not have it."""
        self._session.check()
        advertisement = Advertisement(operation, refused)
        self._advertisements[str(operation.id)] = advertisement
        self._session.say(operation)
        return advertisement

    @property
    def has_room(self) -> bool:
        """Whether there is room for another message."""
        return self._session.outbox.has_room

    @property
    def is_idle(self) -> bool:
        """Whether nothing waits to be sent."""
        return not self._session.outbox

    async def room(self) -> None:
        """Wait until there is room for another message."""
        await self._session.outbox.room()

    def publish(self, advertisement: Advertisement, text: bytes, *, to_all: bool = True) -> None:
        """Send a message, already encoded, as `put` does, or raise why nobody would hear it."""
        self._session.check()
        if advertisement.fault is not None:
            throw(advertisement.fault)
        if advertisement.closed:
            raise NodeClosed(f"publish on {advertisement.operation.topic}: it was closed")
        self.put(advertisement, text, to_all=to_all)

    def put(self, advertisement: Advertisement, text: bytes, *, to_all: bool = True) -> None:
        """Send a message, already encoded, whatever has become of the advertisement and the node.

        Who can wait has waited for `room`; else the newest of the publisher's queue are kept.
        """
        if advertisement.operation.latch and to_all:
            advertisement.latched = text
        self._session.outbox.put(text, advertisement)

    def introduce(self, advertisement: Advertisement, headers: dict[str, str]) -> None:
        """Have the hub say these headers from now on, beside each message of the topic."""
        before = advertisement.operation
        if headers == (before.headers or {}):
            return
        advertisement.operation = before.model_copy(update={"headers": headers})
        if not advertisement.closed:
            self._session.say(advertisement.operation)

    def unadvertise(self, advertisement: Advertisement) -> None:
        """Take a publisher back."""
        advertisement.closed = True
        advertisement.peers.end()
        operation = advertisement.operation
        if self._advertisements.pop(str(operation.id), None) is not None:
            self._session.say(Unadvertise(id=operation.id, topic=operation.topic))

    def subscribe(self, subscription: Subscription[Any]) -> None:
        """Register a subscription."""
        self._session.check()
        self._subscriptions[str(subscription.operation.id)] = subscription
        self._listeners[subscription.topic].append(subscription)
        self._session.say(subscription.operation)

    def unsubscribe(self, subscription: Subscription[Any]) -> None:
        """Take a subscription back."""
        operation = subscription.operation
        if self._forget(str(operation.id)) is not None:
            self._session.say(Unsubscribe(id=operation.id, topic=operation.topic))

    @property
    def over(self) -> bool:
        """Whether the node has ended."""
        return self._session.over

    def names(self) -> list[str]:
        """The topics that the node publishes or subscribes to."""
        published = {each.operation.topic for each in self._advertisements.values()}
        return sorted(published | self._listeners.keys())

    # What happens to the node

    def greeting(self) -> Iterator[bytes]:
        """All registrations, then what is latched, unless it waits to be sent anyway."""
        for advertisement in self._advertisements.values():
            yield encode(advertisement.operation)
        for subscription in self._subscriptions.values():
            yield encode(subscription.operation)
        for advertisement in self._advertisements.values():
            latched = advertisement.latched
            if latched is not None and not self._session.outbox.waits(latched, advertisement):
                yield latched

    def receive(self, reply: Reply) -> bool:
        """Hand on a message, or a word of peers; it may come late, for what is not any more."""
        match reply:
            case Publish():
                self._hear(reply.topic, reply.msg, reply.header)
            case Peers():
                id_ = str(reply.id)
                owner: Advertisement | Subscription[Any] | None
                owner = self._advertisements.get(id_) or self._subscriptions.get(id_)
                if owner is not None:
                    owner.peers.take(reply.nodes)
            case _:
                return False
        return True

    def _hear(self, topic: str, message: Any, header: dict[str, str] | None) -> bool:
        """Give a message to those who listen; tell whether anybody does."""
        subscriptions = self._listeners.get(topic, ())
        for subscription in subscriptions:
            subscription.offer(message, header)
            if subscription.is_full:
                self._session.crowded = True
        return bool(subscriptions)

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """End a publisher or a subscription that the hub will not have."""
        if (advertisement := self._advertisements.pop(id_, None)) is not None:
            advertisement.fault = fault
            advertisement.closed = True
            advertisement.peers.end()
            if advertisement.refused is not None:
                advertisement.refused(fault)
            return True
        if (subscription := self._forget(id_)) is not None:
            subscription.end(fault)
            return True
        return False

    def lose(self) -> None:
        """The hub is gone, and with it what it knew of peers."""
        for advertisement in self._advertisements.values():
            advertisement.peers.lose()
        for subscription in self._subscriptions.values():
            subscription.peers.lose()

    def end(self, fault: Exception | None) -> None:
        """Let all readers know."""
        for advertisement in self._advertisements.values():
            advertisement.peers.end()
        for subscription in self._subscriptions.values():
            subscription.end(fault)

    def _forget(self, id_: str) -> Subscription[Any] | None:
        subscription = self._subscriptions.pop(id_, None)
        if subscription is not None:
            # A new list: one of them may close itself, or another, while it is given a message.
            others = [
                each for each in self._listeners[subscription.topic] if each is not subscription
            ]
            if others:
                self._listeners[subscription.topic] = others
            else:
                del self._listeners[subscription.topic]
        return subscription
