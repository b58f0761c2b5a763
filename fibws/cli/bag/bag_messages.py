"""Bags that commands read, and their messages, decoded by the definitions that bags carry."""

from __future__ import annotations

import os
from functools import cached_property
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import click

from fibws.bags import Connection, Reader, open_reader
from fibws.bags.ros2_messages import ROS1, Convert, as_ros1
from fibws.cli.output import visible
from fibws.command_names import command_name
from fibws.errors import BagError, BagNotIndexed, InterfaceError, InvalidMessage
from fibws.values.typedefs import Typedefs

if TYPE_CHECKING:
    from fibws.interfaces import MessageDefinition
    from fibws.interfaces.catalogue import TextDefinitions
    from fibws.interfaces.serialization import Serializer


def open_bag(path: str | PathLike[str]) -> Reader:
    """Open a bag for reading, and print what users should know of it.

    Raises:
        click.ClickException: the file does not exist, or it cannot be read.
        BagError: as `open_reader`.
    """
    try:
        reader = open_reader(path)
    except OSError as error:
        path = fspath(path)
        place = fspath(error.filename or path)
        fault = f"{place}: {error.strerror or error}"
        if place == path and os.path.exists(active := f"{path}.active"):
            fault = _active_fault(path, active)
        raise click.ClickException(visible(fault)) from None
    for each in reader.notices:
        warn(each)
    return reader


def warn(text: str) -> None:
    """Print a warning."""
    click.echo(visible(f"Warning: {text}"), err=True)


def _active_fault(path: str, active: str) -> str:
    """Say why a bag has only the name that it has while it is written."""
    try:
        open_reader(active).close()
    except BagNotIndexed as error:
        if error.writer:
            return f"{path} is not complete: {active} is {error.writer}"
    except (BagError, OSError):
        pass
    else:
        return f"{path}: No such file or directory, but {active} is complete"
    return (
        f"{path} was not closed by its recorder; restore it with {command_name('bag reindex')} "
        f"{active}"
    )


def check_new_name(name: str | PathLike[str]) -> None:
    """Raise a UsageError for the name of a new bag that is one of a format that is not written."""
    name = fspath(name)
    expected = "expected a name that ends in .bag or .mcap"
    if name.endswith(".db3"):
        raise click.UsageError(f"{name}: SQLite (.db3) is not written; {expected}")
    if name.endswith(".csv"):
        advice = f"{command_name('topic echo')} -b BAG -p TOPIC > {name}"
        raise click.UsageError(f"{name}: CSV is not written; {expected}, or: {advice}")


class BagType:
    """The type of a connection, for which its definition is needed only if a message is.

    Messages of ROS 2 are converted; what raises BagError does so if they cannot be, too.
    """

    def __init__(self, connection: Connection) -> None:
        self._original = connection
        self._with_bytes: dict[str, bool] = {}

    @cached_property
    def _form(self) -> tuple[Connection, Convert | None]:
        """The connection as one of ROS 1, and what converts its messages; None for ROS 1's."""
        if self._original.encoding == ROS1:
            return self._original, None
        found = as_ros1(self._original)
        return found.connection, found.convert

    @property
    def _connection(self) -> Connection:
        return self._form[0]

    @property
    def name(self) -> str:
        """The type's name, ``package/Type``; it raises as `definitions` does."""
        return self._connection.type

    @property
    def md5sum(self) -> str:
        """The type's md5sum in ROS 1; it raises as `definitions` does."""
        return self._connection.md5sum

    @cached_property
    def definitions(self) -> TextDefinitions:
        """The definitions of the type, and of those in it; it raises BagError for invalid ones."""
        from fibws.interfaces.catalogue import TextDefinitions

        connection = self._connection
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
            self.serializer.check(self._converted(data))
        except InvalidMessage as error:
            raise self._invalid(error) from None

    @cached_property
    def typedefs(self) -> Typedefs:
        """The type's fields, and those of the types in it; it raises as `definitions` does."""
        return Typedefs.of_definitions(self.definitions, self._connection.type)

    def values(self, data: bytes) -> dict[str, Any]:
        """Return the fields of a message as in JSON; raise as `check` does."""
        try:
            return self.serializer.deserialize(self._converted(data), "replace")
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

    def _converted(self, data: bytes) -> bytes:
        convert = self._form[1]
        return data if convert is None else bytes(convert(data))

    def _invalid(self, error: InvalidMessage) -> BagError:
        return BagError(f"invalid message on {self._original.topic}: {error}")


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
