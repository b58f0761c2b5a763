"""Compression of single messages."""

from __future__ import annotations

import random
import zlib

import pytest
from websockets.extensions.permessage_deflate import PerMessageDeflate
from websockets.frames import Frame, Opcode

from fibws.protocol.deflate import MOST_BITS, PIECE, inflate

LIBRARY = PerMessageDeflate(True, True, MOST_BITS, MOST_BITS, {})


def compressed(message: bytes) -> bytes:
    """The payload as a client sends it."""
    return bytes(LIBRARY.encode(Frame(Opcode.TEXT, message)).data)


def inflated(data: bytes, max_size: int = 2**26) -> tuple[bytes, list[int]]:
    """The message, and the sizes of the pieces in which it was inflated."""
    pieces: list[int] = []
    steps = inflate(data, max_size, pieces.append)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return bytes(end.value), pieces


@pytest.mark.parametrize("size", [0, 1, 1000, PIECE - 1, PIECE, PIECE + 1, 3 * PIECE + 5])
@pytest.mark.parametrize("is_random", [False, True])
def test_message_is_inflated_in_pieces(size: int, is_random: bool) -> None:
    chance = random.Random(size)
    message = chance.randbytes(size) if is_random else b"ab" * (size // 2) + b"c" * (size % 2)
    found, pieces = inflated(compressed(message))
    assert found == message
    assert max(pieces) <= PIECE
    assert sum(pieces) == size


def test_message_may_end_with_a_final_block() -> None:
    """RFC 7692, section 7.2.3.4."""
    assert inflated(bytes.fromhex("f348cdc9c9070000"))[0] == b"Hello"


def test_message_that_is_too_long_ends_at_the_limit() -> None:
    bomb = compressed(bytes(100 * PIECE))
    pieces: list[int] = []
    with pytest.raises(OverflowError, match=f"frame exceeds limit of {3 * PIECE} bytes"):
        for _ in inflate(bomb, 3 * PIECE, pieces.append):
            pass
    assert pieces == 3 * [PIECE]
    assert inflated(compressed(bytes(3 * PIECE)), 3 * PIECE)[0] == bytes(3 * PIECE)


def test_invalid_data_are_refused() -> None:
    with pytest.raises(zlib.error):
        inflated(b"\xff\xff\xff")
