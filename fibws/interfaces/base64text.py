"""Bytes as base64 (RFC 4648, section 4), as JSON has them: images have millions.

pydantic_core decodes several times faster than binascii, but takes more than the RFC allows: its
result is used only if no spelling but the RFC's can have that length.
"""

from __future__ import annotations

from binascii import Error, a2b_base64, b2a_base64
from collections.abc import Iterator
from typing import Final

from pydantic_core import SchemaValidator, core_schema

_SLICE: Final = 2**16
"""Characters that are decoded together, a multiple of four: they fit the processor's cache, which
makes it several times faster, and intermediate values stay small."""

_decode = SchemaValidator(
    core_schema.bytes_schema(), core_schema.CoreConfig(val_json_bytes="base64")
).validate_json


def encode(data: bytes) -> str:
    """Return the base64 text of bytes."""
    return b2a_base64(data, newline=False).decode()


def decode(text: str) -> bytes:
    """Return the bytes of a text in the spelling of `encode`."""
    if len(text) <= _SLICE:
        return _decode_slice(text)
    return b"".join(map(_decode_slice, _slices(text)))


def canonical(text: str) -> tuple[str, int]:
    """Return a text in the spelling of `encode` (spare bits are zero), and the number of its bytes.

    Raises:
        ValueError: the text is not base64.
    """
    if len(text) % 4:
        raise ValueError("its length is not a multiple of four")
    if "-" not in text and "_" not in text:
        size = len(text) // 4 * 3 - text[-2:].count("=")
        try:
            if sum(map(len, map(_decode_slice, _slices(text)))) == size:
                return text, size
        except ValueError:
            pass
    try:
        data = a2b_base64(text, strict_mode=True)
    except Error as error:
        raise ValueError(str(error)) from None
    # Four letters make three bytes; to encode all the others again would take an image's time.
    last = encode(data[len(text) // 4 * 3 - 3 :])
    return (text if text.endswith(last) else text[:-4] + last), len(data)


def _slices(text: str) -> Iterator[str]:
    return (text[start : start + _SLICE] for start in range(0, len(text), _SLICE))


def _decode_slice(text: str) -> bytes:
    data: bytes = _decode(b'"%b"' % text.encode())
    return data
