"""TCPROS (http://wiki.ros.org/ROS/TCPROS): connection headers and frames, as bytes.

A connection begins with a header from each side: fields ``key=value``, each with its length before
it. Then messages follow, each with its length before it. All lengths are 32 bits, little-endian.
"""

from __future__ import annotations

from collections.abc import Mapping

from fibws.hub.errors import TcprosError

MOST_HEADER = 2**20
"""Bytes of a header: definitions with all their parts have been seen with 100,000."""
MOST_MESSAGE = 1_000_000_000
"""Bytes of a message; roscpp takes more for a broken connection, too."""
MOST_FIELDS = 1000
LENGTH = 4
"""Bytes of a length."""
ANY = "*"
"""The type and the md5sum of a subscriber that takes every message."""


def frame(size: int) -> bytes:
    """Return the length of a message, which stands before it."""
    return size.to_bytes(LENGTH, "little")


def encode_header(fields: Mapping[str, str]) -> bytes:
    """Return a connection header with its length before it."""
    parts = [f"{key}={value}".encode() for key, value in fields.items()]
    body = b"".join(frame(len(part)) + part for part in parts)
    return frame(len(body)) + body


def decode_header(data: bytes) -> dict[str, str]:
    """Return the fields of a connection header.

    Args:
        data: the header without its length.

    Raises:
        TcprosError: it is not a header.
    """
    fields: dict[str, str] = {}
    start = 0
    while start < len(data):
        if len(fields) == MOST_FIELDS:
            raise TcprosError(f"invalid connection header: more than {MOST_FIELDS} fields")
        begin = start + LENGTH
        start = begin + int.from_bytes(data[start:begin], "little")
        if start > len(data) or begin > len(data):
            raise TcprosError("invalid connection header: a field is longer than the header")
        key, equals, value = data[begin:start].partition(b"=")
        if not equals:
            raise TcprosError("invalid connection header: a field has no =")
        fields[key.decode(errors="replace")] = value.decode(errors="replace")
    return fields


def check_header_size(size: int) -> int:
    """Return the length of a header; raise `TcprosError` if it is too large to be one."""
    if size > MOST_HEADER:
        raise TcprosError(f"invalid connection header: {size} bytes, limit is {MOST_HEADER}")
    return size


def require(fields: Mapping[str, str], *keys: str) -> None:
    """Raise `TcprosError` unless a header has these fields."""
    missing = [key for key in keys if key not in fields]
    if missing:
        raise TcprosError(f"missing required '{missing[0]}' field")
