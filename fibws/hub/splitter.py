"""WebSocket frames, split without a detour (RFC 6455, section 5).

Nearly every frame that a client sends is a whole text message. The `Splitter` takes those straight
from the bytes; whatever else there is, and whatever is wrong, goes to the websockets library, whose
verdict is the only one. It therefore stops at every frame's boundary by itself, and hands the bytes
of all other frames on as they come.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from fibws.hub.frames import TEXT

try:
    from websockets.speedups import apply_mask
except ImportError:  # The library's pure Python build has it elsewhere.
    from websockets.utils import apply_mask

_OPCODES = frozenset({0x0, 0x1, 0x2, 0x8, 0x9, 0xA})
_LENGTH_16 = struct.Struct("!H")
_LENGTH_64 = struct.Struct("!Q")


class Splitter:
    """Splits one client's bytes after the handshake.

    Args:
        on_text: takes the payload of a whole text message.
        on_other: takes the bytes of all other frames, in order; after an error also all the rest.
        max_size: the bytes that a message may have.
    """

    __slots__ = (
        "_given_up",
        "_max_size",
        "_on_other",
        "_on_text",
        "_tail",
        "_through",
        "fragmented",
        "missing",
    )

    def __init__(
        self,
        on_text: Callable[[bytes], None],
        on_other: Callable[[bytes], None],
        *,
        max_size: int,
    ) -> None:
        self._on_text = on_text
        self._on_other = on_other
        self._max_size = max_size
        self._tail = bytearray()
        self._through = 0
        self._given_up = False
        self.missing = 0
        """Bytes without which the frame that has begun cannot be read."""
        self.fragmented = False
        """Whether a fragmented message has begun, within which no text message may come."""

    def receive(self, data: bytes) -> None:
        """Take what the socket gave, however it cuts the frames."""
        if self._tail:
            self._tail += data
            self.missing -= len(data)
            if self.missing > 0:
                return
            data = bytes(self._tail)
            self._tail = bytearray()
            self.missing = 0
        start, end = 0, len(data)
        while start < end:
            if self._given_up:
                self._on_other(data[start:])
                return
            if self._through:
                stop = min(end, start + self._through)
                self._through -= stop - start
                self._on_other(data[start:stop])
                start = stop
                continue
            start = self._frame(data, start, end)
            if self.missing:
                self._tail += memoryview(data)[start:]
                return

    def end(self) -> None:
        """The client sends no more: what is left of a frame is the library's to judge."""
        if self._tail:
            self._on_other(bytes(self._tail))

    def give_up(self) -> None:
        """Hand on all the rest, whatever it is."""
        self._given_up = True

    def _frame(self, data: bytes, start: int, end: int) -> int:
        """Read the frame at ``start``, if it is there and ours to read.

        Returns where to go on: behind a text message that is done with, else at ``start``.
        """
        size = end - start
        if size < 2:
            self.missing = 2 - size
            return start
        first, length = data[start], data[start + 1] - 128
        if length < 0 or first & 0x70 or first & 0x0F not in _OPCODES:
            self.give_up()
            return start
        payload = 6
        if length == 126:
            payload = 8
            if size < payload:
                self.missing = payload - size
                return start
            (length,) = _LENGTH_16.unpack_from(data, start + 2)
        elif length == 127:
            payload = 14
            if size < payload:
                self.missing = payload - size
                return start
            (length,) = _LENGTH_64.unpack_from(data, start + 2)
        whole = payload + length
        if first != TEXT or self.fragmented or length > self._max_size:
            self._through = whole
            return start
        if size < whole:
            self.missing = whole - size
            return start
        body, stop = start + payload, start + whole
        self._on_text(apply_mask(data[body:stop], data[body - 4 : body]))
        return stop
