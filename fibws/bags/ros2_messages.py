"""Messages of ROS 2, which are in CDR, as messages of ROS 1, and back.

A ROS 2 recording has the encoding ``cdr`` and definitions in ``ros2msg``. `with_encoding` returns a
reader for which ROS 1 might have recorded it; what cannot be converted stays as it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, TypeAlias

from fibws.bags.connection import Connection
from fibws.bags.reader import Reader
from fibws.bags.transformed_reader import TransformedReader
from fibws.errors import (
    BagError,
    BagFormatError,
    FibwsError,
    InterfaceError,
    InvalidMessage,
    Ros2Error,
    UnsupportedBag,
)

if TYPE_CHECKING:
    from fibws.interfaces.catalogue import Definitions

CDR = "cdr"
"""The encoding of ROS 2's messages."""
ROS1 = "ros1"

Convert: TypeAlias = Callable[[bytes], bytes | bytearray]
"""Returns a message in the other encoding; raises `InvalidMessage`."""

_QOS = "offered_qos_profiles"
"""The metadata of a channel that has the publisher's quality of service, as YAML."""
_TRANSIENT_LOCAL = re.compile(r"\bdurability:\s*(?:1|\"?transient_local\"?)\s*$", re.MULTILINE)
_NO_LIMIT = "{sec: 9223372036, nsec: 854775807}"
_LATCHED_QOS = (
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    f"  deadline: {_NO_LIMIT}\n  lifespan: {_NO_LIMIT}\n  liveliness: 1\n"
    f"  liveliness_lease_duration: {_NO_LIMIT}\n  avoid_ros_namespace_conventions: false\n"
)
"""That of a publisher whose last message later subscribers get."""


@dataclass(frozen=True, slots=True)
class Converted:
    """A connection in the other encoding.

    Attributes:
        connection: has the id of the original.
        convert: converts its messages.
        differences: how its types differ from those of the same names in ROS 1.
    """

    connection: Connection
    convert: Convert
    differences: Sequence[str] = ()


def as_ros1(connection: Connection) -> Converted:
    """Return a connection of ROS 2 as one of ROS 1.

    Raises:
        UnsupportedBag: it cannot be converted; the text says why.
        BagError: its definition is invalid.
    """
    from fibws.interfaces.cdr import Converters
    from fibws.interfaces.ros2_definitions import Ros2Definitions

    topic = connection.topic
    if connection.encoding != CDR:
        fault = f"messages of {topic} are in {connection.encoding}, which is not read"
        raise UnsupportedBag(fault, "format")
    if not connection.definition_format:
        connection = _with_known_definition(connection)
    if connection.definition_format != "ros2msg":
        format_ = connection.definition_format or "no definition"
        raise UnsupportedBag(
            f"messages of {topic} cannot be read: expected a definition in ros2msg, got {format_}",
            "format",
        )
    try:
        definitions = Ros2Definitions(connection.type, connection.definition, _known())
        type_ = definitions.message(connection.type).type
        converter = Converters(definitions.message).of(type_)
        text, md5sum = definitions.full_text(type_), definitions.md5(type_)
        differences = tuple(definitions.other_fields(type_))
    except Ros2Error as error:
        fault = f"messages of {topic} cannot be converted: {error}"
        raise UnsupportedBag(fault, "format") from None
    except InterfaceError as error:
        fault = f"invalid definition of {connection.type} in the bag: {error}"
        raise BagError(f"messages of {topic} cannot be read: {fault}") from None
    qos = connection.fields.get(_QOS, b"").decode("utf-8", "replace")
    fields = {name: value for name, value in connection.fields.items() if name != _QOS}
    latching = connection.latching or _TRANSIENT_LOCAL.search(qos) is not None
    if latching:
        fields["latching"] = b"1"
    fields |= {
        "topic": topic.encode(),
        "type": type_.encode(),
        "md5sum": md5sum.encode(),
        "message_definition": text.encode(),
    }
    ros1 = replace(
        connection,
        type=type_,
        md5sum=md5sum,
        definition=text,
        latching=latching,
        fields=fields,
        encoding=ROS1,
        definition_format="ros1msg",
    )
    return Converted(ros1, converter.from_cdr, differences)


def as_ros2(connection: Connection) -> Converted:
    """Return a connection of ROS 1 as one of ROS 2.

    Raises:
        BagError: it cannot be converted; the text says why.
    """
    from fibws.interfaces.catalogue import TextDefinitions
    from fibws.interfaces.cdr import Converters
    from fibws.interfaces.ros2_definitions import write_ros2_message
    from fibws.interfaces.serialization import Serializers

    topic = connection.topic
    if connection.encoding != ROS1:
        raise BagError(f"messages of {topic} are in {connection.encoding}, not in ros1")
    try:
        definitions = TextDefinitions(connection.type, connection.definition)
        type_ = definitions.message(connection.type).type
        converter = Converters(definitions.message).of(type_)
        check = Serializers(definitions).of(type_).check
        text = write_ros2_message(type_, definitions.message)
    except FibwsError as error:
        raise BagError(f"messages of {topic} cannot be converted to cdr: {error}") from None

    def convert(data: bytes) -> bytes:
        check(data)
        return converter.to_cdr(data)

    fields = {"message_definition": text.encode()}
    for name in ("callerid", "latching"):
        if name in connection.fields:
            fields[name] = connection.fields[name]
    fields[_QOS] = _LATCHED_QOS.encode() if connection.latching else b""
    package, _, short = type_.partition("/")
    ros2 = replace(
        connection,
        type=f"{package}/msg/{short}",
        md5sum="",
        definition=text,
        fields=fields,
        encoding=CDR,
        definition_format="ros2msg",
    )
    return Converted(ros2, convert)


def _check_first(reader: Reader, connection: Connection, convert: Convert) -> None:
    """Raise UnsupportedBag if the first message does not fit a definition that was assumed."""
    for _, _, data in reader.messages(connections=[connection]):
        try:
            convert(data)
        except InvalidMessage:
            raise UnsupportedBag(
                f"messages of {connection.topic} cannot be read: they have no definition, and do "
                f"not fit that of {connection.type} in ROS 1",
                "format",
            ) from None
        return


def _with_known_definition(connection: Connection) -> Connection:
    """Return a connection without a definition with that of ROS 1, if ROS 1 has such a type.

    Releases before Iron have recorded none in .db3 files.
    """
    from fibws.interfaces.ros2_definitions import write_ros2_message

    try:
        type_ = connection.type.replace("/msg/", "/")
        text = write_ros2_message(type_, _known().message)
    except FibwsError:
        return connection
    return replace(connection, definition=text, definition_format="ros2msg")


@cache
def _known() -> Definitions:
    """Return the standard types of ROS 1."""
    from fibws.interfaces import Interfaces

    return Interfaces()


class ConvertedReader(TransformedReader):
    """Reads a bag with the messages of some connections in another encoding.

    Args:
        reader: the bag's; it is closed with this one.
        encoding: the one that all messages are to have: ``ros1`` or ``cdr``.

    Attributes:
        not_converted: why a connection is as it was, by its id.
        differences: how types differ from those of the same names in ROS 1, each once.
    """

    def __init__(self, reader: Reader, encoding: str) -> None:
        super().__init__(reader)
        convert = as_ros1 if encoding == ROS1 else as_ros2
        self.not_converted = {}
        self._converts: dict[int, Convert] = {}
        self.connections = []
        differences = set[str]()
        for connection in reader.connections:
            own = connection
            if connection.encoding != encoding:
                try:
                    found = convert(connection)
                    if not connection.definition_format:
                        _check_first(reader, connection, found.convert)
                except BagError as error:
                    self.not_converted[connection.id] = str(error)
                else:
                    own = found.connection
                    self._converts[connection.id] = found.convert
                    differences.update(found.differences)
            self.connections.append(own)
        self.differences = sorted(differences)

    def _transform(self, connection: Connection, data: bytes) -> bytes:
        convert = self._converts.get(connection.id)
        if convert is None:
            return data
        try:
            return bytes(convert(data))
        except InvalidMessage as error:
            fault = f"invalid message on {connection.topic}: {error}"
            raise BagFormatError(f"{self.path}: {fault}") from None


def with_encoding(reader: Reader, encoding: str) -> Reader:
    """Return a reader of the same bag whose messages are converted, where they can be.

    Args:
        encoding: ``ros1`` or ``cdr``.
    """
    if all(each.encoding == encoding for each in reader.connections):
        return reader
    return ConvertedReader(reader, encoding)
