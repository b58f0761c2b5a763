"""rosbags as a second opinion: it serializes ROS 1 messages by an implementation of its own."""

from __future__ import annotations

from base64 import b64decode
from typing import Any

import numpy
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from fibws.interfaces import Interfaces
from fibws.interfaces.builtin import CONSTANTS, STRINGS, TIMES
from fibws.interfaces.definition import Field


class Oracle:
    """Serializes messages of the types that ``interfaces`` knows."""

    def __init__(self, interfaces: Interfaces) -> None:
        self._interfaces = interfaces
        self._store = get_typestore(Stores.ROS1_NOETIC)

    def serialize(self, type_: str, message: dict[str, Any]) -> bytes:
        """The bytes of a message that has no None in it."""
        name = _long(type_)
        if name not in self._store.fielddefs:
            text = self._interfaces.full_text(type_)
            self._store.register(get_types_from_msg(text, name))
        return bytes(self._store.serialize_ros1(self._object(type_, message), name))

    def _object(self, type_: str, message: dict[str, Any]) -> Any:
        fields = self._interfaces.message(type_).fields
        values = [self._value(field, message[field.name]) for field in fields]
        return self._store.types[_long(type_)](*values)

    def _value(self, field: Field, value: Any) -> Any:
        if field.is_bytes:
            return numpy.frombuffer(b64decode(value), numpy.uint8)
        if field.array is None:
            return self._element(field.type, value)
        elements = [self._element(field.type, element) for element in value]
        if field.type in CONSTANTS - STRINGS:
            return numpy.array(elements, "int8" if field.type == "byte" else field.type)
        return elements

    def _element(self, type_: str, value: Any) -> Any:
        if type_ in TIMES:
            # It knows ROS 2's times alone: the same bytes, but other integers.
            secs = (value["secs"] + 2**31) % 2**32 - 2**31
            time = self._store.types[f"builtin_interfaces/msg/{type_.capitalize()}"]
            return time(secs, value["nsecs"] % 2**32)
        return value if type_ in CONSTANTS else self._object(type_, value)


def _long(type_: str) -> str:
    return type_.replace("/", "/msg/")
