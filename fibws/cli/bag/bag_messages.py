"""Messages in bags, decoded by the definitions that bags carry."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from fibws.bags import Connection
from fibws.errors import BagError, InterfaceError, InvalidMessage

if TYPE_CHECKING:
    from fibws.interfaces.serialization import Serializer


class BagType:
    """The type of a connection, for which its definition is needed only if a message is."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

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
            definitions = TextDefinitions(connection.type, connection.definition)
            return Serializers(definitions).of(connection.type)
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
            return self.serializer.deserialize(data, "replace")
        except InvalidMessage as error:
            raise self._invalid(error) from None

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
