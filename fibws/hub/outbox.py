"""The outbox: the frames that wait for one client, bounded, so that nobody waits for a slow one.

While the client's socket takes data, frames wait only for the end of the loop's turn and leave in
one write. While it does not, each subscription keeps its newest messages up to its queue's limit,
and all of them together stay within the client's limit of bytes. Replies are not dropped: a client
for which they alone break the limit is overfull, and to be closed.
"""

from __future__ import annotations

import logging
from collections import OrderedDict, deque
from collections.abc import Callable

from fibws.hub.budget import Budget

logger = logging.getLogger("fibws.hub")

MOST_UNWRITTEN = 2**22
"""Bytes that may wait for the end of the loop's turn in all outboxes, frames' headers included."""


class Queue:
    """What one subscription may keep while its client does not read.

    Args:
        limit: messages; one more drops the oldest (ROS's queue_size).
    """

    __slots__ = ("dropped", "limit", "waiting")

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.dropped = 0
        self.waiting: deque[int] = deque()
        """The numbers of this queue's messages in the outbox, the oldest first."""


class Outbox:
    """The frames that wait for one client.

    Args:
        write: takes the bytes of one or many frames.
        broken: is called when ``write`` raised.
        flusher: is told when there is something to send.
        max_bytes: what may be kept for the client, frames' headers included.
    """

    __slots__ = (
        "_broken",
        "_kept",
        "_latest",
        "_number",
        "_replies",
        "_reply_bytes",
        "_write",
        "budget",
        "dropped",
        "flusher",
        "frames",
        "paused",
    )

    def __init__(
        self,
        write: Callable[[bytes], object],
        broken: Callable[[], object],
        flusher: Flusher,
        *,
        max_bytes: int,
    ) -> None:
        self.flusher = flusher
        self.budget = Budget(max_bytes)
        self.frames: list[bytes] = []
        """What leaves at the end of the turn."""
        self.paused = False
        self.dropped = 0
        self._write = write
        self._broken = broken
        self._replies: list[bytes] = []
        self._latest: dict[object, bytes] | None = None
        self._kept: OrderedDict[int, tuple[bytes, Queue]] | None = None
        self._number = 0
        self._reply_bytes = 0

    @property
    def kept_bytes(self) -> int:
        """Bytes that wait for their turn, or for the client to read."""
        return self.budget.used

    @property
    def overfull(self) -> bool:
        """Whether replies alone, which may not be dropped, break the limit."""
        return self._reply_bytes > self.budget.limit

    def has_room(self, size: int) -> bool:
        """Whether a reply of that many bytes leaves room for others: half of the limit."""
        return not self.paused or self._reply_bytes + size <= self.budget.limit // 2

    def put(self, frame: bytes, queue: Queue) -> None:
        """Send a message's frame, or keep it in its subscription's queue if the client is slow."""
        if self.paused:
            self.keep(frame, queue)
            return
        if not self.frames:
            self.flusher.add(self)
        self.frames.append(frame)
        self.flusher.count(len(frame))

    def reply(self, frame: bytes) -> None:
        """Send a frame that may not be dropped; it overtakes the messages that are kept.

        Once the client is overfull, nothing more is kept for it.
        """
        if self.paused:
            if not self.overfull:
                self._replies.append(frame)
                self.budget.used += len(frame)
                self._reply_bytes += len(frame)
            return
        if not self.frames:
            self.flusher.add(self)
        self.frames.append(frame)
        self.flusher.count(len(frame))

    def latest(self, key: object, frame: bytes) -> None:
        """As `reply`, but while the client does not read, only the newest of a key is kept."""
        if not self.paused:
            self.reply(frame)
        elif not self.overfull:
            latest = self._latest = self._latest or {}
            size = len(frame) - len(latest.get(key, b""))
            latest[key] = frame
            self.budget.used += size
            self._reply_bytes += size

    def write(self, data: bytes) -> None:
        """Write the bytes of whole frames, unless the connection is lost or closed."""
        try:
            self._write(data)
        except (OSError, RuntimeError):
            # uvloop raises where asyncio is silent; the publisher must not pay for it.
            self.cut_off()

    def flush(self) -> None:
        """Write what waits, unless paused."""
        if self.frames and not self.paused:
            frames, self.frames = self.frames, []
            self.write(b"".join(frames))

    def cut_off(self) -> None:
        """The connection is of no use any more."""
        self.close()
        self._broken()

    def close(self) -> None:
        """Nothing may be written any more."""
        self._write = _discard

    def pause(self) -> None:
        """The client's socket takes no more."""
        self.paused = True

    def resume(self) -> None:
        """The client's socket takes data again: what was kept is due, the replies first."""
        self.paused = False
        self.frames += self._replies
        self.frames += (self._latest or {}).values()
        self.budget.used -= self._reply_bytes
        self._replies = []
        self._latest = None
        self._reply_bytes = 0
        for frame, queue in (self._kept or {}).values():
            self.frames.append(frame)
            self.budget.used -= len(frame)
            queue.waiting.clear()
        self._kept = None
        if self.frames:
            self.flusher.add(self)

    def keep(self, frame: bytes, queue: Queue) -> None:
        """Keep a message's frame in its subscription's queue until the client reads again."""
        kept = self._kept
        if kept is None:
            kept = self._kept = OrderedDict()
        self._number += 1
        kept[self._number] = (frame, queue)
        queue.waiting.append(self._number)
        self.budget.used += len(frame)
        # The queue that breaks a bound pays for it; its newest message is always kept.
        while len(queue.waiting) > 1 and (len(queue.waiting) > queue.limit or self.budget.exceeded):
            self._drop_oldest(queue)
        while self.budget.exceeded and len(kept) > 1:
            self._drop_oldest(next(iter(kept.values()))[1])

    def forget(self, queue: Queue) -> None:
        """Drop what is kept for a subscription that has ended."""
        while queue.waiting:
            self._drop(queue.waiting.popleft())

    def _drop_oldest(self, queue: Queue) -> None:
        self._drop(queue.waiting.popleft())
        queue.dropped += 1
        self.dropped += 1

    def _drop(self, number: int) -> None:
        assert self._kept is not None
        frame, _ = self._kept.pop(number)
        self.budget.used -= len(frame)


def _discard(data: bytes) -> None:
    """Where the bytes for a closed connection go."""


class Flusher:
    """Writes what waits in the outboxes at the end of the loop's turn, one write for each.

    However many messages come until then leave together; a lone one waits for nothing. What would
    take too much memory until then leaves earlier, upon which those who are too slow for it are
    paused, and their queues bound what is kept.

    Args:
        call_soon: calls back at the end of the turn.
    """

    def __init__(self, call_soon: Callable[[Callable[[], None]], object]) -> None:
        self._call_soon = call_soon
        self._due: list[Outbox] = []
        self._bytes = 0

    def add(self, outbox: Outbox) -> None:
        """Have an outbox flushed; it says so once a turn."""
        if not self._due:
            self._call_soon(self.flush)
        self._due.append(outbox)

    def count(self, size: int) -> None:
        """Take note of bytes that were put into outboxes since this was last called."""
        self._bytes += size
        if self._bytes > MOST_UNWRITTEN:
            self.flush()

    def flush(self) -> None:
        """Write what is due.

        Subscribers of the same topics mostly hold equal lists of shared frames: joined once.
        """
        due, self._due = self._due, []
        self._bytes = 0
        joined: list[bytes] = []
        data = b""
        for outbox in due:
            if outbox.paused:
                continue
            frames, outbox.frames = outbox.frames, []
            try:
                if frames != joined:
                    joined, data = frames, b"".join(frames)
                if frames:
                    outbox.write(data)
            except Exception:
                # One client that cannot be written to must not silence those behind it.
                logger.exception("A client is cut off: it could not be written to.")
                outbox.cut_off()
