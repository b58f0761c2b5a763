"""Compression of texts for clients that have negotiated it, as far as there is time for it.

A short text is compressed at once, a long one in a thread, piece by piece in turns with others;
what is sent to the same clients behind it waits, so that the order stays. A text is sent as it is
if compression does not pay, or if there is too much to compress: that costs bytes, and no time.
"""

from __future__ import annotations

import zlib
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from typing import Generic, TypeVar

from fibws.hub.delivery.clock import Workers
from fibws.hub.delivery.send_queue import Bytes, Flusher, SendQueue
from fibws.protocol.deflate import compressor, deflated_frame, text_of

LEAST = 2048
"""Bytes of a frame from which on its text is compressed: shorter ones fit few packets."""
LONG = 16 * 1024
"""Most bytes of a frame that is compressed at once, which takes some tenths of a millisecond."""
SLICE = 256 * 1024
"""Bytes that a thread compresses before it turns to another text."""
SHARE = 0.1
"""Most of the event loop's time that is spent on short texts."""
BURST = 0.005
"""Seconds that may be spent on them at once."""
MOST_AHEAD = 1024 * 1024
"""Bytes of the next slices of all texts from which on no more texts are taken: what waits for a
thread should wait some ten milliseconds at most."""
MOST_HELD = 64 * 1024 * 1024
"""Bytes of all frames that wait for their compression, or for others before them."""
PAYS = 0.9
"""Largest part of a frame that is left of one whose compression pays."""

R = TypeVar("R")
"""The recipients of a frame."""


class Deflater:
    """Compresses the texts of one hub.

    Args:
        workers: compress long ones.
        clock: returns the seconds since some moment in the past.
        most_held: most bytes of frames that wait.
    """

    def __init__(
        self, workers: Workers, clock: Callable[[], float], most_held: int = MOST_HELD
    ) -> None:
        self.held = 0
        """Bytes of the frames that wait."""
        self._workers = workers
        self._clock = clock
        self._most_held = most_held
        self._ahead = 0
        self._left = BURST
        """Seconds that may be spent on short texts now."""
        self._at = clock()

    def deflated(self, frame: bytes, bits: int) -> bytes:
        """Return the frame of a short text compressed, or as it is.

        Args:
            bits: the size of the client's window, as a power of two.
        """
        if len(frame) < LEAST or (text := text_of(frame)) is None:
            return frame
        now = self._clock()
        self._left = min(BURST, self._left + SHARE * (now - self._at))
        self._at = now
        if self._left <= 0:
            return frame
        deflater = compressor(bits)
        made = deflated_frame([deflater.compress(text), deflater.flush(zlib.Z_SYNC_FLUSH)])
        self._left -= self._clock() - now
        return _shorter(made, frame)

    def admit(self, frame: bytes) -> bool:
        """Count a frame that will wait; return False if it does not fit."""
        if self._ahead >= MOST_AHEAD or self.held + len(frame) > self._most_held:
            return False
        self.held += len(frame)
        self._ahead += min(len(frame), SLICE)
        return True

    def release(self, frame: bytes) -> None:
        """Count a frame that was admitted no longer."""
        self.held -= len(frame)
        self._ahead -= min(len(frame), SLICE)

    def start(self, waiting: WaitingFrame[R], bits: int, done: Callable[[], object]) -> None:
        """Compress a long text in a thread, and call a function."""
        self._go_on(_Compression(waiting, bits), done)

    def _go_on(self, compression: _Compression[R], done: Callable[[], object]) -> None:
        def stepped() -> None:
            if compression.is_done:
                done()
            else:
                self._go_on(compression, done)

        self._workers.run(compression.step, stepped)


class WaitingFrame(Generic[R]):
    """A frame that waits for its compression, or for frames before it.

    Attributes:
        frame: as it was made.
        recipients: who gets it.
        made: its compressed form, once there is one.
        is_needed: whether it is still to be compressed.
    """

    __slots__ = ("frame", "is_needed", "made", "recipients")

    def __init__(self, frame: bytes, recipients: R) -> None:
        self.frame = frame
        self.recipients = recipients
        self.made: bytes | None = None
        self.is_needed = True


class _Compression(Generic[R]):
    """The compression of a long text, in steps that any thread may take."""

    def __init__(self, waiting: WaitingFrame[R], bits: int) -> None:
        self._waiting = waiting
        text = text_of(waiting.frame)
        assert text is not None
        self._text = text
        self._at = 0
        self._deflater = compressor(bits)
        self._pieces: list[bytes] = []
        self.is_done = False

    def step(self) -> None:
        """Compress the next slice."""
        self.is_done = not self._waiting.is_needed
        try:
            if not self.is_done:
                self._step()
        except Exception:  # Such as one for lack of memory: the text is sent as it is.
            self.is_done = True

    def _step(self) -> None:
        self._pieces.append(self._deflater.compress(self._text[self._at : self._at + SLICE]))
        self._at += SLICE
        if self._at >= len(self._text):
            self._pieces.append(self._deflater.flush(zlib.Z_SYNC_FLUSH))
            self._waiting.made = _shorter(deflated_frame(self._pieces), self._waiting.frame)
            self.is_done = True


class DeflatedFrames(Generic[R]):
    """The frames for some recipients, which are sent in order.

    Args:
        bits: the size of the recipients' window, as a power of two.
        send: sends a frame.
    """

    __slots__ = ("_bits", "_deflater", "_send", "_waiting")

    def __init__(self, deflater: Deflater, bits: int, send: Callable[[bytes, R], object]) -> None:
        self._deflater = deflater
        self._bits = bits
        self._send = send
        self._waiting: deque[WaitingFrame[R]] = deque()

    def __iter__(self) -> Iterator[WaitingFrame[R]]:
        """Return an iterator over the frames that wait."""
        return iter(list(self._waiting))

    def is_sent_at_once(self, frame: bytes) -> bool:
        """Return whether a frame would wait for nothing."""
        return not self._waiting and (len(frame) <= LONG or text_of(frame) is None)

    def deflated(self, frame: bytes) -> bytes:
        """Return a frame that is sent at once compressed, or as it is."""
        return self._deflater.deflated(frame, self._bits)

    def put(self, frame: bytes, recipients: R) -> None:
        """Send a frame, compressed or not, behind those that wait."""
        if self.is_sent_at_once(frame):
            self._send(self.deflated(frame) if len(frame) <= LONG else frame, recipients)
        elif self._deflater.admit(frame):
            self._waiting.append(WaitingFrame(frame, recipients))
            if len(self._waiting) == 1:
                self._go_on()
        else:
            self.settle()
            self._send(frame, recipients)

    def newest(self) -> R | None:
        """Return the recipients of the last frame that waits; None if none does."""
        return self._waiting[-1].recipients if self._waiting else None

    def settle(self) -> None:
        """Send all frames that wait as they are."""
        for each in self._clear():
            self._send(each.frame, each.recipients)

    def drop(self) -> None:
        """Forget all frames that wait."""
        self._clear()

    def _clear(self) -> list[WaitingFrame[R]]:
        waiting = list(self._waiting)
        self._waiting.clear()
        for each in waiting:
            each.is_needed = False
            self._deflater.release(each.frame)
        return waiting

    def _go_on(self) -> None:
        """Send what waits up to the next long text."""
        while self._waiting:
            first = self._waiting[0]
            if len(first.frame) > LONG and text_of(first.frame) is not None:
                self._deflater.start(first, self._bits, partial(self._started, first))
                return
            self._finish(first.frame if len(first.frame) > LONG else self.deflated(first.frame))

    def _started(self, waiting: WaitingFrame[R]) -> None:
        if waiting.is_needed:
            self._finish(waiting.made or waiting.frame)
            self._go_on()

    def _finish(self, frame: bytes) -> None:
        first = self._waiting.popleft()
        self._deflater.release(first.frame)
        self._send(frame, first.recipients)


class DeflatingSendQueue(SendQueue):
    """The send queue of a client that has negotiated compression: long replies are compressed.

    Messages come compressed, for all their recipients.

    Args:
        bits: the size of the client's window, as a power of two.
    """

    __slots__ = ("_deflated",)

    def __init__(
        self,
        write: Callable[[Bytes], object],
        broken: Callable[[], object],
        flusher: Flusher,
        deflater: Deflater,
        *,
        max_bytes: int,
        bits: int,
    ) -> None:
        super().__init__(write, broken, flusher, max_bytes=max_bytes)
        self.deflate = bits
        self._deflated: DeflatedFrames[None] = DeflatedFrames(deflater, bits, self._reply_now)

    def reply(self, frame: bytes) -> None:
        """Send a frame that may not be dropped, compressed if that pays."""
        self._deflated.put(frame, None)

    def flush(self) -> None:
        """Write the frames of this turn, and the replies that wait, unless paused."""
        self._deflated.settle()
        super().flush()

    def close(self) -> None:
        """Write nothing more, and keep nothing; a frame that is half written is completed."""
        self._deflated.drop()
        super().close()

    def _reply_now(self, frame: bytes, _: None) -> None:
        super().reply(frame)


def _shorter(made: bytes, frame: bytes) -> bytes:
    """Return a compressed frame, or the one that it was made of if that is hardly longer."""
    return made if len(made) <= PAYS * len(frame) else frame
