"""Values as JSON text, with and without infinity.

JSON has no infinity and no NaN: rosbridge writes null for both. `exact_json_of` writes infinity as
a number that is too large for a float, which parsers read as infinity.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

from pydantic_core import from_json, to_json

INFINITE = b"1e999"
"""Infinity as `exact_json_of` writes it."""

_TOKEN = re.compile(rb'"[^"\\]*(?:\\.[^"\\]*)*"|Infinity|NaN')
_REPLACEMENTS = {b"Infinity": INFINITE, b"NaN": b"null"}

json_of: Callable[[object], bytes] = partial(to_json, inf_nan_mode="null", bytes_mode="base64")
"""Return a value as JSON text: NaN and infinity as null, bytes as base64."""


def exact_json_of(value: object, has_floats: bool = True) -> bytes:
    """Return a value as JSON text in which infinity is a number.

    Args:
        value: the value.
        has_floats: whether there may be floats in it; if not, the text is not searched for them.
    """
    if not has_floats:
        return json_of(value)
    text = to_json(value, inf_nan_mode="constants", bytes_mode="base64")
    if b"Infinity" not in text and b"NaN" not in text:
        return text
    return _TOKEN.sub(_replacement, text)


def plain_json(text: bytes) -> bytes:
    """Return the text of `exact_json_of` with null in place of infinity."""
    return json_of(from_json(text)) if INFINITE in text else text


def _replacement(token: re.Match[bytes]) -> bytes:
    return _REPLACEMENTS.get(token[0], token[0])
