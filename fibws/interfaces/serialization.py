"""ROS 1's serialization of messages, as bags hold it and rosbridge's ``cbor-raw`` sends it."""

from __future__ import annotations

from itertools import groupby
from typing import Any, Final

from fibws.errors import InvalidMessage
from fibws.interfaces import builtin
from fibws.interfaces.binary import (
    Blob,
    Fault,
    Mixed,
    Numbers,
    Packed,
    Part,
    Reader,
    Several,
    Text,
)
from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.interfaces.layout import Bytes, Fixed, Layout, Row, Scalar

_LETTERS: Final = {
    "bool": "?",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "byte": "b",
    "char": "B",
    "float32": "f",
    "float64": "d",
}
"""What `struct` calls the builtin types."""


class Serializers:
    """The serializers of all types, each built when first asked for."""

    def __init__(self, interfaces: Interfaces) -> None:
        self._interfaces = interfaces
        self._by_name: dict[str, Serializer] = {}
        self._parts: dict[str, Part] = {}
        self._layouts: dict[str, Layout | None] = {
            name: Layout([(part, Scalar(_LETTERS[type_])) for part in ("secs", "nsecs")])
            for name, type_ in builtin.TIMES.items()
        }

    def of(self, name: str) -> Serializer:
        """The serializer of a message type; it raises as `Interfaces.message` does."""
        if name not in self._by_name:
            self._by_name[name] = self.of_definition(self._interfaces.message(name))
        return self._by_name[name]

    def of_definition(self, definition: MessageDefinition) -> Serializer:
        """A new serializer of a message that has no name of its own, as a service's request."""
        return Serializer(definition.type, self._message(definition))

    def _message(self, definition: MessageDefinition) -> Part:
        fields = [(field, self._fixed(field)) for field in definition.fields]
        members: list[tuple[str, Part]] = []
        for packs, group in groupby(fields, lambda member: member[1] is not None):
            if packs:
                layout = Layout(
                    [(field.name, fixed) for field, fixed in group if fixed is not None]
                )
                members.append(("", Packed(layout)))
            else:
                members += [(field.name, self._part(field)) for field, _ in group]
        if not members:
            return Packed(Layout([]))
        name, part = members[0]
        return part if len(members) == 1 and not name else Mixed(members)

    def _fixed(self, field: Field) -> Fixed | None:
        """What packs the field, if it is of a fixed size."""
        if field.array is None:
            if field.type in _LETTERS:
                return Scalar(_LETTERS[field.type])
            return None if field.type in builtin.STRINGS else self._layout(field.type)
        if field.array.fixed is None or field.type not in _LETTERS:
            return None
        if field.is_bytes:
            return Bytes(field.array.fixed)
        return Row(_LETTERS[field.type], field.array.fixed)

    def _layout(self, type_: str) -> Layout | None:
        """What packs the messages of a type, or the times, if they are of a fixed size."""
        if type_ not in self._layouts:
            fields = self._interfaces.message(type_).fields
            fixed = [(field.name, self._fixed(field)) for field in fields]
            members = [(name, found) for name, found in fixed if found is not None]
            self._layouts[type_] = Layout(members) if len(members) == len(fields) else None
        return self._layouts[type_]

    def _part(self, field: Field) -> Part:
        """What writes a field that is not packed."""
        if field.is_bytes:
            return Blob()
        if field.array is None:
            return self._element(field.type)
        if field.type in _LETTERS:
            return Numbers(_LETTERS[field.type])
        return Several(self._element(field.type), field.array.fixed)

    def _element(self, type_: str) -> Part:
        """What writes one value of a type that is no number."""
        if type_ in builtin.STRINGS:
            return Text()
        if type_ not in self._parts:
            layout = self._layout(type_)
            if layout is None:
                self._parts[type_] = self._message(self._interfaces.message(type_))
            else:
                self._parts[type_] = Packed(layout)
        return self._parts[type_]


class Serializer:
    """Serializes the messages of one type."""

    __slots__ = ("_part", "type")

    def __init__(self, type_: str, part: Part) -> None:
        self.type = type_
        self._part = part

    def serialize(self, message: dict[str, Any]) -> bytes:
        """A message's bytes; it is one that `MessageValidator.validate` gave."""
        pieces: list[bytes] = []
        self._part.write(message, pieces)
        return b"".join(pieces)

    def deserialize(self, data: bytes) -> dict[str, Any]:
        """The message that the bytes are, as `MessageValidator.validate` gives it.

        Bounds are ROS 2's and are not looked at.

        Raises:
            InvalidMessage: they are none of the type; the text says where that shows.
        """
        reader = Reader(data)
        try:
            message: dict[str, Any] = self._part.read(reader)
        except Fault as fault:
            place = f"{fault.path}: " if fault.path else ""
            raise InvalidMessage(f"These bytes are no {self.type}: {place}{fault}") from None
        rest = len(data) - reader.offset
        if rest:
            raise InvalidMessage(f"These bytes are no {self.type}: {rest} of them are left over")
        return message
