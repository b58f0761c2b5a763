"""The receiving end of a topic."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from fibws.errors import InvalidMessage
from fibws.interfaces import Message
from fibws.node.fault import tell
from fibws.protocol.operations import Subscribe

M = TypeVar("M", bound=Message)


class Subscription(Generic[M]):
    """A topic's messages as they come: ``async for message in subscription``.

    Whoever reads too slowly gets the newest ``queue_size`` messages; `dropped` counts the others.
    Leave it with `close`, or by ``async with``, to stop listening before the node does.
    JSON has no infinity: it arrives as NaN, as with rosbridge.
    """

    def __init__(
        self,
        operation: Subscribe,
        type_: str,
        queue_size: int,
        build: Callable[[Any], M],
        leave: Callable[[Subscription[M]], None],
        log: logging.Logger,
    ) -> None:
        self._operation = operation
        self._type = type_
        self._messages: deque[Any] = deque(maxlen=queue_size)
        self._build = build
        self._leave = leave
        self._log = log
        self._news = asyncio.Event()
        self._ended = False
        self._fault: Exception | None = None
        self._dropped = 0

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

    def close(self) -> None:
        """Stop listening; what was not read yet is gone. Does nothing when called again."""
        if not self._ended:
            self._messages.clear()
            self.end()
            self._leave(self)

    def offer(self, message: Any) -> None:
        """Take a message off the wire."""
        self._dropped += len(self._messages) == self._messages.maxlen
        self._messages.append(message)
        self._news.set()

    def end(self, fault: Exception | None = None) -> None:
        """Nothing more will come, because of ``fault`` if there is one."""
        self._ended = True
        self._fault = fault
        self._news.set()

    def __aiter__(self) -> Subscription[M]:
        return self

    async def __anext__(self) -> M:
        while True:
            while self._messages:
                message = self._messages.popleft()
                try:
                    return self._build(message)
                except InvalidMessage as error:
                    self._log.error("Dropped a message on %s: %s", self.topic, error)
            if self._fault is not None:
                tell(self._fault)
            if self._ended:
                raise StopAsyncIteration
            self._news.clear()
            await self._news.wait()

    async def __aenter__(self) -> Subscription[M]:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()
