"""Messages as CBOR: bytes are byte strings, arrays of numbers are RFC 8746 typed arrays.

That is how rosbridge's ``cbor`` compression has them (rosbridge_library's ``cbor_conversion.py``),
except that arrays of a fixed size, which it fails at, are like any others here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import nan
from struct import error as StructError
from struct import pack
from typing import Any, Final, TypeAlias

import cbor2

from fibws.interfaces import base64text, builtin
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.definition import Field, MessageDefinition

_Convert: TypeAlias = Callable[[Any], Any]
"""Returns a replacement for a value that cbor2 encodes instead; it does not change the value."""

TYPED_ARRAYS: Final = {
    "uint16": (69, "H"),
    "uint32": (70, "I"),
    "uint64": (71, "Q"),
    "int8": (72, "b"),
    "byte": (72, "b"),
    "int16": (77, "h"),
    "int32": (78, "i"),
    "int64": (79, "q"),
    "float32": (85, "f"),
    "float64": (86, "d"),
}
"""The tags of little-endian arrays (RFC 8746, section 2.1) and `struct`'s letters for elements."""


class CborEncoders:
    """The encoders of all types, each made on first use."""

    def __init__(self, interfaces: Definitions) -> None:
        self._interfaces = interfaces
        self._by_name: dict[str, CborEncoder] = {}
        self._converters: dict[str, _Convert | None] = {}

    def of(self, name: str) -> CborEncoder:
        """The encoder of a message type; raises as `Definitions.message` does."""
        if name not in self._by_name:
            definition = self._interfaces.message(name)
            self._by_name[name] = CborEncoder(definition.type, self._nested(definition.type))
        return self._by_name[name]

    def _nested(self, type_: str) -> _Convert | None:
        if type_ not in self._converters:
            self._converters[type_] = self._message(self._interfaces.message(type_))
        return self._converters[type_]

    def _message(self, definition: MessageDefinition) -> _Convert | None:
        """How messages are converted, if they need to be."""
        converters = {field.name: self._field(field) for field in definition.fields}
        needed = {name: convert for name, convert in converters.items() if convert is not None}
        if not needed:
            return None
        if all(convert is _float for convert in needed.values()):
            return _fill_floats
        return partial(convert_members, tuple(needed.items()))

    def _field(self, field: Field) -> _Convert | None:
        if field.is_bytes:
            return base64text.decode
        if field.array is not None and field.type in TYPED_ARRAYS:
            return partial(_typed_array, *TYPED_ARRAYS[field.type])
        if field.type in builtin.FLOATS:
            return _float
        convert = self._nested(field.type) if field.is_nested else None
        if field.array is not None and convert is not None:
            return partial(convert_all, convert)
        return convert


class CborEncoder:
    """Encodes the messages of one type."""

    __slots__ = ("_convert", "type")

    def __init__(self, type_: str, convert: _Convert | None) -> None:
        self.type = type_
        self._convert = convert

    def encode(self, message: dict[str, Any]) -> bytes:
        """A message as CBOR; it is one that `MessageValidator.validate` gave."""
        return cbor2.dumps(message if self._convert is None else self._convert(message))


def convert_members(
    members: tuple[tuple[str, _Convert], ...], message: dict[str, Any]
) -> dict[str, Any]:
    """A copy of a message with some of its members converted."""
    converted = dict(message)
    for name, convert in members:
        converted[name] = convert(converted[name])
    return converted


def convert_all(convert: _Convert, messages: list[Any]) -> list[Any]:
    """The elements of an array, each converted."""
    return [convert(message) for message in messages]


def _fill_floats(message: dict[str, Any]) -> dict[str, Any]:
    """The message without None, where nothing else needs conversion: mostly it is itself."""
    if None not in message.values():
        return message
    return {name: _float(value) for name, value in message.items()}


def _float(value: Any) -> Any:
    return nan if value is None else value


def _typed_array(tag: int, letter: str, values: list[Any]) -> cbor2.CBORTag:
    layout = f"<{len(values)}{letter}"
    try:
        return cbor2.CBORTag(tag, pack(layout, *values))
    except StructError:  # a None among them
        return cbor2.CBORTag(tag, pack(layout, *map(_float, values)))
