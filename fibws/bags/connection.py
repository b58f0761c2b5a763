"""The parts of a bag in any format: connections, and chunks of messages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

ANY_TYPE = "*"
"""The type that some recorders wrote before they knew the real one."""


@dataclass(frozen=True, slots=True)
class Connection:
    """One publisher of a topic, as a recording has it."""

    id: int
    topic: str
    type: str
    """The type's name: ``package/Type``."""
    md5sum: str
    definition: str
    """The full text of the type, with the types nested in it."""
    callerid: str = ""
    """The publisher's name; empty if the recording lacks it."""
    latching: bool = False
    fields: Mapping[str, bytes] = field(default_factory=dict, compare=False, repr=False)
    """The whole connection header, with the fields that have no attribute here."""
    encoding: str = "ros1"
    """How messages are serialized: always ``ros1`` in a .bag, maybe ``cdr`` in a .mcap."""
    definition_format: str = "ros1msg"
    """The language of the definition: maybe ``ros2msg`` in a .mcap."""


@dataclass(slots=True)
class ChunkInfo:
    """A chunk of a bag, which is compressed as a whole."""

    position: int
    """Where its record begins in the file."""
    start: int
    """The time of its first message in ns."""
    end: int
    """The time of its last message in ns."""
    counts: dict[int, int]
    """How many messages each connection has in it; 0 if the file does not say how many."""
    compression: str = "none"
    compressed_size: int = 0
    size: int = 0
    """The size of its uncompressed data."""


def with_known_types(connections: Iterable[Connection]) -> list[Connection]:
    """Return connections, in their order, where `ANY_TYPE` is replaced if the type is known.

    It is known if all other connections of the topic have one type.
    """
    found = list(connections)
    if all(each.type != ANY_TYPE for each in found):
        return found
    known: dict[str, Connection | None] = {}
    for each in found:
        if each.type != ANY_TYPE:
            other = known.setdefault(each.topic, each)
            if other is None or (other.type, other.md5sum) != (each.type, each.md5sum):
                known[each.topic] = None
    return [
        each
        if each.type != ANY_TYPE or (other := known.get(each.topic)) is None
        else _with_type_of(each, other)
        for each in found
    ]


def _with_type_of(connection: Connection, other: Connection) -> Connection:
    names = ("type", "md5sum", "message_definition")
    fields = {name: other.fields[name] for name in names if name in other.fields}
    return replace(
        connection,
        type=other.type,
        md5sum=other.md5sum,
        definition=other.definition,
        fields={**connection.fields, **fields},
        encoding=other.encoding,
        definition_format=other.definition_format,
    )


class Restored(NamedTuple):
    """The damage that was found in a bag."""

    messages: int
    lost: int
    """How many bytes of the file could not be read, because they are damaged or cut off."""
    damaged: int = 0
    """How many chunks have a wrong checksum: messages in them may be wrong."""
