"""The receiving end of a topic."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from typing import Any, ClassVar, Generic, NamedTuple, TypeAlias, TypeVar

from pydantic_core import from_json

from fibws.errors import InvalidMessage, NodeClosed, OperationRejected, WaitTimeout
from fibws.interfaces import Message
from fibws.node.peers import Peers
from fibws.node.session import throw
from fibws.node.types import ANY_TYPE, MessageCodec
from fibws.protocol.operations import Subscribe
from fibws.protocol.serialized import ROS1
from fibws.public_classes import AsyncContext, AsyncIterable, made_by

M = TypeVar("M", bound=Message)

MOST_HEADERS = 100
"""Connection headers that a subscription keeps parsed."""


Received: TypeAlias = tuple[Any, bytes | dict[str, str] | None]
"""A message as it arrived: a memoryview of ROS 1's bytes, or JSON values; and its connection
header, as JSON if it is bytes."""


class ReportedType(NamedTuple):
    """The type of a topic, as the hub knows it."""

    name: str
    md5sum: str
    definition: str
    """Its text with those of the types in it; empty if the hub does not send it."""


TakeSerialized: TypeAlias = Callable[[memoryview, bytes, int, ReportedType], object]
"""Takes a message in ROS 1's serialization; its connection header as JSON; when the hub received
it, in nanoseconds since 1970; and its type."""


@made_by("Node.subscribe")
class Subscription(AsyncContext, AsyncIterable, Generic[M]):
    """A topic's messages as they arrive: ``async for message in subscription``.

    A slow reader gets the newest ``queue_size`` messages; `dropped` counts the others. Messages are
    decoded when they are read. Leave it with `close`, or by ``async with``, to stop listening
    before the node does. From a rosbridge_suite server infinity arrives as NaN.
    """

    _other_names: ClassVar = {
        "get": "await anext(subscription)",
        "recv": "await anext(subscription)",
        "receive": "await anext(subscription)",
        "unregister": "subscription.close()",
        "unsubscribe": "subscription.close()",
    }

    # operation: the subscription, as for a server without `fibws.v1`.
    # codec: the codec of its messages.
    # queue_size: most messages that wait for the reader; None for no limit.
    # withdraw: takes the subscription back.
    # log: logs messages that do not fit the type.
    # refused: is called if the hub refuses the subscription.
    def __init__(
        self,
        operation: Subscribe,
        codec: MessageCodec[M],
        queue_size: int | None,
        withdraw: Callable[[Subscription[Any]], None],
        log: logging.Logger,
        refused: Callable[[OperationRejected], None] | None = None,
    ) -> None:
        self._operation = operation
        self._codec = codec
        self._queue_size = queue_size
        self._messages: deque[Received] = deque(maxlen=queue_size)
        self._deserialize = codec.deserialize
        self._withdraw = withdraw
        self._log = log
        self._refused = refused
        self._type = codec.type
        self._news = asyncio.Event()
        self._ended = False
        self._fault: Exception | None = None
        self._dropped = 0
        self._skipped = 0
        """Messages that were too large to be read."""
        self._header: dict[str, str] = {}
        self._headers: dict[bytes, dict[str, str]] = {}
        self._md5sum = codec.md5sum
        self._take: Callable[[Received], object] | None = None
        self._take_serialized: TakeSerialized | None = None
        self.peers = Peers()
        """The nodes that publish the topic, if ``peers=True`` was given."""

    def __repr__(self) -> str:
        return f"<Subscription {self.topic} [{self.type}]>"

    @property
    def topic(self) -> str:
        """The topic's global name."""
        return self._operation.topic

    @property
    def type(self) -> str:
        """The type of its messages, such as ``std_msgs/Int32``.

        That of a subscription to messages of any type (rospy's AnyMsg) is ``*`` until the hub
        reports it.
        """
        return self._type

    @property
    def md5sum(self) -> str | None:
        """The md5 of the type; None while that is unknown."""
        return self._md5sum

    @property
    def dropped(self) -> int:
        """How many messages were dropped: newer ones arrived before they were read, or they were
        larger than the node takes."""
        return self._dropped

    @property
    def connection_header(self) -> dict[str, str]:
        """The connection header of the last message that was read, if ``headers=True`` was given.

        ``callerid`` is the node that published it, and ``latching`` is ``"1"`` or ``"0"``; the
        headers given to `Node.advertise` are beside them. Empty with a rosbridge_suite server.
        """
        return self._header

    def _hand_to(self, take: Callable[[M], object]) -> None:
        """Call a function with each message, in the loop, instead of queueing it for a reader.

        This is for programs with queues of their own; ``async for`` then only waits for the end.
        The function must not raise: it is called while the socket is read.
        """

        def read_and_take(received: Received) -> None:
            message = self._read(received)
            if message is not None:
                take(message)

        self._take = read_and_take

    def _hand_undecoded_to(self, take: Callable[[Received], object]) -> None:
        """Call a function with each message as it arrived, as `_hand_to`, for `_decode`."""
        self._take = take

    def _hand_serialized_to(self, take: TakeSerialized) -> None:
        """Call a function with the bytes of each message, in the loop, as `_hand_to`.

        From a rosbridge_suite server it gets nothing.
        """
        self._take_serialized = take

    def _decode(self, received: Received) -> M | None:
        """Decode a message; return None, and log it, if the message does not fit its type.

        It changes nothing, and may be called in any thread.
        """
        message = received[0]
        try:
            if type(message) is memoryview:
                return self._deserialize(message)
            return self._codec.read(message)
        except InvalidMessage as error:
            self._log.error("Dropped a message on %s: %s", self.topic, error)
            return None

    def close(self) -> None:
        """Stop listening and discard what was not read. Does nothing when called again."""
        if not self._ended:
            self._messages.clear()
            self._end()
            self._withdraw(self)

    def __aiter__(self) -> Subscription[M]:
        return self

    async def __anext__(self) -> M:
        while True:
            while self._messages:
                message = self._read(self._messages.popleft())
                if message is not None:
                    return message
            if self._fault is not None:
                throw(self._fault)
            if self._ended:
                raise StopAsyncIteration
            self._news.clear()
            await self._news.wait()

    async def __aenter__(self) -> Subscription[M]:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    # Called by `Topics`

    @property
    def _id(self) -> str:
        """The id of the subscription."""
        return str(self._operation.id)

    def _registration(self, *, serialized: bool) -> Subscribe:
        """Return the operation that subscribes.

        Args:
            serialized: whether the connection is one of `fibws.v1`.
        """
        if not serialized:
            return self._operation
        return self._operation.model_copy(
            update={
                "compression": ROS1,
                "definition": self._codec.definition,
                "md5sum": self._codec.md5sum,
                "send_definition": True if self._take_serialized is not None else None,
            }
        )

    def _found(self, type_: ReportedType) -> None:
        """Note the topic's type, as the hub reports it."""
        if self._codec.type == ANY_TYPE:
            self._type = type_.name
            self._md5sum = type_.md5sum

    def _offer_serialized(
        self, message: memoryview, header: bytes, received: int, type_: ReportedType
    ) -> bool:
        """Queue a message in ROS 1's serialization, as `_offer`.

        One without its header, if headers were asked for, was sent before the hub knew of this
        subscription, for another one of the node: it is left out.

        Args:
            header: its connection header, as JSON.
            received: when the hub received it, in nanoseconds since 1970.
        """
        if self._operation.headers and not header:
            return False
        if self._take_serialized is None:
            return self._offer(message, header)
        if not self._ended:
            self._take_serialized(message, header, received, type_)
        return False

    def _offer(self, message: Any, header: bytes | dict[str, str] | None = None) -> bool:
        """Queue a message; return whether the queue is full now.

        Args:
            message: a memoryview of ROS 1's bytes, or JSON values.
            header: its connection header, as JSON if it is bytes.
        """
        if self._ended:  # A function that had the same message before may have closed it.
            return False
        if self._take_serialized is not None:
            return False
        if self._take is not None:
            self._take((message, header))
            return False
        messages = self._messages
        waiting = len(messages)
        if not waiting:
            self._news.set()
        elif waiting == self._queue_size:
            self._dropped += 1
            waiting -= 1
        messages.append((message, header))
        return waiting + 1 == self._queue_size

    def _skip(self) -> None:
        """Count a message that was too large to be read."""
        self._dropped += 1
        self._skipped += 1

    def _refuse(self, fault: OperationRejected) -> None:
        """Handle the hub's refusal of the subscription."""
        self._end(fault)
        if self._refused is not None:
            self._refused(fault)

    def _end(self, fault: Exception | None = None) -> None:
        """End the iteration once all messages are read, by raising ``fault`` unless it is None."""
        self._ended = True
        self._fault = fault
        self._news.set()
        self.peers._end()

    def _read(self, received: Received) -> M | None:
        """Decode a message, as `_decode`, and note its connection header."""
        message = self._decode(received)
        if message is not None and self._operation.headers:
            # Without: another subscription of the node may have asked for headers.
            header = received[1]
            self._header = self._parse(header) if isinstance(header, bytes) else header or {}
        return message

    def _parse(self, header: bytes) -> dict[str, str]:
        """Return a connection header that came as JSON."""
        known = self._headers.get(header)
        if known is None:
            if len(self._headers) == MOST_HEADERS:
                self._headers.clear()
            known = self._headers[header] = from_json(header) if header else {}
        return known


async def next_message(subscription: Subscription[M], within: float | None) -> M:
    """Wait for the next message of a subscription and close it; see `Node.wait_for_message`."""
    topic = subscription.topic
    async with subscription:
        try:
            async with asyncio.timeout(within):
                async for message in subscription:
                    return message
        except TimeoutError:
            text = f"timeout exceeded while waiting for message on topic {topic}"
            raise WaitTimeout(text) from None
    raise NodeClosed(f"the node ended while waiting for message on topic {topic}")
