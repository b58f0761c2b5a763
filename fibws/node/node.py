"""A node: one program's, or one part's, place on the ROS graph."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable
from typing import Any, Self, TypeVar, overload

from fibws import names
from fibws.interfaces import Message, Time
from fibws.node import address
from fibws.node.connection import Connection
from fibws.node.log import FORMAT, node_log
from fibws.node.publisher import P, Publisher
from fibws.node.rate import Rate
from fibws.node.rosout import Rosout
from fibws.node.session import Session
from fibws.node.subscription import Subscription
from fibws.node.types import Types
from fibws.protocol.operations import Advertise, Subscribe

M = TypeVar("M", bound=Message)

NO_REMAPPING = names.Remapping()


class Node:
    """Connects to a hub, publishes and subscribes: ``async with fibws.Node("talker") as node``.

    Entering, which is done once, waits until the hub answers. Leaving sends what still waits if
    that takes no more than 0.6 s, and logs a warning with the number of messages that were not. In
    between the node finds its hub again whenever that goes away, and registers with it as before.

    Args:
        name: a name with no namespace in it; a remapping of ``__name`` goes before it.
        hub: ``ws://host:port`` or ``host:port``; else $FIBWS_HUB, else this machine.
        anonymous: make the name one that no other node has.
        namespace: where relative names belong; else $ROS_NAMESPACE, else ``/``.
        remapping: what the command line renames.
        log_format: the console's line, as ROSCONSOLE_FORMAT writes it; else that variable.

    Raises:
        InvalidName: a name is not legal.
        InvalidAddress: the hub's address is none.
    """

    def __init__(
        self,
        name: str,
        *,
        hub: str | None = None,
        anonymous: bool = False,
        namespace: str | None = None,
        remapping: names.Remapping = NO_REMAPPING,
        log_format: str | None = None,
    ) -> None:
        names.check_base(name)
        if remapping.node_name is not None:
            name = remapping.node_name
        elif anonymous:
            name = names.anonymous(name, pid=os.getpid(), milliseconds=time.time_ns() // 1_000_000)
        environment = os.environ
        self._namespace = names.check_namespace(
            remapping.namespace or namespace or environment.get("ROS_NAMESPACE", "/")
        )
        self._name = names.resolve(name, namespace=self._namespace)
        self._remapping = remapping
        self._hub = address.hub_url(hub or environment.get(address.ENVIRONMENT) or address.DEFAULT)
        self._types = Types(time.time_ns)
        self.log = node_log(
            self._name, log_format or environment.get("ROSCONSOLE_FORMAT") or FORMAT
        )
        """The node's own logger: what it is told goes to the console and to /rosout."""
        self._session = Session(self.log)
        self._rosout = Rosout(self._name, self._session)
        self.log.addHandler(self._rosout)
        self._connection = Connection(self._hub, self._name, self._session, self.log)

    def __repr__(self) -> str:
        return f"<Node {self._name} at {self._hub}>"

    @property
    def name(self) -> str:
        """The node's global name, such as ``/robot/talker``."""
        return self._name

    @property
    def namespace(self) -> str:
        """The namespace that relative names belong to."""
        return self._namespace

    @property
    def hub(self) -> str:
        """The URL of the node's hub."""
        return self._hub

    def resolve(self, name: str) -> str:
        """The global name that ``name`` stands for here, remappings included."""
        return self._remapping.apply(name, namespace=self._namespace, node=self._name)

    def now(self) -> Time:
        """The time of day."""
        return Time.from_nanoseconds(time.time_ns())

    @overload
    async def advertise(
        self, topic: str, type: Callable[P, M], *, queue_size: int = ..., latch: bool = ...
    ) -> Publisher[M, P]: ...

    @overload
    async def advertise(
        self, topic: str, type: str, *, queue_size: int = ..., latch: bool = ...
    ) -> Publisher[Any, ...]: ...

    async def advertise(
        self, topic: str, type: Any, *, queue_size: int = 10, latch: bool = False
    ) -> Publisher[Any, ...]:
        """Begin to publish on a topic.

        If the hub refuses, the next publish raises OperationRejected.

        Args:
            topic: its name, which is resolved and remapped.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            queue_size: how many messages are kept while there is no hub.
            latch: whether the hub keeps the last message for those who subscribe later. It is
                published anew after each reconnection, so listeners may hear it again.

        Raises:
            InvalidName: the topic's name is not legal.
            InterfaceError: there is no such type.
            ValueError: ``queue_size`` is less than 1.
            NodeClosed: the node has ended.
        """
        _check_queue_size(queue_size)
        topic = self.resolve(topic)
        message_class = self._types.message_class(type)
        name = message_class._type
        operation = Advertise(
            id=self._session.id("advertise", topic),
            topic=topic,
            type=name,
            latch=latch,
            queue_size=queue_size,
            definition=self._types.definition(name),
        )
        advertisement = self._session.advertise(operation)
        return Publisher(self._session, advertisement, message_class, self._types.validate(name))

    @overload
    def subscribe(self, topic: str, type: type[M], *, queue_size: int = ...) -> Subscription[M]: ...

    @overload
    def subscribe(self, topic: str, type: str, *, queue_size: int = ...) -> Subscription[Any]: ...

    def subscribe(
        self, topic: str, type: type[Any] | str, *, queue_size: int = 10
    ) -> Subscription[Any]:
        """Begin to listen to a topic: ``async for message in node.subscribe(...)``.

        If the hub refuses, the reading raises OperationRejected.

        Args:
            topic: its name, which is resolved and remapped.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            queue_size: how many messages wait for a slow reader; then the newest ones stay.

        Raises:
            InvalidName: the topic's name is not legal.
            InterfaceError: there is no such type.
            ValueError: ``queue_size`` is less than 1.
            NodeClosed: the node has ended.
        """
        _check_queue_size(queue_size)
        topic = self.resolve(topic)
        message_class = self._types.message_class(type)
        operation = Subscribe(
            id=self._session.id("subscribe", topic),
            topic=topic,
            type=message_class._type,
            queue_length=queue_size,
        )
        subscription: Subscription[Any] = Subscription(
            operation,
            message_class._type,
            queue_size,
            self._types.reader(message_class),
            self._session.unsubscribe,
            self.log,
        )
        self._session.subscribe(subscription)
        return subscription

    def rate(self, hz: float) -> Rate:
        """Ticks for a loop, until the node ends: ``async for _ in node.rate(10)``.

        Raises:
            ValueError: ``hz`` is not a finite number above 0.
        """
        return Rate(hz, self._session.ended)

    async def spin(self) -> None:
        """Wait until the node ends; raise the reason if it was not the program's own doing."""
        await self._session.ended()

    async def __aenter__(self) -> Self:
        if self._rosout.loop is not None:
            raise RuntimeError("a node is entered once")
        self._rosout.loop = asyncio.get_running_loop()
        await self._connection.open()
        return self

    async def __aexit__(self, *error: object) -> None:
        await self._connection.close()


def _check_queue_size(queue_size: int) -> None:
    if queue_size < 1:
        raise ValueError(f"queue_size is at least 1, not {queue_size}")
