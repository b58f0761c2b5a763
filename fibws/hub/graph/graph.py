"""The graph: which nodes there are, which topics, and of which type.

What ROS's master keeps. A topic knows its publishers and subscriptions; only the methods here add
and remove them. A topic is kept while it has any, so that a client which makes up names by the
thousand leaves nothing behind.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, Protocol

from fibws.errors import InvalidMessage, TypeConflict, UnknownPackage
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import MessageType, Publisher, Topic
from fibws.hub.session.statuses import is_power_of_ten
from fibws.interfaces import Interfaces, Validators
from fibws.protocol.operations import Id, Subscribe

logger = logging.getLogger("fibws.hub")


class Client(Protocol):
    """What the graph must be able to tell a client."""

    def replaced(self) -> None:
        """Another client has taken its name."""


class Unchecked:
    """A type of a package that nobody defined: its messages are relayed as they come."""

    has_sequenced_header = False

    def __init__(self, type_: str) -> None:
        self.type = type_

    def validate(self, msg: object) -> dict[str, Any]:
        """Only that it is an object can be checked."""
        if not isinstance(msg, dict):
            raise InvalidMessage(
                f"Expected a JSON object for type {self.type} but received a {type(msg).__name__}"
            )
        return msg

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """Nothing is known to be missing."""
        return []


class Graph:
    """The nodes and topics of one hub.

    Args:
        now: gives the nanoseconds since 1970, for messages that ask for the time.
        strict_types: refuse types of unknown packages, rather than relay them unchecked.
    """

    def __init__(
        self, interfaces: Interfaces, now: Callable[[], int], *, strict_types: bool = False
    ) -> None:
        self.topics: dict[str, Topic] = {}
        self.nodes: dict[str, Client] = {}
        self._interfaces = interfaces
        self._validators = Validators(interfaces, now)
        self._strict_types = strict_types
        self._times_unchecked = 0
        self._clients = 0

    def enter(self, client: Client, name: str | None) -> str:
        """Give a client the name it asked for, or one of the hub's making; return it.

        Whoever had the name is told that it lost it, as ROS's master shuts down the older node.
        """
        if name is None:
            name = self._new_name()
        older = self.nodes.pop(name, None)
        self.nodes[name] = client
        if older is not None:
            try:
                older.replaced()
            except Exception:
                # The newcomer must not pay for what is wrong with the older one.
                logger.exception("%s: the older node of this name could not leave.", name)
        return name

    def _new_name(self) -> str:
        while True:
            self._clients += 1
            name = f"/client_{self._clients}"
            if name not in self.nodes:
                return name

    def leave(self, client: Client, name: str) -> None:
        """Forget a client, unless its name has gone to another."""
        if self.nodes.get(name) is client:
            del self.nodes[name]

    def topic(self, name: str) -> Topic:
        """The topic of this global name; a new one is kept once somebody has to do with it."""
        return self.topics.get(name) or Topic(name)

    def add_publisher(
        self, topic: Topic, node: str, type_: str, definition: str | None = None, *, latch: bool
    ) -> Publisher:
        """The node's publisher of a topic; the first call decides ``latch``.

        Raises:
            TypeConflict: the topic has another type, and nodes that hold it to that.
            InterfaceError: the type's name is not valid, or its package does not have it.
        """
        message_type = self._establish(topic, type_, definition)
        publisher = topic.publishers.get(node)
        if publisher is None:
            publisher = Publisher(node, topic, message_type, latch=latch)
            topic.publishers[node] = publisher
            self.topics[topic.name] = topic
        return publisher

    def remove_publisher(self, publisher: Publisher) -> None:
        """Let a publisher go."""
        publisher.topic.publishers.pop(publisher.node, None)
        self._settle(publisher.topic)

    def subscribe(self, subscription: Subscription, request: Subscribe) -> None:
        """Add a request to a subscription, which may be a new one; raises as `add_publisher`."""
        if request.type is not None:
            self._establish(subscription.topic, request.type)
        try:
            subscription.request(request)
            subscription.topic.update(subscription)
            self.topics[subscription.topic.name] = subscription.topic
        finally:
            # A request may be one too many, or take the place of one that named the type.
            self._settle(subscription.topic)

    def unsubscribe(self, subscription: Subscription, id_: Id) -> None:
        """Take back one request of a subscription, or all if ``id_`` is None."""
        subscription.cancel(id_)
        subscription.topic.update(subscription)
        self._settle(subscription.topic)

    def _establish(self, topic: Topic, type_: str, definition: str | None = None) -> MessageType:
        """Give a topic its type; return what checks its messages."""
        name = self._interfaces.canonical(type_)
        if topic.type is not None and topic.type.type == name and definition is None:
            return topic.type
        if topic.type is not None and topic.type.type != name and topic.held:
            raise TypeConflict(topic.name, name, topic.type.type, topic.holder())
        wanted = self._type(name, definition)
        if topic.type is None or topic.type.type != name:
            topic.type = wanted
        return topic.type

    def _settle(self, topic: Topic) -> None:
        """Forget what nobody holds any more: the topic, or its type."""
        if topic.idle:
            self.topics.pop(topic.name, None)
        elif topic.type is not None and not topic.held:
            topic.type = None

    def _type(self, name: str, definition: str | None) -> MessageType:
        if definition is not None:
            self._interfaces.learn(name, definition)
        try:
            return self._validators.of(name)
        except UnknownPackage as error:
            if self._strict_types:
                raise
            self._times_unchecked += 1
            if is_power_of_ten(self._times_unchecked):
                logger.warning("%s. Messages of type %s are relayed unchecked.", error, name)
            return Unchecked(name)
