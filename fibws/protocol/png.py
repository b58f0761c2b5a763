"""The png encoding: a text as the pixels of an image, because PNG compresses it.

As in rosbridge_library's pngcompression.py the bytes of the text, padded with line feeds, are the
red, green and blue values of an image that is about as wide as it is high.
"""

from __future__ import annotations

import json
import re
import struct
import zlib
from base64 import b64encode
from math import ceil, isqrt

_NOT_ASCII = re.compile(r"[^\x00-\x7f]+")
_CHANNELS = 3
_LEVEL = 1
"""The fastest level of zlib: the best one takes several times longer and saves little."""


def encode_png(text: bytes) -> str:
    """Return JSON text as a PNG file (RGB, 8 bits) in base64.

    Characters outside ASCII are escaped: roslib 1 decodes each byte as one character.
    """
    if not text.isascii():
        text = _NOT_ASCII.sub(_escaped, text.decode()).encode()
    pixels = len(text) / _CHANNELS
    width = max(1, isqrt(len(text) // _CHANNELS))
    height = max(1, ceil(pixels / width))
    row = width * _CHANNELS
    padded = text.ljust(height * row, b"\n")
    # Each row begins with the number of its filter: 0, none.
    rows = b"".join(b"\0" + padded[start : start + row] for start in range(0, len(padded), row))
    header = struct.pack("!2I5B", width, height, 8, 2, 0, 0, 0)
    image = (_chunk(b"IHDR", header), _chunk(b"IDAT", zlib.compress(rows, _LEVEL)))
    return b64encode(b"\x89PNG\r\n\x1a\n" + b"".join(image) + _chunk(b"IEND", b"")).decode()


def _escaped(characters: re.Match[str]) -> str:
    return json.dumps(characters[0])[1:-1]


def _chunk(kind: bytes, data: bytes) -> bytes:
    checksum = zlib.crc32(kind + data)
    return struct.pack("!I", len(data)) + kind + data + struct.pack("!I", checksum)
