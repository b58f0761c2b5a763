"""WebSocket frames (RFC 6455, section 5) and close reasons, for both ends of a connection.

Nearly every frame is a whole text or binary message. `FrameParser` takes those straight from the
bytes; all other frames, and everything that is wrong, go to the websockets library, which alone
decides about errors. The parser therefore finds every frame's boundary itself and passes the bytes
of all other frames on as they come.
"""

from __future__ import annotations

import re
import struct
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias, TypeVar

try:
    from websockets.speedups import apply_mask
except ImportError:  # The library's pure Python build has it elsewhere.
    from websockets.utils import apply_mask

TEXT: Final = 0x81
"""The first byte of a whole text message: final frame, no reserved bits, opcode 1."""
BINARY: Final = 0x82
"""The first byte of a whole binary message."""
DEFLATED: Final = 0x40
"""The bit in the first byte of a frame that marks a compressed message (RFC 7692)."""
ZERO_KEY: Final = bytes(4)
"""A masking key that changes nothing; see `client_frame`."""
LARGE: Final = 256 * 1024
"""Bytes of a payload from which on it is read into a buffer of its own."""

UNLIMITED: Final = sys.maxsize
"""Stands for the size of messages of a server that tells no limit."""

AHEAD: Final = 1024 * 1024
"""Bytes allocated for a large message at first; more follow as it arrives, up to four times what
has arrived. A peer that announces 60 MB and sends nothing must not make the hub allocate them."""

PIECE: Final = 1024
"""Most bytes that are passed on at once when the library reads everything."""

BEGINNING: Final = 1024
"""Bytes that are kept of a message that is skipped, so that its reader can be told."""

B = TypeVar("B", bytes, memoryview)

Payload: TypeAlias = bytes | bytearray
"""The content of a message; a large one is the buffer that it was read into."""

_SHORT_HEADERS = {
    first: [bytes((first, size)) for size in range(126)]
    for first in (TEXT, BINARY, TEXT | DEFLATED)
}
_NO_MESSAGE = bytearray()
_NO_VIEW = memoryview(_NO_MESSAGE)
_OPCODES = frozenset({0x0, 0x1, 0x2, 0x8, 0x9, 0xA})
_DEFLATED = frozenset({0x41, 0x42, 0xC1, 0xC2})
"""First bytes of frames with which compressed messages begin."""
_NUMBER = re.compile(r"[0-9]{1,18}")
_LENGTH_16 = struct.Struct("!H")
_LENGTH_64 = struct.Struct("!Q")


@dataclass(frozen=True, slots=True)
class CloseReason:
    """A close code (RFC 6455, section 7.4.1) and a reason, which the peer's close event shows.

    Codes from 4000 on are defined by fibws; a client that gets one should not reconnect by itself,
    except with `LIMITED`.
    """

    code: int
    reason: str


SHUTDOWN = CloseReason(1001, "the hub is shutting down")
RESTART = CloseReason(1012, "service restart")
INVALID_UTF8 = CloseReason(1007, "a text is not UTF-8")
INVALID_DEFLATE = CloseReason(1007, "a compressed message cannot be inflated")
STALLED = CloseReason(1008, "stopped reading for too long")
OVERFULL = CloseReason(1008, "too many replies wait to be read")
FRAGMENTS = CloseReason(1009, "too many fragments in one message")
SILENT = CloseReason(1011, "no answer to a ping")
REPLACED = CloseReason(4001, "new node registered with same name")
KILLED = CloseReason(4002, "shutdown request: user request")

TOO_LARGE = 1009
"""The close code for a message that is larger than the hub takes."""
UNAUTHENTICATED = 4401
"""The close code for a token that is missing, unknown, expired or revoked."""
FORBIDDEN = 4403
"""The close code for a missing right."""
LIMITED = 4429
"""The close code for a client that has gone beyond a limit, or tried too many tokens: it may try
again later."""
TOKEN_SUBPROTOCOL = "fibws.token."
"""The beginning of a subprotocol that is a token: scripts of web pages cannot set headers."""
TIME_HEADER = "Fibws-Time"
"""The header of the handshake's response that says how the time goes, if it is not the system's."""
SIMULATED = "simulated"
"""Its value while the parameter /use_sim_time is true."""
SIZE_HEADER = "Fibws-Max-Message-Size"
"""The header of the handshake's response that says how many bytes one message may have: a larger
one closes the connection (code 1009)."""
VALUES_HEADER = "Fibws-Serialized-Values"
"""The header of the handshake's response of a hub that takes calls and goals serialized."""
SERIALIZED = "ros1"
"""Its value."""
LONGEST_TOKEN = 8000
"""Most characters of a token: a line of a request's head has 8192 bytes at most."""
MISSING_TOKEN = CloseReason(UNAUTHENTICATED, "missing token")
EXPIRED = CloseReason(UNAUTHENTICATED, "the token expired")
CERTIFICATE_EXPIRED = CloseReason(UNAUTHENTICATED, "the certificate expired")
MOST_REASON_BYTES = 123
"""Most bytes of a close frame's reason (RFC 6455, section 5.5)."""


def close_reason(code: int, text: str) -> CloseReason:
    """Return a reason for closing, whose text is cut to what a close frame can hold."""
    return CloseReason(code, text.encode()[:MOST_REASON_BYTES].decode("utf-8", "ignore"))


def server_header(first: int, size: int) -> bytes:
    """Return the header of an unmasked frame.

    Args:
        first: `TEXT` or `BINARY`, or ``TEXT | DEFLATED``.
        size: bytes of the payload.
    """
    if size < 126:
        return _SHORT_HEADERS[first][size]
    if size < 65536:
        return bytes((first, 126)) + _LENGTH_16.pack(size)
    return bytes((first, 127)) + _LENGTH_64.pack(size)


def server_frame(first: int, payload: bytes) -> bytes:
    """Return an unmasked frame, as a server sends it; arguments as in `server_header`."""
    return server_header(first, len(payload)) + payload


def client_header(first: int, size: int, key: bytes = ZERO_KEY) -> bytes:
    """Return the header of a masked frame, its key included.

    The RFC asks for unpredictable keys so that a web page cannot choose the bytes that a proxy
    sees. Between two programs on a direct connection neither exists: a connection of `fibws.v1`
    uses the zero key, which saves masking at both ends.
    """
    if size < 126:
        return bytes((first, size | 128)) + key
    if size < 65536:
        return bytes((first, 254)) + _LENGTH_16.pack(size) + key
    return bytes((first, 255)) + _LENGTH_64.pack(size) + key


def client_frame(first: int, payload: bytes, key: bytes = ZERO_KEY) -> bytes:
    """Return a masked frame, as a client sends it; arguments as in `client_header`."""
    masked = payload if key == ZERO_KEY else apply_mask(payload, key)
    return client_header(first, len(payload), key) + masked


def client_payload(frame: B) -> B:
    """Return the payload of a frame that `client_frame` made with the zero key."""
    return frame[header_size(frame) :]


def header_size(frame: bytes | memoryview) -> int:
    """Return the bytes before the payload of a frame that `client_frame` made."""
    size = frame[1] & 127
    return 6 if size < 126 else 8 if size == 126 else 14


def largest_message(header: str | None) -> int:
    """Return how many bytes a server takes in one message, by its header `SIZE_HEADER`.

    Args:
        header: its value; None, as of servers other than fibws, for no limit that is known.
    """
    if header is None or not _NUMBER.fullmatch(header):
        return UNLIMITED
    return int(header)


class FrameParser:
    """Splits the bytes that one peer sends after the handshake.

    A large message is read into a buffer of its own: while `in_large` is true, read the socket into
    `buffer` and call `filled`; otherwise pass the bytes to `receive`.

    Args:
        on_text: takes the payload of a whole text message.
        on_binary: takes the payload of a whole binary message, and owns it.
        on_other: takes the bytes of all other frames, in order; after an error all that follow.
        max_size: most bytes of a message; a longer one is skipped, or left to the library.
        masked: whether frames must be masked, as those of clients are.
        turn: frames that one call of `receive` or `resume` passes on; then it asks ``go_on``.
        go_on: takes how many frames the call has passed on so far, and returns how many more it
            may; 0 pauses.
        on_skipped: takes the bytes of a message that was too long, its first bytes (`BEGINNING` at
            most), and whether it was a text. Without it the library gets such messages, and closes
            the connection.
    """

    __slots__ = (
        "_beginning",
        "_filled",
        "_given_up",
        "_go_on",
        "_key",
        "_key_size",
        "_large",
        "_length",
        "_mask_bit",
        "_message",
        "_on_other",
        "_on_skipped",
        "_skipping",
        "_skips_text",
        "_tail",
        "_through",
        "_turn",
        "_view",
        "deflated",
        "fragmented",
        "in_large",
        "max_size",
        "messages",
        "missing",
        "on_binary",
        "on_text",
        "paused",
    )

    def __init__(
        self,
        on_text: Callable[[Payload], None],
        on_binary: Callable[[Payload], None],
        on_other: Callable[[bytes], None],
        *,
        max_size: int,
        masked: bool,
        turn: int = sys.maxsize,
        go_on: Callable[[int], int] = lambda passed: 0,
        on_skipped: Callable[[int, bytes, bool], None] | None = None,
    ) -> None:
        self.on_text = on_text
        """Takes text messages that begin from now on; may be changed at any time."""
        self.on_binary = on_binary
        """Takes binary messages, likewise."""
        self.deflated: dict[int, Callable[[Payload], None]] = {}
        """Takes whole compressed messages, by the first bytes of their frames; empty unless the
        peer may send such."""
        self.messages = 0
        """Whole messages passed on so far."""
        self._on_other = on_other
        self.max_size = max_size
        """Most bytes of messages that begin from now on; may be changed at any time."""
        self._on_skipped = on_skipped
        self._skipping = 0
        """Bytes of a message that is skipped which are still to come."""
        self._beginning = b""
        """The first bytes of that message."""
        self._mask_bit = 128 if masked else 0
        self._key_size = 4 if masked else 0
        self._tail = bytearray()
        self.missing = 0
        """Bytes without which the frame that has begun cannot be read, outside of a large one."""
        self._through = 0
        """Bytes of the current frame that still belong to the library."""
        self._given_up = False
        self._large: Callable[[Payload], None] | None = None
        """Takes the large message that is being read."""
        self._key = ZERO_KEY
        self._length = 0
        """Bytes of the large message, or of the one that is skipped."""
        self._skips_text = False
        """Whether the message that is skipped is a text."""
        self._message = _NO_MESSAGE
        self._view = _NO_VIEW
        self._filled = 0
        self.in_large = False
        """Whether a large message is being read."""
        self._turn = turn
        self._go_on = go_on
        self.fragmented = False
        """Whether a fragmented message has begun, within which no other message may come."""
        self.paused = False
        """Whether received data is kept until `resume`; stop reading the socket meanwhile."""

    @property
    def large_taker(self) -> Callable[[Payload], None] | None:
        """The callback that will take the large message which is being read."""
        return self._large

    @property
    def kept_bytes(self) -> int:
        """Bytes that were received and not passed on."""
        return len(self._tail) + self._filled

    def pause(self) -> None:
        """Pass on no frame until `resume`; callbacks may call this."""
        self.paused = True

    def resume(self) -> None:
        """Process the kept data, for one turn."""
        self.paused = False
        self.receive(b"")

    def buffer(self) -> memoryview:
        """Return where to read the rest of a large message."""
        return self._view[self._filled :]

    def filled(self, size: int) -> None:
        """Called when ``size`` bytes were read into `buffer`."""
        self._filled += size
        if self._filled == self._length:
            self.in_large = False
            if not self.paused:
                self._finish_large()
        elif self._filled == len(self._view):
            self._grow()

    def receive(self, data: bytes) -> None:
        """Process data from the socket, which may end within a frame."""
        if self._large is not None:
            data = self._fill(data)
            if self._large is not None:  # It is not complete, or kept until `resume`.
                self._tail += data
                return
        if self._tail:
            self._tail += data
            self.missing -= len(data)
            if self.missing > 0:
                return
            data = bytes(self._tail)
            self._tail = bytearray()
            self.missing = 0
        start, end = 0, len(data)
        passed, left = self._turn, self._turn
        while start < end:
            if not left or self.paused:
                left = 0 if self.paused else self._go_on(passed)
                passed += left
                if not left or self.paused:
                    self.paused = True
                    self._tail += memoryview(data)[start:]
                    return
            left -= 1
            if self._given_up or self._through or self._skipping:
                start = self._pass_on(data, start, end)
                continue
            start = self._frame(data, start, end)
            if self.missing:
                self._tail += memoryview(data)[start:]
                return

    def _pass_on(self, data: bytes, start: int, end: int) -> int:
        """Pass on what is not ours to read, or leave it out; return where to continue."""
        if self._skipping:
            return self._skip(data, start, end)
        if self._given_up:
            stop = min(end, start + PIECE)
        else:
            stop = min(end, start + self._through)
            self._through -= stop - start
        self._on_other(data[start:stop])
        return stop

    def _skip(self, data: bytes, start: int, end: int) -> int:
        """Leave out bytes of a message that is too long; return where to continue."""
        stop = min(end, start + self._skipping)
        if (missing := BEGINNING - len(self._beginning)) > 0:
            self._beginning += data[start : min(stop, start + missing)]
        self._skipping -= stop - start
        if not self._skipping:
            beginning, self._beginning = self._beginning, b""
            assert self._on_skipped is not None
            if self._key != ZERO_KEY:
                beginning = apply_mask(beginning, self._key)
            self._on_skipped(self._length, beginning, self._skips_text)
        return stop

    def end(self) -> None:
        """Pass on the rest of a frame: the peer sends no more."""
        if self._tail:
            self._on_other(bytes(self._tail))
            self._tail = bytearray()
        self._drop_large()

    def give_up(self) -> None:
        """Pass on everything from here."""
        self._given_up = True
        self._drop_large()

    # Every frame takes this way: a call of a part of it would take longer than the part.
    def _frame(self, data: bytes, start: int, end: int) -> int:  # noqa: C901, PLR0912
        """Read the frame at ``start`` if it is complete and ours to read.

        Returns:
            Where to continue: behind a message that was taken, otherwise ``start``.
        """
        size = end - start
        if size < 2:
            self.missing = 2 - size
            return start
        first, length = data[start], data[start + 1] - self._mask_bit
        if not 0 <= length < 128 or first & 0x70 or first & 0x0F not in _OPCODES:
            if not (self.deflated and first in _DEFLATED and 0 <= length < 128):
                self.give_up()
                return start
        payload = 2 + self._key_size
        if length == 126:
            payload += 2
            if size < payload:
                self.missing = payload - size
                return start
            (length,) = _LENGTH_16.unpack_from(data, start + 2)
        elif length == 127:
            payload += 8
            if size < payload:
                self.missing = payload - size
                return start
            (length,) = _LENGTH_64.unpack_from(data, start + 2)
        whole = payload + length
        if first == TEXT:
            take = self.on_text
        elif first == BINARY:
            take = self.on_binary
        elif first in self.deflated:
            take = self.deflated[first]
        else:
            self._through = whole
            return start
        body = start + payload
        if self.fragmented or length > self.max_size:
            # The library reports a length that is itself an error (RFC 6455, section 5.2).
            if self.fragmented or self._on_skipped is None or length >> 63:
                self._through = whole
                return start
            if size < payload:
                self.missing = payload - size
                return start
            self._key = data[body - 4 : body] if self._key_size else ZERO_KEY
            self._length = self._skipping = length
            self._skips_text = first == TEXT
            return body
        if size < whole:
            if length < LARGE or size < payload:
                self.missing = (whole if length < LARGE else payload) - size
                return start
            self._key = data[body - 4 : body] if self._key_size else ZERO_KEY
            self._begin_large(take, length, memoryview(data)[body:end])
            return end
        stop = start + whole
        message = data[body:stop]
        if self._key_size and (key := data[body - 4 : body]) != ZERO_KEY:
            message = apply_mask(message, key)
        self.messages += 1
        take(message)
        return stop

    def _begin_large(self, take: Callable[[Payload], None], length: int, first: memoryview) -> None:
        """Begin a message that is read into a buffer of its own; its first bytes are there."""
        self._large = take
        self.in_large = True
        self._length = length
        self._filled = len(first)
        self._message = bytearray(min(length, max(AHEAD, 4 * self._filled)))
        self._view = memoryview(self._message)
        self._view[: self._filled] = first

    def _fill(self, data: bytes) -> bytes:
        """Take the next bytes of a large message; return those behind it."""
        start = 0
        while self.in_large and start < len(data):
            size = min(len(self._view) - self._filled, len(data) - start)
            self._view[self._filled : self._filled + size] = data[start : start + size]
            start += size
            self.filled(size)
        if self._large is not None and not self.in_large and not self.paused:
            self._finish_large()
        return data[start:]

    def _grow(self) -> None:
        """Make room for more of the large message, most of which is still to come."""
        message = bytearray(min(self._length, 4 * len(self._message)))
        message[: self._filled] = self._message
        self._message = message
        self._view = memoryview(message)

    def _finish_large(self) -> None:
        take, message, key = self._large, self._message, self._key
        self._drop_large()
        assert take is not None
        self.messages += 1
        take(message if key == ZERO_KEY else apply_mask(message, key))

    def _drop_large(self) -> None:
        self.in_large = False
        self._large = None
        self._message = _NO_MESSAGE
        self._view = _NO_VIEW
        self._filled = 0
