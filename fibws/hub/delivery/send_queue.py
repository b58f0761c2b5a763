"""Send queues: the frames that wait for each client, bounded, so that nobody waits for a slow one.

While a client's socket takes data, its frames wait only for the end of the event loop's turn and
leave in one write. While it does not, each subscription keeps its newest messages up to its limit,
and all of them together stay within the client's limit of bytes. Replies are never dropped: a
client whose replies alone exceed the limit is overfull, and to be closed.
"""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Callable
from typing import TypeAlias

from fibws.protocol.frame_queue import FrameQueue, Lane

logger = logging.getLogger("fibws.hub")

Bytes: TypeAlias = bytes | bytearray | memoryview

MOST_UNWRITTEN = 2**22
"""Bytes that may wait for the end of the loop's turn in all send queues together."""
CHUNK = 2**16
"""Bytes of kept messages that are written at once when a slow client reads again: what the socket
has been given can no longer be dropped for something newer."""
LARGE = 2**16
"""Bytes of a frame that is written by itself rather than copied to join it with others."""
WRITE_SIZE = 2**18
"""Bytes of a large frame that are written at once: what the socket does not take of them is copied
by the transport, the rest waits in the frame, which all its recipients share."""


class LargeFrame:
    """A frame in two pieces, so that a large payload need not be copied behind its header.

    Args:
        head: the first bytes.
        body: all others; nobody may change them.
    """

    __slots__ = ("_size", "body", "head")

    def __init__(self, head: bytes, body: Bytes) -> None:
        self.head = head
        self.body = memoryview(body)
        self._size = len(head) + len(body)

    def __len__(self) -> int:
        return self._size


Frame: TypeAlias = bytes | LargeFrame
"""A WebSocket frame, ready to be written."""


def frame_of(head: bytes, body: Bytes) -> Frame:
    """Return a frame made of two pieces: joined, unless the second one is large."""
    return LargeFrame(head, body) if len(body) >= LARGE else b"".join((head, body))


class SendQueue:
    """The frames that wait for one client.

    Args:
        write: writes bytes to the client's socket.
        broken: is called when ``write`` raised.
        flusher: calls `flush` at the end of the loop's turn.
        max_bytes: most bytes that are kept for the client while it does not read.
    """

    __slots__ = (
        "_broken",
        "_fresh",
        "_kept",
        "_replies",
        "_reply_bytes",
        "_rest",
        "_rest_bytes",
        "_socket_full",
        "_write",
        "dropped",
        "flusher",
        "frames",
        "max_bytes",
        "paused",
        "throttled_bytes",
    )

    def __init__(
        self,
        write: Callable[[Bytes], object],
        broken: Callable[[], object],
        flusher: Flusher,
        *,
        max_bytes: int,
    ) -> None:
        self.flusher = flusher
        self.max_bytes = max_bytes
        self.frames: list[Frame] = []
        """Frames to be written at the end of the turn."""
        self.paused = False
        """Whether frames are kept rather than written."""
        self.dropped = 0
        """Messages dropped so far."""
        self.throttled_bytes = 0
        """Bytes that the client's throttles hold back; they count as kept."""
        self._write = write
        self._broken = broken
        self._socket_full = False
        self._rest: list[Frame | memoryview] = []
        """The rest of a large frame that filled the socket, and the frames behind it."""
        self._rest_bytes = 0
        self._replies: list[bytes] = []
        self._fresh: OrderedDict[Callable[[], bytes], None] | None = None
        self._reply_bytes = 0
        self._kept: FrameQueue[Lane, Frame] | None = None

    @property
    def kept_bytes(self) -> int:
        """Bytes that are kept until the client reads, or until a throttle lets them pass."""
        messages = self._kept.size if self._kept is not None else 0
        return messages + self._reply_bytes + self._rest_bytes + self.throttled_bytes

    @property
    def exceeded(self) -> bool:
        """Whether more is kept than allowed, so that messages must be dropped."""
        return self.kept_bytes > self.max_bytes

    @property
    def overfull(self) -> bool:
        """Whether replies alone, which may not be dropped, exceed the limit."""
        return self._reply_bytes > self.max_bytes

    def has_room(self, size: int) -> bool:
        """Return whether a request of another client, of ``size`` bytes, leaves half the limit."""
        return not self.paused or self._reply_bytes + size <= self.max_bytes // 2

    def put(self, frame: Frame, lane: Lane) -> None:
        """Send a message's frame, or keep it in its subscription's lane while paused."""
        if self.paused:
            self.keep(frame, lane)
        else:
            self._send(frame)

    def reply(self, frame: bytes) -> None:
        """Send a frame that may not be dropped; it overtakes kept messages.

        Nothing more is kept for a client that is overfull.
        """
        if not self.paused:
            self._send(frame)
        elif not self.overfull:
            self._replies.append(frame)
            self._reply_bytes += len(frame)

    def reply_fresh(self, make: Callable[[], bytes]) -> None:
        """Send the frames that a function makes, now or when a paused client reads again.

        Nothing of them is kept meanwhile, however often this is called.
        """
        if self.paused:
            self._fresh = self._fresh or OrderedDict()
            self._fresh[make] = None
        elif frame := make():
            self._send(frame)

    def keep(self, frame: Frame, lane: Lane) -> None:
        """Keep a message's frame until the client reads again; drop older ones beyond limits."""
        kept = self._kept
        if kept is None:
            kept = self._kept = FrameQueue()
        kept.put(frame, lane)
        # The lane that exceeds a limit pays for it; its newest message is always kept.
        self.dropped += kept.trim(lane, max(1, lane.limit))
        while self.exceeded and len(lane.waiting) > 1:
            self.dropped += kept.trim(lane, len(lane.waiting) - 1)
        while self.exceeded and len(kept) > 1:
            _, oldest = next(iter(kept))
            assert oldest is not None
            self.dropped += kept.trim(oldest, len(oldest.waiting) - 1)

    def forget(self, lane: Lane) -> None:
        """Remove what is kept for a subscription that has ended."""
        if self._kept is not None:
            self._kept.forget(lane)

    def pause(self) -> None:
        """Keep frames from now on: the client's socket takes no more."""
        self.paused = self._socket_full = True

    def resume(self) -> None:
        """Write what was kept, replies first: the client's socket takes data again."""
        self._socket_full = False
        if self._rest:
            self._write_rest()
            if self._socket_full:
                return
        self.paused = False
        self.frames += self._replies
        self._replies = []
        self._reply_bytes = 0
        self._refill()
        if self.frames and not self.paused:
            self.flusher.add(self)

    def flush(self) -> None:
        """Write the frames of this turn, unless paused."""
        if self.frames and not self.paused:
            frames, self.frames = self.frames, []
            self.write_all(frames)

    def write(self, data: Bytes) -> None:
        """Write the bytes of whole frames, unless the connection is lost or closed."""
        try:
            self._write(data)
        except (OSError, RuntimeError):
            # uvloop raises where asyncio does not; the publisher must not pay for it.
            self.cut_off()

    def write_all(self, frames: list[Frame]) -> None:
        """Write frames in order, the large ones in pieces that are not copied."""
        self._write_pieces(list(frames))

    def _write_pieces(self, pieces: list[Frame | memoryview]) -> None:
        """Write pieces until the socket is full; keep the rest, which may not be dropped."""
        small: list[bytes] = []
        for number, piece in enumerate(pieces):
            if isinstance(piece, bytes):
                small.append(piece)
                continue
            if isinstance(piece, LargeFrame):
                small.append(piece.head)
                piece = piece.body
            if small:
                self.write(b"".join(small))
                small = []
            while piece and not self._socket_full:
                self.write(piece[:WRITE_SIZE])
                piece = piece[WRITE_SIZE:]
            if self._socket_full:
                self._rest = [piece, *pieces[number + 1 :]] if piece else pieces[number + 1 :]
                self._rest_bytes = sum(map(len, self._rest))
                self.paused = True
                return
        if small:
            self.write(b"".join(small))

    def _write_rest(self) -> None:
        rest, self._rest = self._rest, []
        self._rest_bytes = 0
        self._write_pieces(rest)

    def write_control(self, data: bytes) -> None:
        """Write a control frame at once, or behind the large frame that is half written."""
        if self._rest and isinstance(self._rest[0], memoryview):
            # Earlier control frames are the other memoryviews.
            behind = 1
            while behind < len(self._rest) and isinstance(self._rest[behind], memoryview):
                behind += 1
            self._rest.insert(behind, memoryview(data))
            self._rest_bytes += len(data)
        else:
            self.write(data)

    def cut_off(self) -> None:
        """Drop the connection, which cannot be written to."""
        self.close()
        self._broken()

    def close(self) -> None:
        """Write nothing more, and keep nothing; a frame that is half written is completed."""
        rest, self._rest, self._rest_bytes = self._rest, [], 0
        for piece in rest:
            if isinstance(piece, LargeFrame):
                self.write(piece.head)
                piece = piece.body
            self.write(piece)
        self._write = _discard
        self.frames = []
        self._replies = []
        self._fresh = None
        self._reply_bytes = 0
        if self._kept is not None:
            self._kept.clear()

    def _send(self, frame: Frame) -> None:
        if not self.frames:
            self.flusher.add(self)
        self.frames.append(frame)
        self.flusher.count(len(frame))

    def _refill(self) -> None:
        """Write kept messages in pieces of `CHUNK` until the socket is full or none is left.

        The rest stays in the queue, where newer messages can still take its place. Fresh replies
        come first, in pieces, too.
        """
        while self._fresh or self._kept:
            size = 0
            while (self._fresh or self._kept) and size < CHUNK:
                frame = self._pop()
                self.frames.append(frame)
                size += len(frame)
            frames, self.frames = self.frames, []
            self.paused = True  # What is sent meanwhile comes behind the rest.
            self.write_all(frames)
            if self._socket_full:
                return
            self.paused = False
        self._fresh = None
        self._kept = None

    def _pop(self) -> Frame:
        """Remove and return what is to be written next of what is made or kept."""
        if self._fresh:
            make, _ = self._fresh.popitem(last=False)
            return make()
        assert self._kept is not None
        frame, _ = self._kept.pop()
        return frame


def _discard(data: Bytes) -> None:
    """Take the bytes for a closed connection."""


class Flusher:
    """Writes the frames of all send queues at the end of the loop's turn, one write for each.

    Messages that come in the same turn leave together; a single one waits for nothing. When too
    many bytes wait they are written earlier; clients that are too slow for that are paused then,
    and their queues limit what is kept.

    Args:
        call_soon: calls a function at the end of the turn.
    """

    def __init__(self, call_soon: Callable[[Callable[[], None]], object]) -> None:
        self._call_soon = call_soon
        self._due: list[SendQueue] = []
        self._first: list[Callable[[], None]] = []
        self._bytes = 0

    def call_first(self, callback: Callable[[], None]) -> None:
        """Call a function once, right before the next flush; what it sends leaves with that."""
        if not self._due and not self._first:
            self._call_soon(self.flush)
        self._first.append(callback)

    def add(self, queue: SendQueue) -> None:
        """Flush a queue at the end of the turn; it asks for that once a turn."""
        if not self._due:
            self._call_soon(self.flush)
        self._due.append(queue)

    def count(self, size: int) -> None:
        """Count bytes that were put into queues."""
        self._bytes += size
        if self._bytes > MOST_UNWRITTEN:
            self.flush()

    def broadcast(self, frame: Frame, targets: dict[SendQueue, Lane]) -> None:
        """Put one frame into many queues, as `SendQueue.put` does for each: the hub's inner loop.

        Args:
            targets: the queues, each with the lane of the subscription.
        """
        for queue, lane in targets.items():
            if queue.paused:
                queue.keep(frame, lane)
                continue
            if not queue.frames:
                if not self._due:
                    self._call_soon(self.flush)
                self._due.append(queue)
            queue.frames.append(frame)
        self._bytes += len(frame) * len(targets)
        if self._bytes > MOST_UNWRITTEN:
            self.flush()

    def flush(self) -> None:
        """Write what is due.

        Subscribers of the same topics mostly hold equal lists of shared frames: joined once.
        """
        first, self._first = self._first, []
        for callback in first:
            try:
                callback()
            except Exception:
                logger.exception("What was to be sent at the end of a turn failed.")
        due, self._due = self._due, []
        self._bytes = 0
        last: list[Frame] = []
        joined = b""
        for queue in due:
            if queue.paused:
                continue
            frames, queue.frames = queue.frames, []
            try:
                if frames != last:
                    last = frames
                    lone = frames[0] if len(frames) == 1 else None
                    joined = lone if isinstance(lone, bytes) else _joined(frames)
                if joined:
                    queue.write(joined)
                else:
                    queue.write_all(frames)
            except Exception:
                # One client that cannot be written to must not silence those behind it.
                logger.exception("A client is cut off: it could not be written to.")
                queue.cut_off()


def _joined(frames: list[Frame]) -> bytes:
    """Return the frames as one piece; nothing if one of them is large."""
    try:
        return b"".join(frames)  # type: ignore[arg-type]  # A large one raises.
    except TypeError:
        return b""
