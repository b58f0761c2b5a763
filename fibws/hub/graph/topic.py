"""A topic: its type, who publishes it and who hears it.

The way of a message through here: `Publisher.publish` checks it, `Topic.deliver` hands it to each
`Channel`, which makes one frame of it for all its subscriptions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any, TypeAlias

from fibws.errors import OperationError
from fibws.hub.graph.channel import Channel
from fibws.hub.graph.encoding import Encoding, Publication
from fibws.hub.graph.peers import Peers
from fibws.hub.graph.publisher import Publisher
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.types import MessageType

Observer: TypeAlias = Callable[[dict[str, Any]], None]
"""A part of the hub itself that is told of each message; it must not change it."""


class Topic:
    """One topic of the graph.

    It has a type while somebody publishes it or subscribes to it with a type; subscriptions that
    name no type wait for one.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.type: MessageType | None = None
        self.publishers: dict[str, Publisher] = {}
        self.channels: dict[tuple[str, Encoding], Channel] = {}
        self.observers: list[Observer] = []
        self.to_publishers = Peers()
        """The publishers that ask who subscribes."""
        self.to_subscribers = Peers()
        """The subscriptions that ask who publishes."""

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

    def subscribers(self) -> Iterator[str]:
        """The nodes of all subscriptions."""
        return (each.node for each in self.subscriptions())

    def update(self, subscription: Subscription) -> None:
        """Take note that a subscription has begun, changed or ended."""
        older, channel = subscription.channel, None
        if subscription.requests:
            key = (subscription.spelling, subscription.encoding)
            channel = self.channels.get(key)
            if channel is None:
                channel = self.channels[key] = Channel(*key)
            channel.add(subscription)
        if older is not None and older is not channel:
            older.remove(subscription)
            if not older:
                del self.channels[older.key]
        subscription.channel = channel
        if channel is None:
            self.to_subscribers.forget(subscription)
        if self.to_publishers:
            self.to_publishers.changed(self.subscribers())

    def add(self, publisher: Publisher) -> None:
        """Take note that a publisher has begun."""
        self.publishers[publisher.node] = publisher
        if self.to_subscribers:
            self.to_subscribers.changed(self.publishers)

    def remove(self, publisher: Publisher) -> None:
        """Take note that a publisher has ended."""
        self.to_publishers.forget(publisher)
        self.publishers.pop(publisher.node, None)
        if self.to_subscribers:
            self.to_subscribers.changed(self.publishers)

    def replay(self, subscription: Subscription) -> None:
        """Send what publishers have latched to one subscription.

        Raises:
            OperationError: it cannot be had in the encoding that the subscription wants.
        """
        for publisher in self.publishers.values():
            publication = publisher.recall()
            if publication is not None and subscription.channel is not None:
                subscription.send(subscription.channel.replay(publication))

    def deliver(self, publication: Publication) -> None:
        """Send a message to all who hear the topic."""
        for channel in self.channels.values():
            try:
                channel.send(publication)
            except OperationError as fault:
                # It cannot be encoded so. Those who asked for that before the type was known are
                # told; the others go on.
                for subscription in channel.subscriptions():
                    subscription.refuse(fault)
        for observe in self.observers:
            observe(publication.message)

    def deliver_to(self, node: str, publication: Publication) -> None:
        """Send a message to one node alone, if it hears the topic."""
        for channel in self.channels.values():
            for subscription in channel.subscriptions():
                if subscription.node == node:
                    try:
                        subscription.offer(channel.frame(publication))
                    except OperationError as fault:
                        subscription.refuse(fault)
