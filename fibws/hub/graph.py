"""The graph: which nodes there are, which topics, and of which type.

What ROS's master keeps. Two indexes mirror each other: a client's session knows its publishers and
subscriptions, a topic knows those of all clients. Topics that nobody has to do with are deleted, so
that a client which makes up names by the thousand leaves nothing behind.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, Protocol

from fibws.errors import (
    InterfaceError,
    InvalidMessage,
    TypeConflict,
    UnknownPackage,
)
from fibws.hub.topic import MessageType, Topic
from fibws.interfaces import Interfaces, Validators

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
        """The topic of this global name, new if there is none yet."""
        topic = self.topics.get(name)
        if topic is None:
            topic = self.topics[name] = Topic(name)
        return topic

    def establish(self, topic: Topic, type_: str, definition: str | None = None) -> MessageType:
        """Give a topic its type; return what checks its messages.

        Raises:
            TypeConflict: it has another type, and nodes that hold it to that.
            InterfaceError: the type's name is not valid, or its package does not have it.
        """
        try:
            wanted = self._type(type_, definition)
        except InterfaceError:
            self.settle(topic)
            raise
        if topic.type is None:
            topic.type = wanted
        elif topic.type.type != wanted.type:
            holders = topic.holders()
            if holders:
                raise TypeConflict(topic.name, wanted.type, topic.type.type, holders[0])
            topic.type = wanted
        return topic.type

    def settle(self, topic: Topic) -> None:
        """Take note that a publisher or subscription of the topic has gone."""
        for spelling in [name for name, channel in topic.channels.items() if not channel]:
            del topic.channels[spelling]
        if topic.idle:
            self.topics.pop(topic.name, None)
        elif not topic.holders():
            topic.type = None

    def _type(self, name: str, definition: str | None) -> MessageType:
        name = self._interfaces.canonical(name)
        if definition is not None:
            self._interfaces.learn(name, definition)
        try:
            return self._validators.of(name)
        except UnknownPackage as error:
            if self._strict_types:
                raise
            self._times_unchecked += 1
            if str(self._times_unchecked).strip("0") == "1":
                logger.warning("%s. Messages of type %s are relayed unchecked.", error, name)
            return Unchecked(name)
