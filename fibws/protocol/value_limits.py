"""Bounds for the values of one operation, which are counted before it is decoded.

A value takes two bytes of JSON, or one of CBOR, and up to a hundred times that once it is decoded.
Counted are the values that cost: numbers and strings little, arrays and objects much, and members
of objects most, since their names may all be different.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NoReturn

from fibws.errors import OperationError

MOST_VALUES: Final = 2**21
"""Most values in one operation: 2,097,152, enough for a map of 1448 by 1448 cells."""
MOST_CONTAINERS: Final = 2**18
"""Most arrays and objects among them."""
MOST_MEMBERS: Final = 2**19
"""Most members that the objects may have together."""

FEWEST_BYTES: Final = 3 * MOST_CONTAINERS
"""Shorter texts cannot exceed a bound: each array or object takes three bytes, as in ``[],``."""

_SLICE: Final = 2**16
"""Bytes that are looked at together: they fit the processor's cache."""


def check_json(text: bytes | bytearray) -> None:
    """Refuse a JSON text with too many values.

    Most texts are long because of long strings, or not long enough: a look at their separators is
    sufficient. Only if those are too many, the ones within strings are subtracted.

    Raises:
        OperationError: there are too many values.
    """
    if len(text) > FEWEST_BYTES and _too_many(_Counts.of(text)):
        counts = _Counts.outside_strings(text)
        if _too_many(counts):
            _refuse(counts)


class _Counts:
    """The values of a JSON text that are counted so far."""

    def __init__(self) -> None:
        self.values = 0
        self.containers = 0
        self.members = 0

    @classmethod
    def of(cls, text: bytes | bytearray) -> _Counts:
        """Count the values of a text, also those within strings; stop if there are too many."""
        counts = cls()
        for start in range(0, len(text), _SLICE):
            counts._add(text, start, start + _SLICE)
            if _too_many(counts):
                break
        return counts

    @classmethod
    def outside_strings(cls, text: bytes | bytearray) -> _Counts:
        """Count the values of a text; stop if there are too many."""
        counts = cls()
        strings = 0
        for piece in _outside_strings(text):
            counts._add(piece, 0, len(piece))
            # Valid JSON has a separator for each string; other text is refused here, too.
            strings += piece.count(b'"')
            counts.values = max(counts.values, strings - counts.members)
            if _too_many(counts):
                break
        return counts

    def _add(self, text: bytes | bytearray, start: int, end: int) -> None:
        # To find nothing is several times faster than to count nothing.
        if text.find(b",", start, end) >= 0:
            self.values += text.count(b",", start, end)
        for bracket in (b"[", b"{"):
            if text.find(bracket, start, end) >= 0:
                count = text.count(bracket, start, end)
                self.values += count
                self.containers += count
        if text.find(b":", start, end) >= 0:
            self.members += text.count(b":", start, end)


def _outside_strings(text: bytes | bytearray) -> Iterator[bytes]:
    """Yield a JSON text in pieces, with one quotation mark in place of each string."""
    inside = False
    start = 0
    while start < len(text):
        piece = bytes(text[start : start + _SLICE])
        if (len(piece) - len(piece.rstrip(b"\\"))) % 2:  # It ends within an escape sequence.
            piece = bytes(text[start : start + _SLICE + 1])
        start += len(piece)
        if b"\\" in piece:
            piece = piece.replace(rb"\\", b"").replace(rb"\"", b"")
        parts = piece.split(b'"')
        yield b'"'.join(parts[inside::2])
        inside ^= len(parts) % 2 == 0


def _too_many(counts: _Counts) -> bool:
    return (
        counts.values > MOST_VALUES
        or counts.containers > MOST_CONTAINERS
        or counts.members > MOST_MEMBERS
    )


# CBOR (RFC 8949, section 3)


def check_cbor(data: bytes) -> None:
    """Refuse CBOR with too many values; the elements of typed arrays count, except bytes.

    This reads only the heads of values: the elements of arrays and maps follow as values of their
    own. Bytes that are not CBOR are left to the decoder.

    Raises:
        OperationError: there are too many values.
    """
    if len(data) <= _FEWEST_CBOR:
        # Each member takes two bytes: only arrays and maps may be too many.
        others = data.translate(None, _CONTAINER_HEADS)
        if len(data) - len(others) <= MOST_CONTAINERS:
            return
    counts = _CborCounts()
    try:
        counts.add(data)
    except IndexError:
        pass  # the end
    if _too_many(counts):
        _refuse(counts)


_FEWEST_CBOR: Final = 2 * MOST_MEMBERS
"""Shorter CBOR can exceed no bound except that of arrays and maps."""
_CONTAINER_HEADS: Final = bytes(range(0x80, 0xC0))
"""The first bytes of arrays and maps."""

_UINT8_ARRAYS: Final = (64, 68)

_BYTES, _TEXT, _ARRAY, _MAP, _TAG = 2, 3, 4, 5, 6
"""The major types that `_CborCounts` distinguishes, from integers (0 and 1) and the rest (7)."""


def _steps() -> Iterator[int]:
    for head in range(256):
        kind, argument = head >> 5, head & 31
        if kind == _TAG or (kind in (_BYTES, _TEXT, _ARRAY, _MAP) and argument >= 24):
            yield 0
        elif kind in (_BYTES, _TEXT):
            yield 1 + argument
        else:
            yield 1 + (1 << (argument - 24) if 24 <= argument <= 27 else 0)


_STEPS: Final = tuple(_steps())
"""For each first byte of a value, how many bytes on the next value begins; 0 if that depends."""

_MEMBERS, _CONTAINERS = 80, 40
"""The shifts at which `_WEIGHTS` has the numbers of members, and of arrays and maps."""
_WEIGHTS: Final = tuple(
    1
    + ((1 << _CONTAINERS) if head >> 5 in (_ARRAY, _MAP) else 0)
    + (((head & 31) << _MEMBERS) if head >> 5 == _MAP and head & 31 < 24 else 0)
    for head in range(256)
)
"""For each first byte of a value, its counts of values, containers and members in one number."""


class _CborCounts(_Counts):
    """The values of CBOR that are counted so far."""

    def add(self, data: bytes) -> None:
        """Count the values of CBOR data; stop if there are too many.

        Raises:
            IndexError: the data ends, perhaps within a value.
        """
        steps, weights = _STEPS, _WEIGHTS
        position = total = 0
        indefinite = False
        try:
            while not _too_many(self):
                for _ in range(1000):
                    head = data[position]
                    total += weights[head]
                    if step := steps[head]:
                        position += step
                        continue
                    kind = head >> 5
                    argument, position = _argument(data, position)
                    if kind in (_BYTES, _TEXT):
                        position += argument
                    elif kind == _MAP:
                        indefinite = indefinite or head == 0xBF
                        total += argument << _MEMBERS
                    elif kind == _TAG and 64 <= argument < 88 and data[position] >> 5 == _BYTES:
                        length, position = _argument(data, position)
                        if argument not in _UINT8_ARRAYS:
                            # RFC 8746, section 2.1: the tag's bits are the size of an element.
                            total += length >> (argument >> 4 & 1) + (argument & 3)
                        position += length
                self._take(total, indefinite)
        finally:
            self._take(total, indefinite)

    def _take(self, total: int, indefinite: bool) -> None:
        mask = (1 << 40) - 1
        self.values = total & mask
        self.containers = total >> _CONTAINERS & mask
        self.members = total >> _MEMBERS
        if indefinite:  # A map of indefinite length does not say how many members it has.
            self.members += self.values // 2


def _argument(data: bytes, position: int) -> tuple[int, int]:
    """Return the argument of a value's head, and where the head ends."""
    argument = data[position] & 31
    position += 1
    if 24 <= argument <= 27:
        size = 1 << (argument - 24)
        return int.from_bytes(data[position : position + size], "big"), position + size
    # Above that it is of indefinite length, whose chunks follow as values; or it is invalid.
    return (argument if argument < 24 else 0), position


def _refuse(counts: _Counts) -> NoReturn:
    found = "values"
    limit = MOST_VALUES
    if counts.containers > MOST_CONTAINERS:
        found, limit = "arrays and objects", MOST_CONTAINERS
    elif counts.members > MOST_MEMBERS:
        found, limit = "members of objects", MOST_MEMBERS
    raise OperationError(
        f"too many {found} in one operation (limit is {limit}); send bytes as base64, long arrays "
        "of numbers as serialized messages (fibws.v1), or several messages"
    )
