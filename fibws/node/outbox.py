"""What a node has yet to send: in order, and bounded."""

from __future__ import annotations

import asyncio
from collections import Counter, OrderedDict
from collections.abc import Callable

from fibws.node.advertisement import Advertisement

LIMIT = 1 << 20
"""Bytes above which those who publish wait for the socket."""

FRAME_COST = 128
"""What a waiting frame costs beside its text, in bytes; it bounds floods of small ones."""


class Outbox:
    """The frames that wait for the socket, oldest first.

    With a hub at the other end it is bounded in bytes, and whoever publishes waits for `room`.
    Without one each advertisement keeps the newest messages of its queue, and nobody waits.
    """

    def __init__(self, limit: int = LIMIT) -> None:
        self._limit = limit
        self._frames: OrderedDict[int, tuple[Advertisement | None, bytes]] = OrderedDict()
        self._number = 0
        self._size = 0
        self._connected = False
        self._closed = False
        self._express: Callable[[bytes], bool] | None = None
        self._hub = asyncio.Event()
        self._arrival = asyncio.Event()
        self._room = asyncio.Event()
        self._room.set()

    @property
    def connected(self) -> bool:
        """Whether frames leave."""
        return self._connected

    @property
    def has_room(self) -> bool:
        """Whether there is room for another message; without a hub there always is."""
        return self._room.is_set()

    def __len__(self) -> int:
        return len(self._frames)

    def unsent(self) -> Counter[str]:
        """How many messages wait, by topic."""
        sources = (source for source, _ in self._frames.values() if source is not None)
        return Counter(source.operation.topic for source in sources)

    def waits(self, text: bytes, source: Advertisement) -> bool:
        """Whether this very message of ``source`` is yet to be sent."""
        return any(self._frames[number][1] is text for number in source.waiting)

    def put(self, text: bytes, source: Advertisement | None = None) -> None:
        """Add a message of ``source``, or an operation that the connection's end voids."""
        if self._express is not None and not self._frames and self._express(text):
            return
        crowded = not self._connected or not self._room.is_set()
        self._number += 1
        self._frames[self._number] = (source, text)
        self._size += len(text) + FRAME_COST
        if source is not None:
            source.waiting.append(self._number)
            if crowded:
                self._trim(source, source.operation.queue_size)
        self._changed()

    def pop(self) -> bytes:
        """Take the oldest frame, which from now on is never sent again."""
        _, (source, text) = self._frames.popitem(last=False)
        self._size -= len(text) + FRAME_COST
        if source is not None:
            source.waiting.popleft()
        self._changed()
        return text

    async def arrival(self) -> bool:
        """Wait until there is a frame to take; false once there never will be."""
        await self._arrival.wait()
        return bool(self._frames)

    async def wait_for_hub(self) -> None:
        """Wait until frames leave, or never will again."""
        await self._hub.wait()

    async def room(self) -> None:
        """Wait until there is room for another message; without a hub, give way for a moment."""
        if not self._connected:
            await asyncio.sleep(0)
        while not self._room.is_set():
            await self._room.wait()

    def open(self) -> None:
        """There is a hub now."""
        self._connected = True
        self._changed()

    def offer_first_to(self, write: Callable[[bytes], bool]) -> None:
        """Until the hub is lost, keep no frame that this takes, as long as no other one waits.

        Args:
            write: is given a frame and tells whether it took it.
        """
        self._express = write

    def lose(self) -> None:
        """There is no hub any more: keep what still can be of use once there is one again."""
        self._connected = False
        self._express = None
        for number, (source, text) in list(self._frames.items()):
            if source is None:
                del self._frames[number]
                self._size -= len(text) + FRAME_COST
            else:
                self._trim(source, 0 if source.closed else source.operation.queue_size)
        self._changed()

    def close(self) -> None:
        """Nothing more will be put; what waits may still leave."""
        self._closed = True
        self._changed()

    def _trim(self, source: Advertisement, keep: int) -> None:
        while len(source.waiting) > keep:
            _, text = self._frames.pop(source.waiting.popleft())
            self._size -= len(text) + FRAME_COST
            source.dropped += 1

    def _changed(self) -> None:
        _signal(self._hub, self._connected or self._closed)
        _signal(self._arrival, bool(self._frames) or self._closed)
        _signal(self._room, not self._connected or self._closed or self._size < self._limit)


def _signal(event: asyncio.Event, on: bool) -> None:
    if on:
        event.set()
    else:
        event.clear()
