"""A node's side of the conversation with its hub: what it says, and to whom goes what it hears."""

from __future__ import annotations

import asyncio
import logging
from collections import defaultdict
from collections.abc import Iterator
from typing import Any, assert_never

from fibws.errors import InvalidUtf8, NodeClosed, OperationError, OperationRejected
from fibws.node.fault import tell
from fibws.node.outbox import Advertisement, Outbox
from fibws.node.subscription import Subscription
from fibws.protocol.operations import (
    Advertise,
    Id,
    Publish,
    Status,
    Subscribe,
    Unadvertise,
    Unsubscribe,
    encode,
)
from fibws.protocol.parsing import parse_reply
from fibws.protocol.text import objects

_LEVELS = {"error": logging.ERROR, "warning": logging.WARNING, "info": logging.INFO}


class Session:
    """What a node has registered. It outlives the connection, and is told again to the next."""

    def __init__(self, log: logging.Logger) -> None:
        self.outbox = Outbox()
        self._log = log
        self._advertisements: dict[str, Advertisement] = {}
        self._subscriptions: dict[str, Subscription[Any]] = {}
        self._listeners: defaultdict[str, list[Subscription[Any]]] = defaultdict(list)
        self._registrations = 0
        self._over = False
        self._waiters: set[asyncio.Future[None]] = set()
        self._fault: Exception | None = None

    # What the node does

    def id(self, verb: str, topic: str) -> str:
        """A new id for an operation."""
        self._registrations += 1
        return f"{verb}:{topic}:{self._registrations}"

    def advertise(self, operation: Advertise) -> Advertisement:
        """Register a publisher."""
        self.check()
        advertisement = Advertisement(operation)
        self._advertisements[str(operation.id)] = advertisement
        self._say(operation)
        return advertisement

    def publish(self, advertisement: Advertisement, text: bytes) -> None:
        """Send a message, already encoded; the caller has waited for room."""
        self.check()
        if advertisement.fault is not None:
            tell(advertisement.fault)
        if advertisement.closed:
            raise NodeClosed(f"publish on {advertisement.operation.topic}: it was closed")
        if advertisement.operation.latch:
            advertisement.latched = text
        self.outbox.put(text, advertisement)

    def unadvertise(self, advertisement: Advertisement) -> None:
        """Take a publisher back."""
        advertisement.closed = True
        operation = advertisement.operation
        if self._advertisements.pop(str(operation.id), None) is not None:
            self._say(Unadvertise(id=operation.id, topic=operation.topic))

    def subscribe(self, subscription: Subscription[Any]) -> None:
        """Register a subscription."""
        self.check()
        self._subscriptions[str(subscription.operation.id)] = subscription
        self._listeners[subscription.topic].append(subscription)
        self._say(subscription.operation)

    def unsubscribe(self, subscription: Subscription[Any]) -> None:
        """Take a subscription back."""
        operation = subscription.operation
        if self._forget(operation.id) is not None:
            self._say(Unsubscribe(id=operation.id, topic=operation.topic))

    def topics(self) -> list[str]:
        """The topics that the node publishes or subscribes to."""
        published = {each.operation.topic for each in self._advertisements.values()}
        return sorted(published | {each.topic for each in self._subscriptions.values()})

    # What happens to the node

    def greeting(self) -> list[bytes]:
        """What a new connection is told first, before the outbox's frames."""
        return [encode(operation) for operation in self._registered()] + [
            advertisement.latched
            for advertisement in self._advertisements.values()
            if advertisement.latched is not None and not advertisement.waiting
        ]

    def receive(self, text: bytes) -> None:
        """Hand on what the hub sent."""
        try:
            for fields in objects(text):
                reply = parse_reply(fields)
                match reply:
                    case Publish():
                        self._heard(reply)
                    case Status():
                        self._told(reply)
                    case _:
                        assert_never(reply)
        except (OperationError, InvalidUtf8) as error:
            self._log.warning("The hub sent what this node does not understand: %s", error)

    def end(self, fault: Exception | None = None) -> None:
        """The node is over, because of ``fault`` if there is one; later calls change nothing."""
        if self._over:
            return
        self._fault = fault
        self._over = True
        for waiter in self._waiters:
            _release(waiter)
        for subscription in self._subscriptions.values():
            subscription.end(fault)
        self.outbox.close()

    @property
    def over(self) -> bool:
        """Whether the node has ended."""
        return self._over

    async def ended(self, within: float | None = None) -> bool:
        """Wait for the node's end, for ``within`` seconds at most; tell whether it came.

        It raises what was the matter if anything was. A timer does for the wait what a cancellation
        would do as well, but that goes through the caller's frames, which debuggers then lose.
        """
        if not self.over:
            loop = asyncio.get_running_loop()
            waiter = loop.create_future()
            timer = loop.call_later(within, _release, waiter) if within is not None else None
            self._waiters.add(waiter)
            try:
                await waiter
            finally:
                self._waiters.discard(waiter)
                if timer is not None:
                    timer.cancel()
        if self._fault is not None:
            tell(self._fault)
        return self.over

    def check(self) -> None:
        """Raise if the node is over."""
        if self._fault is not None:
            tell(self._fault)
        if self._over:
            raise NodeClosed("the node has ended")

    def _registered(self) -> Iterator[Advertise | Subscribe]:
        for advertisement in self._advertisements.values():
            yield advertisement.operation
        for subscription in self._subscriptions.values():
            yield subscription.operation

    def _heard(self, message: Publish) -> None:
        for subscription in self._listeners.get(message.topic, ()):
            subscription.offer(message.msg)

    def _told(self, status: Status) -> None:
        """A refused registration is its owner's to hear of; anything else goes to the log."""
        if status.level == "error":
            fault = OperationRejected(status.msg)
            if (advertisement := self._advertisements.pop(str(status.id), None)) is not None:
                advertisement.fault = fault
                advertisement.closed = True
                return
            if (subscription := self._forget(status.id)) is not None:
                subscription.end(fault)
                return
        self._log.log(_LEVELS.get(status.level, logging.INFO), "The hub: %s", status.msg)

    def _forget(self, id_: Id) -> Subscription[Any] | None:
        subscription = self._subscriptions.pop(str(id_), None)
        if subscription is not None:
            listeners = self._listeners[subscription.topic]
            listeners.remove(subscription)
            if not listeners:
                del self._listeners[subscription.topic]
        return subscription

    def _say(self, operation: Advertise | Unadvertise | Subscribe | Unsubscribe) -> None:
        """Send an operation, if there is somebody to hear it: the next hub gets the greeting."""
        if self.outbox.connected:
            self.outbox.put(encode(operation))


def _release(waiter: asyncio.Future[None]) -> None:
    if not waiter.done():
        waiter.set_result(None)
