"""CBOR (RFC 8949) to operations' fields: one map a frame, made of what JSON has and of bytes.

Arrays of numbers may come as RFC 8746's typed arrays. All other tags are refused: JSON has no place
for what they mean, and some take a few bytes to keep a decoder busy for minutes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from io import BytesIO
from struct import calcsize, unpack
from typing import Any, Final, NoReturn

import cbor2

from fibws.errors import OperationError

DEEPEST: Final = 200
"""How many arrays and maps may be in each other: as many as pydantic_core allows in JSON."""

MOST_ITEMS: Final = 2**20
"""How many values there may be: an empty array is one byte, and eighty once it is decoded."""

_BYTES: Final = 2
_TEXT: Final = 3
"""The major types of what is longer than its head."""

_TYPED_ARRAYS: Final = {
    **{64: "<B", 68: "<B", 69: "<H", 70: "<I", 71: "<Q", 72: "<b", 77: "<h", 78: "<i", 79: "<q"},
    **{65: ">H", 66: ">I", 67: ">Q", 73: ">h", 74: ">i", 75: ">q"},
    **{80: ">e", 81: ">f", 82: ">d", 84: "<e", 85: "<f", 86: "<d"},
}
"""The tags of RFC 8746, section 2.1, as `struct` spells their elements; it knows no float128."""

_KNOWN_TO_CBOR2: Final = (
    *(0, 1, 2, 3, 4, 5, 25, 28, 29, 30, 35, 36, 37, 52, 54, 100),
    *(256, 258, 260, 261, 1004, 43000, 55799),
)
"""The tags that cbor2 has a meaning for, unless told otherwise."""

_SELF_DESCRIBED: Final = b"\xd9\xd9\xf7"
"""The tag 55799, which a file of CBOR may begin with (RFC 8949, section 3.4.6)."""

_SCALARS: Final = {str, int, float, bool, bytes, type(None)}


def object_of_cbor(data: bytes) -> dict[str, Any]:
    """The map that ``data`` is, as JSON would have it: bytes stay, and undefined is None.

    Raises:
        OperationError: the data is no CBOR, or no map, or holds what has no place in JSON.
    """
    _check_items(data)
    source = BytesIO(data.removeprefix(_SELF_DESCRIBED))
    decoder = cbor2.CBORDecoder(
        source,
        tag_hook=_refuse_unknown,
        semantic_decoders=_DECODERS,
        max_depth=DEEPEST,
        strict_hashable_types=True,
    )
    try:
        value = decoder.decode()
    except cbor2.CBORError as error:
        raise OperationError(f"Expected a map in CBOR: {error.__cause__ or error}") from None
    if not isinstance(value, dict):
        raise OperationError(f"Expected a map in CBOR, but got a {type(value).__name__}")
    rest = len(source.getbuffer()) - source.tell()
    if rest:
        raise OperationError(f"Expected one map in CBOR, but {rest} bytes follow it")
    return _plain_map(value)


def _check_items(data: bytes) -> None:
    """Refuse what would take far more memory decoded than encoded.

    Only heads are read (RFC 8949, section 3): what is in arrays and maps follows theirs.
    """
    position, end = 0, len(data)
    for _ in range(MOST_ITEMS):
        if position >= end:
            return
        kind, argument = data[position] >> 5, data[position] & 31
        position += 1
        if 24 <= argument <= 27:
            size = 1 << (argument - 24)
            argument = int.from_bytes(data[position : position + size], "big")
            position += size
        elif argument > 27:
            argument = (
                0  # Indefinite: its parts follow as items. Or wrong, as the decoder will say.
            )
        if kind in (_BYTES, _TEXT):
            position += argument
    if position < end:
        raise OperationError(f"Expected a map in CBOR of at most {MOST_ITEMS} values")


def _plain_map(value: dict[Any, Any]) -> dict[str, Any]:
    for key, member in value.items():
        if type(key) is not str:
            kind = type(key).__name__
            raise OperationError(f"Expected text as the keys of maps in CBOR, but got {kind}")
        if type(member) not in _SCALARS:
            value[key] = _plain(member)
    return value


def _plain(value: Any) -> Any:
    if type(value) is dict:
        return _plain_map(value)
    if type(value) is list:
        # Most lists are of one type, which is seen faster than each element is looked at.
        if _SCALARS.issuperset(map(type, value)):
            return value
        return [member if type(member) in _SCALARS else _plain(member) for member in value]
    if value is cbor2.undefined:
        return None
    kind = type(value).__name__
    raise OperationError(f"Expected what JSON has, or bytes, in CBOR, but got {kind}")


def _typed_array(layout: str, data: object, immutable: bool) -> list[int] | list[float]:
    if not isinstance(data, bytes):
        raise ValueError("a typed array is made of bytes")
    count, rest = divmod(len(data), calcsize(layout))
    if rest:
        raise ValueError(f"the {len(data)} bytes of a typed array end within an element")
    return list(unpack(f"{layout[0]}{count}{layout[1]}", data))


def _refuse(tag: int, value: object, immutable: bool) -> NoReturn:
    raise ValueError(f"the tag {tag} is not understood, only those of typed arrays are")


def _refuse_unknown(tagged: cbor2.CBORTag, immutable: bool) -> NoReturn:
    _refuse(tagged.tag, tagged.value, immutable)


_DECODERS: dict[int, Callable[[Any, bool], Any]] = {
    **{tag: partial(_refuse, tag) for tag in _KNOWN_TO_CBOR2},
    **{tag: partial(_typed_array, layout) for tag, layout in _TYPED_ARRAYS.items()},
}
