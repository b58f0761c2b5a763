"""Bags to play, and what nodes received of them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from fibws.bags import open_reader, open_writer
from fibws.interfaces import Interfaces

SECOND = 10**9
START = 1_700_000_000 * SECOND
INTERFACES = Interfaces()


class Entry(NamedTuple):
    """A message of a bag with the connection that it came by."""

    topic: str
    type: str
    md5sum: str
    callerid: str
    latching: bool
    data: bytes


def int32(topic: str, value: int, callerid: str = "/talker", *, latching: bool = False) -> Entry:
    """Return a message of std_msgs/Int32."""
    return entry(topic, "std_msgs/Int32", value.to_bytes(4, "little"), callerid, latching)


def entry(topic: str, type_: str, data: bytes, callerid: str, latching: bool = False) -> Entry:
    """Return a message of a standard type."""
    return Entry(topic, type_, INTERFACES.md5(type_), callerid, latching, data)


def write(path: Path, *messages: tuple[float, Entry], compression: str = "none") -> Path:
    """Write a bag of messages, each with its time in seconds from `START`."""
    connections = {}
    with open_writer(path, compression) as bag:
        for seconds, (topic, type_, md5sum, callerid, latching, data) in messages:
            key = (topic, callerid)
            if key not in connections:
                connections[key] = bag.connection(
                    topic,
                    type_,
                    md5sum,
                    INTERFACES.full_text(type_),
                    callerid=callerid,
                    latching=latching,
                )
            bag.write(connections[key], START + round(seconds * SECOND), data)
    return path


def entries(path: Path, *topics: str) -> list[Entry]:
    """Return the messages of a bag in their order, without their times."""
    with open_reader(path) as bag:
        return [
            Entry(each.topic, each.type, each.md5sum, each.callerid, each.latching, data)
            for each, _, data in bag.messages(topics or None)
        ]
