"""Bytes as base64 (RFC 4648, section 4), as JSON has them: images have millions.

pydantic_core decodes several times faster than binascii, but takes more than the RFC allows: what
it makes of a text counts only where nothing but the RFC's own spelling can have that length.
"""

from __future__ import annotations

from binascii import Error, a2b_base64, b2a_base64

from pydantic_core import SchemaValidator, core_schema

_decode = SchemaValidator(
    core_schema.bytes_schema(), core_schema.CoreConfig(val_json_bytes="base64")
).validate_json


def encode(data: bytes) -> str:
    """The text that stands for the bytes."""
    return b2a_base64(data, newline=False).decode()


def decode(text: str) -> bytes:
    """The bytes that a text stands for which `encode` could have written."""
    data: bytes = _decode(b'"%b"' % text.encode())
    return data


def read(text: str) -> tuple[bytes, str]:
    """The bytes of any text, and the text as `encode` would have it: spare bits are zero.

    Raises:
        ValueError: the text is not base64.
    """
    if len(text) % 4:
        raise ValueError("its length is not a multiple of four")
    if "-" not in text and "_" not in text:
        try:
            data = decode(text)
        except ValueError:
            pass
        else:
            if len(data) == len(text) // 4 * 3 - text[-2:].count("="):
                return data, text
    try:
        data = a2b_base64(text, strict_mode=True)
    except Error as error:
        raise ValueError(str(error)) from None
    # Four letters make three bytes; to encode all the others again would take an image's time.
    last = encode(data[len(text) // 4 * 3 - 3 :])
    return data, text if text.endswith(last) else text[:-4] + last
