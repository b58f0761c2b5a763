"""Messages in bags, decoded by the definitions that bags carry."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from fibws.bags import Connection
from fibws.errors import BagError, InterfaceError, InvalidMessage

if TYPE_CHECKING:
    from fibws.interfaces import MessageDefinition
    from fibws.interfaces.serialization import Serializer


class BagType:
    """The type of a connection, for which its definition is needed only if a message is."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._with_bytes: dict[str, bool] = {}

    @cached_property
    def serializer(self) -> Serializer:
        """The type's serializer; it raises BagError if its definition is invalid."""
        from fibws.interfaces.catalogue import TextDefinitions
        from fibws.interfaces.serialization import Serializers

        connection = self._connection
        if connection.encoding != "ros1":
            fault = f"{connection.topic} is encoded as {connection.encoding}, not as ros1"
            raise BagError(f"messages cannot be read: {fault}")
        try:
            self._definitions = TextDefinitions(connection.type, connection.definition)
            return Serializers(self._definitions).of(connection.type)
        except InterfaceError as error:
            fault = f"invalid definition of {connection.type} in the bag: {error}"
            raise BagError(f"messages of {connection.topic} cannot be read: {fault}") from None

    def check(self, data: bytes) -> None:
        """Raise BagError if a message does not fit its definition, or that is invalid."""
        try:
            self.serializer.check(data)
        except InvalidMessage as error:
            raise self._invalid(error) from None

    def fields(self, data: bytes) -> dict[str, Any]:
        """Return the fields of a message; raise as `check` does."""
        try:
            values = self.serializer.deserialize(data, "replace")
        except InvalidMessage as error:
            raise self._invalid(error) from None
        self._decode_bytes(values, self.serializer.definition)
        return values

    def _decode_bytes(self, values: dict[str, Any], definition: MessageDefinition) -> None:
        """Make bytes of the fields that are base64 in JSON."""
        from fibws.interfaces import base64text

        for field in definition.fields:
            value = values[field.name]
            if field.is_bytes:
                values[field.name] = base64text.decode(value)
            elif field.is_nested and self._has_bytes(field.type):
                for each in value if isinstance(value, list) else [value]:
                    self._decode_bytes(each, self._definitions.message(field.type))

    def _has_bytes(self, type_: str) -> bool:
        if type_ not in self._with_bytes:
            self._with_bytes[type_] = any(
                field.is_bytes or (field.is_nested and self._has_bytes(field.type))
                for field in self._definitions.message(type_).fields
            )
        return self._with_bytes[type_]

    def _invalid(self, error: InvalidMessage) -> BagError:
        return BagError(f"invalid message on {self._connection.topic}: {error}")


class BagMessage:
    """A message, which is decoded when an expression asks for a field."""

    def __init__(self, connection: Connection, time: int, data: bytes, type_: BagType) -> None:
        self.connection = connection
        self.time = time
        self._data = data
        self._type = type_

    @cached_property
    def fields(self) -> dict[str, Any]:
        """The message's fields; it raises as `BagType.fields` does."""
        return self._type.fields(self._data)
