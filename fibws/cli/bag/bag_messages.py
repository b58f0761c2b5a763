"""Bags that commands read, and their messages, decoded by the definitions that bags carry."""

from __future__ import annotations

from functools import cached_property
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import click

from fibws.bags import Connection, Reader, open_reader
from fibws.cli.output import visible
from fibws.errors import BagError, InterfaceError, InvalidMessage
from fibws.values.typedefs import Typedefs

if TYPE_CHECKING:
    from fibws.interfaces import MessageDefinition
    from fibws.interfaces.catalogue import TextDefinitions
    from fibws.interfaces.serialization import Serializer


def open_bag(path: str | PathLike[str]) -> Reader:
    """Open a bag for reading; raise as `open_reader`, but ClickException if there is no file."""
    try:
        return open_reader(path)
    except OSError as error:
        raise click.ClickException(visible(f"{fspath(path)}: {error.strerror or error}")) from None


class BagType:
    """The type of a connection, for which its definition is needed only if a message is."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._with_bytes: dict[str, bool] = {}

    @cached_property
    def definitions(self) -> TextDefinitions:
        """The definitions of the type, and of those in it; it raises BagError for invalid ones."""
        from fibws.interfaces.catalogue import TextDefinitions

        connection = self._connection
        if connection.encoding != "ros1":
            fault = f"{connection.topic} is encoded as {connection.encoding}, not as ros1"
            raise BagError(f"messages cannot be read: {fault}")
        try:
            definitions = TextDefinitions(connection.type, connection.definition)
            definitions.message(connection.type)
        except InterfaceError as error:
            fault = f"invalid definition of {connection.type} in the bag: {error}"
            raise BagError(f"messages of {connection.topic} cannot be read: {fault}") from None
        return definitions

    @cached_property
    def serializer(self) -> Serializer:
        """The type's serializer; it raises as `definitions` does."""
        from fibws.interfaces.serialization import Serializers

        return Serializers(self.definitions).of(self._connection.type)

    def check(self, data: bytes) -> None:
        """Raise BagError if a message does not fit its definition, or that is invalid."""
        try:
            self.serializer.check(data)
        except InvalidMessage as error:
            raise self._invalid(error) from None

    @cached_property
    def typedefs(self) -> Typedefs:
        """The type's fields, and those of the types in it; it raises as `definitions` does."""
        return Typedefs.of_definitions(self.definitions, self._connection.type)

    def values(self, data: bytes) -> dict[str, Any]:
        """Return the fields of a message as in JSON; raise as `check` does."""
        try:
            return self.serializer.deserialize(data, "replace")
        except InvalidMessage as error:
            raise self._invalid(error) from None

    def fields(self, data: bytes) -> dict[str, Any]:
        """Return the fields of a message, with bytes for arrays of bytes; raise as `check` does."""
        values = self.values(data)
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
                    self._decode_bytes(each, self.definitions.message(field.type))

    def _has_bytes(self, type_: str) -> bool:
        if type_ not in self._with_bytes:
            self._with_bytes[type_] = any(
                field.is_bytes or (field.is_nested and self._has_bytes(field.type))
                for field in self.definitions.message(type_).fields
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
