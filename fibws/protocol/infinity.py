"""JSON text in which infinity stays what it is, for those who can read it.

JSON has no word for infinity, but it has numbers that no float can hold: parsers make infinity of
them. NaN stays null.
"""

from __future__ import annotations

import re

from pydantic_core import to_json

INFINITE = b"1e999"

_TOKEN = re.compile(rb'"[^"\\]*(?:\\.[^"\\]*)*"|Infinity|NaN')
_WORDS = {b"Infinity": INFINITE, b"NaN": b"null"}


def exact_json_of(value: object) -> bytes:
    """A value as JSON text: as `operations.json_of`, but that infinity is not null."""
    text = to_json(value, inf_nan_mode="constants", bytes_mode="base64")
    if b"Infinity" not in text and b"NaN" not in text:
        return text
    return _TOKEN.sub(_written, text)


def _written(token: re.Match[bytes]) -> bytes:
    return _WORDS.get(token[0], token[0])
