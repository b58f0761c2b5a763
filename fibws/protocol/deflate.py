"""Compression of single messages: permessage-deflate (RFC 7692) without context takeover.

Each message is compressed by itself, so that all recipients of a message can share one frame.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Generator, Iterator
from typing import Final

from fibws.protocol.websocket import DEFLATED, TEXT, Payload, server_header

MOST_BITS: Final = 15
"""The size of deflate's largest window, as a power of two."""
PIECE: Final = 64 * 1024
"""Most bytes that are inflated at once, which takes some tenths of a millisecond."""

_LEVEL = 1
"""JSON becomes hardly smaller at the others, which take up to three times as long."""
_INPUT = 16 * 1024
_TAIL = b"\x00\x00\xff\xff"
"""What ends each message, and is not sent (RFC 7692, section 7.2.1)."""


def inflate(
    data: Payload, max_size: int, on_piece: Callable[[int], object]
) -> Generator[None, None, bytearray]:
    """Inflate a message, one piece with each step, and return it.

    Args:
        data: the payloads of the message's frames, joined.
        max_size: most bytes of the message.
        on_piece: takes the size of each piece.

    Raises:
        OverflowError: the message is longer than that.
        zlib.error: the data are not a compressed message.
    """
    inflater = zlib.decompressobj(-MOST_BITS)
    message = bytearray()
    for compressed in _pieces(data):
        rest: bytes | memoryview = compressed
        while True:
            piece = inflater.decompress(rest, PIECE)
            message += piece
            if len(message) > max_size:
                raise OverflowError(f"frame exceeds limit of {max_size} bytes")
            on_piece(len(piece))
            yield
            rest = inflater.unconsumed_tail
            if len(piece) < PIECE and not rest:
                break
    return message


def _pieces(data: Payload) -> Iterator[bytes | memoryview]:
    """Yield the data and their end; in pieces, as zlib copies the rest for each piece of output."""
    if len(data) <= _INPUT:
        yield bytes(data) + _TAIL
        return
    with memoryview(data) as view:
        for start in range(0, len(data), _INPUT):
            yield view[start : start + _INPUT]
    yield _TAIL


def compressor(bits: int) -> zlib._Compress:
    """Return what compresses one message for clients with a window of so many bits."""
    return zlib.compressobj(_LEVEL, zlib.DEFLATED, -bits)


def deflated_frame(pieces: list[bytes]) -> bytes:
    """Return the frame of a text of which these are the compressed pieces, the last one flushed.

    Args:
        pieces: as of `compressor`, ending with a flush in the mode ``Z_SYNC_FLUSH``.
    """
    payload = b"".join(pieces)[: -len(_TAIL)]
    return server_header(TEXT | DEFLATED, len(payload)) + payload


def text_of(frame: bytes) -> memoryview | None:
    """Return the text in a server's frame; None if it holds anything else than one whole text."""
    if frame[0] != TEXT:
        return None
    start = {126: 4, 127: 10}.get(frame[1], 2)
    size = frame[1] if start == 2 else int.from_bytes(frame[2:start])
    return memoryview(frame)[start:] if start + size == len(frame) else None
