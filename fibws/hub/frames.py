"""WebSocket frames (RFC 6455, section 5), made once for all who hear them."""

from __future__ import annotations

import struct
from collections.abc import Callable

from fibws.protocol.fragments import split
from fibws.protocol.operations import encode

TEXT = 0x81
"""The first byte of a whole text message: final frame, no reserved bits, opcode 1."""
_BINARY = 0x82
"""The first byte of a whole binary message."""
_LENGTH_16 = struct.Struct("!H")
_LENGTH_64 = struct.Struct("!Q")


def text_frame(text: bytes) -> bytes:
    """An unmasked frame with one whole text message."""
    return text_header(len(text)) + text


def text_frames(text: bytes, fragment_size: int | None, new_id: Callable[[], str]) -> bytes:
    """A text's frame; or those of its pieces, if it is longer than they may be."""
    if fragment_size is not None and len(text) > fragment_size:
        pieces = split(text.decode(), fragment_size, new_id())
        frames = b"".join(text_frame(encode(piece)) for piece in pieces)
        if frames:
            return frames
    return text_frame(text)


def binary_frame(data: bytes) -> bytes:
    """An unmasked frame with one whole binary message."""
    return _header(_BINARY, len(data)) + data


def text_header(size: int) -> bytes:
    """What goes before a text of ``size`` bytes to make a frame of it."""
    return _header(TEXT, size)


def _header(first: int, size: int) -> bytes:
    if size < 126:
        return bytes((first, size))
    if size < 65536:
        return bytes((first, 126)) + _LENGTH_16.pack(size)
    return bytes((first, 127)) + _LENGTH_64.pack(size)
