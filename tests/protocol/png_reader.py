"""A reader of PNG files, from their specification (ISO/IEC 15948, https://www.w3.org/TR/png-3/).

It reads images like those of rosbridge_suite (8 bits each of red, green and blue, not interlaced),
with any filters.
"""

from __future__ import annotations

import zlib
from base64 import b64decode
from collections.abc import Iterator
from struct import unpack

SIGNATURE = bytes([137, 80, 78, 71, 13, 10, 26, 10])
PIXEL = 3


def read_png(data: bytes) -> tuple[int, int, bytes]:
    """Return the image's width, its height and the bytes of its pixels."""
    assert data.startswith(SIGNATURE)
    chunks = list(_chunks(data[len(SIGNATURE) :]))
    kinds = [kind for kind, _ in chunks]
    assert (kinds[0], kinds[-1]) == (b"IHDR", b"IEND")
    assert set(kinds[1:-1]) == {b"IDAT"}
    width, height, depth, colours, compression, filters, interlace = unpack("!2I5B", chunks[0][1])
    assert (depth, colours, compression, filters, interlace) == (8, 2, 0, 0, 0)
    assert width > 0 < height
    rows = zlib.decompress(b"".join(each for kind, each in chunks if kind == b"IDAT"))
    size = width * PIXEL
    assert len(rows) == height * (1 + size)
    pixels, above = bytearray(), bytes(size)
    for start in range(0, len(rows), 1 + size):
        above = _unfiltered(rows[start], rows[start + 1 : start + 1 + size], above)
        pixels += above
    return width, height, bytes(pixels)


def read_text(encoded: str) -> bytes:
    """Return the text in a base64 image, without the line feeds that pad it."""
    _, _, pixels = read_png(b64decode(encoded, validate=True))
    return pixels.rstrip(b"\n")


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    while data:
        size, kind = unpack("!I4s", data[:8])
        content = data[8 : 8 + size]
        (checksum,) = unpack("!I", data[8 + size : 12 + size])
        assert zlib.crc32(kind + content) == checksum
        yield kind, content
        data = data[12 + size :]


def _unfiltered(filter_: int, row: bytes, above: bytes) -> bytes:
    """Return the row as it was before it was filtered (section 9.2)."""
    found = bytearray()
    for position, value in enumerate(row):
        left = found[position - PIXEL] if position >= PIXEL else 0
        corner = above[position - PIXEL] if position >= PIXEL else 0
        up = above[position]
        guess = (0, left, up, (left + up) // 2, _paeth(left, up, corner))[filter_]
        found.append((value + guess) % 256)
    return bytes(found)


def _paeth(left: int, up: int, corner: int) -> int:
    estimate = left + up - corner
    return min((left, up, corner), key=lambda each: abs(estimate - each))
