"""The frames that a node has yet to write to its socket: in order, and bounded."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable, Iterable
from threading import get_ident
from typing import Protocol

from fibws.errors import MessageTooLarge
from fibws.protocol.frame_queue import FrameQueue, Lane
from fibws.protocol.websocket import UNLIMITED, header_size

LIMIT = 1 << 20
"""Bytes in the queue from which on publishers wait for the socket."""
FRAME_COST = 128
"""Bytes that a frame in the queue counts for besides its own; it bounds floods of small ones."""
TURN = 64
"""Messages that a publisher may send before other tasks get a turn of the loop."""
CHUNK = 64 * 1024
"""Bytes up to which small frames are joined into one write; a larger frame is written alone."""


class PublisherLane(Lane):
    """One publisher's share of the queue.

    Args:
        limit: most messages that wait while there is no hub (ROS's queue_size).
        topic: the topic's global name.
        to_json: returns a message's frame as rosbridge's ``publish`` operation (JSON).
    """

    __slots__ = ("to_json", "topic")

    def __init__(self, limit: int, topic: str, to_json: Callable[[bytes], bytes]) -> None:
        super().__init__(limit)
        self.topic = topic
        self.to_json = to_json


class Writer(Protocol):
    """A connection to write to; it reports by `OutgoingQueue.pause` and `resume` if it is slow."""

    def write(self, frame: bytes, lane: PublisherLane | None) -> None:
        """Write one frame."""

    def write_joined(self, frames: list[tuple[bytes, PublisherLane | None]]) -> None:
        """Write several small frames at once."""

    @property
    def is_behind(self) -> bool:
        """Whether the transport still holds bytes that the socket did not take."""


class OutgoingQueue:
    """Writes frames at once while the socket keeps up, and queues them otherwise.

    The first frame of a turn of the event loop is written at once; those that follow in the same
    turn are written together at its end. With a hub the queue is bounded in bytes, and publishers
    wait for `room`. Without one each lane keeps its newest messages, and publishers never wait.

    A frame is complete as it is put: it has a WebSocket header with the zero key
    (`protocol.websocket.client_header`).
    """

    def __init__(self, limit: int = LIMIT) -> None:
        self._limit = limit
        self._queue: FrameQueue[PublisherLane] = FrameQueue(cost=FRAME_COST)
        self._loop: asyncio.AbstractEventLoop
        self._thread = 0
        """The loop's thread."""
        self._writer: Writer | None = None
        self._held = False
        """Whether frames wait though there is a hub; see `connect`."""
        self._paused = False
        self._gathering = False
        """Whether `_end_turn` is about to be called."""
        self._left = TURN
        self._closed = False
        self.largest = UNLIMITED
        """Bytes that the hub takes in one message; without a hub, those that the last one took."""
        self.ready = False
        """Whether a publisher may send without waiting for `room`, as seen in the loop."""
        self._hub = asyncio.Event()
        self._room = asyncio.Event()
        self._room.set()
        self._empty = asyncio.Event()

    def __len__(self) -> int:
        return len(self._queue)

    @property
    def connected(self) -> bool:
        """Whether there is a hub."""
        return self._writer is not None

    @property
    def has_room(self) -> bool:
        """Whether `room` returns at once; without a hub it does."""
        return self.ready or self._writer is None

    @property
    def size(self) -> int:
        """Bytes in the queue, `FRAME_COST` for each frame included."""
        return self._queue.size

    def unsent(self) -> Counter[str]:
        """Return how many messages wait, by topic."""
        return Counter(lane.topic for _, lane in self._queue if lane is not None)

    def waiting(self) -> set[int]:
        """Return the identities (`id`) of the frames that wait."""
        return {id(frame) for frame, _ in self._queue}

    def check_size(self, frame: bytes, what: str) -> None:
        """Raise `MessageTooLarge` if the hub does not take a frame.

        Args:
            what: the topic, service or action that it is for.
        """
        if len(frame) > self.largest:
            size = len(frame) - header_size(frame)
            if size > self.largest:
                raise MessageTooLarge(what, size, self.largest)

    def put(self, frame: bytes, lane: PublisherLane | None = None) -> None:
        """Write or queue a frame.

        Call it in the loop's thread, or in another one that acts for the loop while that sleeps
        (`rospy.background`).

        Args:
            lane: the publisher's; None for an operation, which is void once the hub is lost.
        """
        writer, queue = self._writer, self._queue
        if writer is None:
            self._put_without_hub(frame, lane)
            return
        if not self._gathering:
            in_loop = get_ident() == self._thread
            if in_loop:
                self._gathering = True
                self._loop.call_soon(self._end_turn)
            if not (self._paused or self._held or queue.size):
                writer.write(frame, lane)
                if in_loop:
                    self._left -= 1
                elif writer.is_behind:
                    # The loop sleeps and does not know that it has to watch the socket.
                    self._loop.call_soon_threadsafe(_wake)
                return
        full = queue.size >= self._limit
        queue.put(frame, lane)
        self._left -= 1
        if full and lane is not None:
            queue.trim(lane, lane.limit)
        if queue.size >= self._limit:
            self.ready = False
            self._room.clear()
        elif self._left <= 0:
            self.ready = False

    def _put_without_hub(self, frame: bytes, lane: PublisherLane | None) -> None:
        self._queue.put(frame, lane)
        if lane is not None:
            self._queue.trim(lane, lane.limit)

    async def room(self) -> None:
        """Wait while the socket is slower than the program, and give other tasks their turns."""
        if not self.ready:
            await asyncio.sleep(0)
        while not self._room.is_set():
            await self._room.wait()

    async def wait_for_hub(self) -> None:
        """Wait until there is a hub, or will never be one again."""
        await self._hub.wait()

    async def emptied(self) -> None:
        """Wait until the queue is closed and all is in the socket, or the hub is lost."""
        await self._empty.wait()

    # Called by the connection

    def connect(
        self,
        writer: Writer,
        first: Iterable[tuple[bytes, PublisherLane | None]] = (),
        *,
        hold: bool = False,
    ) -> list[MessageTooLarge]:
        """Begin to write to a hub; return why messages that have waited are dropped.

        Args:
            first: frames to write before those in the queue: registrations.
            hold: keep the queue until `release`.
        """
        self._loop = asyncio.get_running_loop()
        self._thread = get_ident()
        self._writer = writer
        self._held = hold
        self._paused = False
        self._left = TURN
        faults = self._drop_too_large()
        for batch in _batches(first):
            writer.write_joined(batch)
        if not hold:
            self._flush()
        self._changed()
        return faults

    def release(self) -> None:
        """Write what was held since `connect`."""
        if self._held:
            self._held = False
            self._flush()
            self._changed()

    def disconnect(self) -> None:
        """Keep what can be sent to the next hub: the newest messages of each publisher."""
        if self._writer is None:
            return
        self._writer = None
        self._held = self._paused = False
        kept = self._messages()
        self._keep(kept)
        for _, lane in kept:
            self._queue.trim(lane, lane.limit)
        self._changed()

    def _drop_too_large(self) -> list[MessageTooLarge]:
        """Drop the messages in the queue that this hub does not take; return why."""
        fitting = []
        faults = []
        for frame, lane in self._messages():
            try:
                self.check_size(frame, lane.topic)
                fitting.append((frame, lane))
            except MessageTooLarge as fault:
                lane.dropped += 1
                faults.append(fault)
        if faults:
            self._keep(fitting)
        return faults

    def _messages(self) -> list[tuple[bytes, PublisherLane]]:
        """Return the messages that wait; operations are void without their connection."""
        return [(frame, lane) for frame, lane in self._queue if lane is not None]

    def _keep(self, messages: list[tuple[bytes, PublisherLane]]) -> None:
        """Replace all that waits by these messages."""
        self._queue.clear()
        for frame, lane in messages:
            self._queue.put(frame, lane)

    def pause(self) -> None:
        """Queue frames: the socket is behind."""
        self._paused = True

    def resume(self) -> None:
        """Write again: the socket took all that was written."""
        self._paused = False
        if self._writer is not None and not self._held:
            self._flush()
            self._changed()

    def close(self) -> None:
        """Note that nothing more will be put; what waits may still be written."""
        self._closed = True
        self._changed()

    def _end_turn(self) -> None:
        """Write what was gathered in a turn of the loop."""
        self._gathering = False
        self._left = TURN
        if self._queue.size or not self.ready:
            if self._writer is not None and not self._held:
                self._flush()
            self._changed()

    def _flush(self) -> None:
        """Write frames until the queue is empty or the socket is behind."""
        queue, writer = self._queue, self._writer
        assert writer is not None
        batch: list[tuple[bytes, PublisherLane | None]] = []
        size = 0
        while queue.size and not self._paused:
            frame, lane = queue.pop()
            size += len(frame)
            if size < CHUNK:
                batch.append((frame, lane))
                continue
            if batch:
                writer.write_joined(batch)
                batch = []
            writer.write(frame, lane)
            size = 0
        if batch:
            writer.write_joined(batch)

    def _changed(self) -> None:
        """Wake the tasks whose conditions are met now."""
        connected = self._writer is not None
        room = not connected or self._closed or self._queue.size < self._limit
        self.ready = connected and room and self._left > 0
        _signal(self._hub, connected or self._closed)
        _signal(self._room, room)
        empty = self._closed and not self._queue.size and not self._paused
        _signal(self._empty, not connected or empty)


def _batches(
    frames: Iterable[tuple[bytes, PublisherLane | None]],
) -> Iterable[list[tuple[bytes, PublisherLane | None]]]:
    """Split frames into writes of about `CHUNK` bytes."""
    batch: list[tuple[bytes, PublisherLane | None]] = []
    size = 0
    for frame, lane in frames:
        batch.append((frame, lane))
        size += len(frame)
        if size >= CHUNK:
            yield batch
            batch, size = [], 0
    if batch:
        yield batch


def _signal(event: asyncio.Event, on: bool) -> None:
    if on:
        event.set()
    else:
        event.clear()


def _wake() -> None:
    """Do nothing: the loop is awake, which is all that is wanted."""
