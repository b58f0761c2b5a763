"""The parts of a bag in any format: connections, and chunks of messages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


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
