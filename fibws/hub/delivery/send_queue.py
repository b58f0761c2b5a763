"""Send queues: the frames that wait for each client, bounded; a slow client delays no other.

While a client's socket takes data, its frames wait only for the end of the event loop's turn and
leave in one write. While it does not, each subscription keeps its newest messages up to its limit,
and all of them together stay within the client's limit of bytes. Replies are never dropped: a
client whose replies alone exceed the limit is overfull, and to be closed.
"""

from __future__ import annotations

import logging
from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from typing import Any, TypeAlias

from fibws.hub.delivery.byte_allowance import ByteAllowance
from fibws.protocol.frame_queue import EMPTY, FrameQueue, Lane

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
"""Most bytes that are written at once: what the socket does not take of them is copied by the
transport, the rest waits in the frames, which all their recipients share."""


class LargeFrame:
    """A frame in two pieces, so that a large payload need not be copied behind its header.

    Args:
        head: the first bytes.
        body: all others; they must not be changed.
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
        "_unwritten",
        "_write",
        "bytes_sent",
        "deflate",
        "dropped",
        "flusher",
        "frames",
        "max_bytes",
        "messages_sent",
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
        self.deflate = 0
        """The size of the client's window for compressed texts, as a power of two; 0 for none."""
        self.frames: list[Frame] = []
        """Frames to be written at the end of the turn."""
        self.paused = False
        """Whether frames are kept rather than written."""
        self.dropped = 0
        """Messages dropped so far."""
        self.messages_sent = 0
        """Messages written so far, to the socket or what asyncio keeps for it."""
        self.bytes_sent = 0
        """Bytes written so far."""
        self.throttled_bytes = 0
        """Bytes that the client's throttles hold back; they count as kept."""
        self._write = write
        self._broken = broken
        self._socket_full = False
        self._rest: deque[Frame | memoryview | bytearray] = EMPTY
        """The rest of the frame that filled the socket, and the frames behind it."""
        self._rest_bytes = 0
        self._unwritten = 0
        """Bytes of `frames` while paused."""
        self._replies: deque[bytes] = EMPTY
        self._fresh: OrderedDict[Callable[[], Frame], None] | None = None
        self._reply_bytes = 0
        self._kept: FrameQueue[Lane, Frame] | None = None

    @property
    def kept_bytes(self) -> int:
        """Bytes that are kept until the client reads, or until a throttle lets them pass."""
        messages = self._kept.size if self._kept is not None else 0
        started = self._unwritten + self._rest_bytes
        return messages + self._reply_bytes + started + self.throttled_bytes

    @property
    def begun_bytes(self) -> int:
        """Bytes of the frame that is half written that are sent, but held as long as the rest."""
        first = self._rest[0] if self._rest else None
        return memoryview(first.obj).nbytes - len(first) if isinstance(first, memoryview) else 0

    @property
    def kept_messages(self) -> int:
        """Messages and replies that are kept until the client reads, and are ready to be sent."""
        return len(self._kept or ()) + len(self._replies)

    @property
    def own_bytes(self) -> int:
        """The kept bytes without those of messages, which clients share."""
        return self._reply_bytes + self.throttled_bytes

    def buffers(self) -> Iterator[Any]:
        """Yield the holders of the kept messages; other clients may share them."""
        kept = (frame for frame, _ in self._kept or ())
        for piece in chain(kept, self.frames, self._rest):
            view = piece.body if isinstance(piece, LargeFrame) else piece
            yield view.obj if isinstance(view, memoryview) else view

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
            if self._replies is EMPTY:
                self._replies = deque()
            self._replies.append(frame)
            self._reply_bytes += len(frame)
            self._grow(len(frame))
            self.shorten(self.max_bytes)

    def reply_fresh(self, make: Callable[[], Frame]) -> None:
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
        self._grow(len(frame))
        # The lane that exceeds a limit pays for it; its newest message is always kept.
        self.dropped += kept.trim(lane, max(1, lane.limit))
        while self.exceeded and len(lane.waiting) > 1:
            self.dropped += kept.trim(lane, len(lane.waiting) - 1)
        self.shorten(self.max_bytes)

    def shorten(self, size: int, least: int = 1) -> None:
        """Drop the oldest messages until ``size`` bytes are kept, or ``least`` messages."""
        kept = self._kept
        while kept and len(kept) > least and self.kept_bytes > size:
            _, oldest = next(iter(kept))
            assert oldest is not None
            self.dropped += kept.trim(oldest, len(oldest.waiting) - 1)

    def _grow(self, size: int) -> None:
        """Report bytes that are kept from now on."""
        allowance = self.flusher.allowance
        allowance.left -= size
        if allowance.left < 0:
            allowance.check()

    def forget(self, lane: Lane) -> None:
        """Remove the frames of a subscription that has ended."""
        if self._kept is not None:
            self._kept.forget(lane)

    def pause(self) -> None:
        """Keep frames from now on: the client's socket takes no more."""
        self.paused = self._socket_full = True
        self._unwritten = sum(map(len, self.frames))

    def resume(self) -> None:
        """Write the kept frames, replies first: the client's socket takes data again."""
        self._socket_full = False
        if self._rest:
            self._write_rest()
            if self._socket_full:
                return
        self.paused = False
        self._unwritten = 0
        self._refill()
        if self.frames and not self.paused:
            self.flusher.add(self)

    def flush(self) -> None:
        """Write the frames of this turn, unless paused."""
        if self.frames and not self.paused:
            frames, self.frames = self.frames, []
            self.messages_sent += len(frames)
            self.write_all(frames)

    def write(self, data: Bytes) -> None:
        """Write the bytes of whole frames, unless the connection is lost or closed."""
        self.bytes_sent += len(data)
        try:
            self._write(data)
        except (OSError, RuntimeError):
            # uvloop raises where asyncio does not; the publisher must not pay for it.
            self.cut_off()

    def write_all(self, frames: Iterable[Frame]) -> None:
        """Write frames in order, in pieces that the socket takes; the rest may not be dropped."""
        if self._rest is EMPTY:
            self._rest = deque()
        self._rest += frames
        self._rest_bytes = sum(map(len, self._rest))
        self._write_rest()
        if self._rest:
            self._grow(self._rest_bytes)

    def _write_rest(self) -> None:
        """Write until the socket is full: small frames together, large ones without a copy."""
        rest = self._rest
        while rest and not self._socket_full:
            small: list[bytes] = []
            size = 0
            while rest and isinstance(frame := rest[0], bytes) and size + len(frame) <= WRITE_SIZE:
                small.append(frame)
                size += len(frame)
                rest.popleft()
            if rest and isinstance(large := rest[0], LargeFrame):
                small.append(large.head)
                rest[0] = large.body
            if small:
                data: Bytes = b"".join(small)
            else:
                piece = memoryview(rest.popleft())  # type: ignore[arg-type]  # No large frame.
                data = piece[:WRITE_SIZE]
                if len(piece) > WRITE_SIZE:
                    rest.appendleft(piece[WRITE_SIZE:])
            self._rest_bytes -= len(data)
            self.write(data)
        if rest:
            self.paused = True

    def write_control(self, data: bytes) -> None:
        """Write a control frame at once, or behind the large frame that is half written."""
        rest = self._rest
        if rest and isinstance(rest[0], memoryview | bytearray):
            # Control frames that wait behind the first piece are one bytearray.
            if len(rest) > 1 and isinstance(controls := rest[1], bytearray):
                controls += data
            else:
                rest.insert(1, bytearray(data))
            self._rest_bytes += len(data)
            self.shorten(self.max_bytes)
        else:
            self.write(data)

    def cut_off(self) -> None:
        """Drop the connection, which cannot be written to."""
        self._rest.clear()
        self.close()
        self._broken()

    def close(self) -> None:
        """Write nothing more, and keep nothing; a frame that is half written is completed."""
        rest = list(self._rest)
        self._rest.clear()
        self._rest_bytes = 0
        for piece in rest:
            if isinstance(piece, LargeFrame):
                self.write(piece.head)
                piece = piece.body
            self.write(piece)
        self._write = _discard
        self.frames = []
        self._unwritten = 0
        self._replies.clear()
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
        """Write kept frames in pieces of `CHUNK` until the socket is full or nothing is left.

        The rest stays in the queue, where newer messages can still take its place. Replies come
        first.
        """
        while self._replies or self._fresh or self._kept:
            size = 0
            while size < CHUNK and (frame := self._pop()) is not None:
                self.frames.append(frame)
                size += len(frame)
            frames, self.frames = self.frames, []
            self.messages_sent += len(frames)
            self.write_all(frames)
            if self._socket_full:
                return
        self._fresh = None
        self._kept = None

    def _pop(self) -> Frame | None:
        """Remove and return the next frame to write; None if there is none."""
        if self._replies:
            reply = self._replies.popleft()
            self._reply_bytes -= len(reply)
            return reply
        while self._fresh:
            make, _ = self._fresh.popitem(last=False)
            if frame := make():
                return frame
        if self._kept:
            frame, _ = self._kept.pop()
            return frame
        return None


def _discard(data: Bytes) -> None:
    """Take the bytes for a closed connection."""


class Flusher:
    """Writes the frames of all send queues at the end of the loop's turn, one write for each.

    Messages that come in the same turn leave together; a single one waits for nothing. When too
    many bytes wait they are written earlier; clients that are too slow for that are paused then,
    and their queues limit what is kept.

    Args:
        call_soon: calls a function at the end of the turn.
        allowance: reduced by the bytes that the queues keep.
        max_unwritten: most bytes that may wait for that in all queues together.
    """

    def __init__(
        self,
        call_soon: Callable[[Callable[[], None]], object],
        *,
        allowance: ByteAllowance | None = None,
        max_unwritten: int = MOST_UNWRITTEN,
    ) -> None:
        self.allowance = allowance or ByteAllowance()
        self._call_soon = call_soon
        self._max_unwritten = max_unwritten
        self._due: list[SendQueue] = []
        self._first: list[Callable[[], None]] = []
        self._bytes = 0

    def call_first(self, callback: Callable[[], None]) -> None:
        """Call a function once, right before the next flush, which includes what it sends."""
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
        if self._bytes > self._max_unwritten:
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
        if self._bytes > self._max_unwritten:
            self.flush()

    def flush(self) -> None:
        """Write all frames that are due.

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
        pieces: list[Frame] = []
        joined = b""
        for queue in due:
            if queue.paused:
                continue
            frames, queue.frames = queue.frames, []
            queue.messages_sent += len(frames)
            try:
                if frames != last:
                    last = pieces = frames
                    lone = frames[0] if len(frames) == 1 else None
                    joined = lone if isinstance(lone, bytes) else _joined(frames)
                    if len(joined) > WRITE_SIZE:
                        pieces, joined = [joined], b""
                if joined:
                    queue.write(joined)
                else:
                    queue.write_all(pieces)
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
