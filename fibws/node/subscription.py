"""The receiving end of a topic."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from fibws.errors import InvalidMessage
from fibws.interfaces import Message
from fibws.node.fault import throw
from fibws.node.peers import Peers
from fibws.protocol.operations import Subscribe

M = TypeVar("M", bound=Message)


class Subscription(Generic[M]):
    """A topic's messages as they come: ``async for message in subscription``.

    Whoever reads too slowly gets the newest ``queue_size`` messages; `dropped` counts the others.
    Leave it with `close`, or by ``async with``, to stop listening before the node does.
    JSON has no infinity: it arrives as NaN, as with rosbridge, unless headers are asked for.
    """

    def __init__(
        self,
        operation: Subscribe,
        type_: str,
        queue_size: int | None,
        build: Callable[[Any], M],
        leave: Callable[[Subscription[M]], None],
        log: logging.Logger,
    ) -> None:
        self._operation = operation
        self._type = type_
        self._messages: deque[tuple[Any, dict[str, str] | None]] = deque(maxlen=queue_size)
        self._build = build
        self._leave = leave
        self._log = log
        self._news = asyncio.Event()
        self._ended = False
        self._fault: Exception | None = None
        self._dropped = 0
        self._header: dict[str, str] = {}
        self._take: Callable[[M], object] | None = None
        self.peers = Peers()
        """The nodes that publish the topic, if `Node.subscribe` was told to ask for them."""

    def __repr__(self) -> str:
        return f"<Subscription {self.topic} [{self.type}]>"

    @property
    def topic(self) -> str:
        """The topic's global name."""
        return self._operation.topic

    @property
    def type(self) -> str:
        """The type of its messages, such as ``std_msgs/Int32``."""
        return self._type

    @property
    def operation(self) -> Subscribe:
        """What asks the hub for the topic."""
        return self._operation

    @property
    def dropped(self) -> int:
        """How many messages made way for newer ones before they were read."""
        return self._dropped

    @property
    def connection_header(self) -> dict[str, str]:
        """The header of the message that was read last, if `Node.subscribe` was told to ask.

        ``callerid`` is the node that published it, and ``latching`` is ``"1"`` or ``"0"``; what
        `Node.advertise` was given as headers is beside them. Empty if nobody asked for it, or
        nobody knows: not every hub tells it.
        """
        return self._header

    @property
    def is_full(self) -> bool:
        """Whether the next message makes the oldest one go that is not read yet."""
        return len(self._messages) == self._messages.maxlen

    def hand_to(self, take: Callable[[M], object]) -> None:
        """Give each message to a function, in the loop, rather than keep it for a reader.

        That is for programs with queues of their own; who reads then only hears of the end. The
        function must not raise: it is called by what reads the socket.
        """
        self._take = take

    def close(self) -> None:
        """Stop listening; what was not read yet is gone. Does nothing when called again."""
        if not self._ended:
            self._messages.clear()
            self.end()
            self._leave(self)

    def offer(self, message: Any, header: dict[str, str] | None = None) -> None:
        """Take a message off the wire, with its header if it has one."""
        if self._ended:  # Another one's function, which had the same message before, closed it.
            return
        if self._take is not None:
            built = self._read(message, header)
            if built is not None:
                self._take(built)
            return
        self._dropped += self.is_full
        self._messages.append((message, header))
        self._news.set()

    def end(self, fault: Exception | None = None) -> None:
        """Nothing more will come, because of ``fault`` if there is one."""
        self._ended = True
        self._fault = fault
        self._news.set()
        self.peers.end()

    def __aiter__(self) -> Subscription[M]:
        return self

    async def __anext__(self) -> M:
        while True:
            while self._messages:
                message = self._read(*self._messages.popleft())
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

    def _read(self, values: Any, header: dict[str, str] | None) -> M | None:
        """The message of these values; None if they do not fit its type, which is logged."""
        try:
            message = self._build(values)
        except InvalidMessage as error:
            self._log.error("Dropped a message on %s: %s", self.topic, error)
            return None
        # Another subscription of the node may have asked for it.
        self._header = header or {} if self._operation.headers else {}
        return message
