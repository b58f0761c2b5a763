"""The records of ROS 1 bags, format 2.0 (http://wiki.ros.org/Bags/Format/2.0).

A bag is a line with the version and a sequence of records. A record is a header, which is a list of
fields ``name=value``, and data; both have their length before them. Messages and the connections
that they came by are records inside the data of chunks, which may be compressed. An index with the
times and places of its messages follows each chunk. The end of the bag repeats all connections and
lists the chunks.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass, field
from typing import BinaryIO, NamedTuple

from fibws.bags.connection import ChunkInfo, Connection
from fibws.errors import BagFormatError

VERSION_LINE = b"#ROSBAG V2.0\n"
FILE_HEADER_SIZE = 4096
"""The size of the first record, padded, without its two lengths; rosbag writes it again in place
when a bag is complete, and when it appends to one."""

MESSAGE, FILE_HEADER, INDEX, CHUNK, CHUNK_INFO, CONNECTION = range(2, 8)
"""The kinds of records (their field ``op``)."""

MAX_TIME = 2**32 * 1_000_000_000
"""Times are below it, in ns: bags count seconds in 32 bits."""
MAX_HEADER = 2**20
"""Maximum size of a record's header; that of a connection, with its definition, is data."""

LENGTH = struct.Struct("<I")
INDEX_ENTRY = struct.Struct("<III")
"""The time (s, ns) of a message, and its place in the uncompressed chunk."""
COUNT = struct.Struct("<II")
"""A connection's id, and the number of its messages in a chunk."""
_TIME = struct.Struct("<II")
_NUMBERS = {1: struct.Struct("<B"), 4: LENGTH, 8: struct.Struct("<Q")}


class _Layout(NamedTuple):
    """A usual header of messages: two constant parts, between the id, the time and a length."""

    first: bytes
    second: bytes
    unpack_from: Callable[[bytes, int], tuple[bytes, int, bytes, int, int, int]]


def _layout(first: bytes, second: bytes) -> _Layout:
    return _Layout(first, second, struct.Struct(f"<{len(first)}sI{len(second)}sIII").unpack_from)


_LAYOUTS = (
    _layout(b"&\0\0\0\t\0\0\0conn=", b"\4\0\0\0op=\2\r\0\0\0time="),  # of C++, and of fibws
    _layout(b"&\0\0\0\4\0\0\0op=\2\t\0\0\0conn=", b"\r\0\0\0time="),  # of Python
)
MESSAGE_START, MESSAGE_MIDDLE = _LAYOUTS[0][:2]
MESSAGE_RECORD = struct.Struct(f"<{len(MESSAGE_START)}sI{len(MESSAGE_MIDDLE)}sIII")
"""A record of a message without its data: two constants; the id, time (s, ns) and data length."""


def pack_fields(fields: Mapping[str, bytes], order: Iterable[str] = ()) -> bytes:
    """Return a header: its length and its fields.

    Args:
        order: the names in the order of the header; by default the alphabetical one, as in C++.
    """
    texts = [name.encode() + b"=" + fields[name] for name in order or sorted(fields)]
    data = b"".join(LENGTH.pack(len(text)) + text for text in texts)
    return LENGTH.pack(len(data)) + data


def pack_record(op: int, fields: Mapping[str, bytes], data: bytes | bytearray) -> bytes:
    """Return a record."""
    header = pack_fields({"op": bytes([op]), **fields})
    return b"".join((header, LENGTH.pack(len(data)), data))


def pack_connection(connection: Connection) -> bytes:
    """Return the record of a connection, whose data is a header itself."""
    fields = {"conn": LENGTH.pack(connection.id), "topic": connection.topic.encode()}
    return pack_record(CONNECTION, fields, pack_fields(connection.fields)[4:])


def pack_index(id_: int, entries: bytes | bytearray, order: Iterable[str] = ()) -> bytes:
    """Return the index of a connection's messages in a chunk.

    Args:
        entries: packed by `INDEX_ENTRY`.
        order: that of the fields in the header, as for `pack_fields`.
    """
    fields = {
        "op": bytes([INDEX]),
        "ver": LENGTH.pack(1),
        "conn": LENGTH.pack(id_),
        "count": LENGTH.pack(len(entries) // INDEX_ENTRY.size),
    }
    return b"".join((pack_fields(fields, order), LENGTH.pack(len(entries)), entries))


def pack_chunk_info(info: ChunkInfo) -> bytes:
    """Return the record at the end of a bag that says what is in a chunk."""
    fields = {
        "ver": LENGTH.pack(1),
        "chunk_pos": info.position.to_bytes(8, "little"),
        "start_time": pack_time(info.start),
        "end_time": pack_time(info.end),
        "count": LENGTH.pack(len(info.counts)),
    }
    return pack_record(
        CHUNK_INFO, fields, b"".join(COUNT.pack(*each) for each in info.counts.items())
    )


def pack_time(time: int) -> bytes:
    """Return a time (ns) as the value of a field."""
    return _TIME.pack(*divmod(time, 1_000_000_000))


def unpack_fields(data: bytes, place: str) -> dict[str, bytes]:
    """Return the fields of a header.

    Args:
        data: the header without its length.
        place: what the header is of; it begins the text of errors.

    Raises:
        BagFormatError: a field is longer than the header, or has no ``=``.
    """
    fields = {}
    position, size = 0, len(data)
    while position < size:
        if position + 4 > size:
            raise BagFormatError(f"{place}: incomplete length of a header field")
        (length,) = LENGTH.unpack_from(data, position)
        position += 4
        if length > size - position:
            fault = f"field of {length} bytes in a header with {size - position} left"
            raise BagFormatError(f"{place}: {fault}")
        name, equals, value = data[position : position + length].partition(b"=")
        if not equals:
            raise BagFormatError(f"{place}: header field without '='")
        fields[name.decode("utf-8", "replace")] = value
        position += length
    return fields


def number(fields: Mapping[str, bytes], name: str, size: int, place: str) -> int:
    """Return an unsigned number of ``size`` bytes.

    Raises:
        BagFormatError: the field is missing, or of another size.
    """
    value = fields.get(name)
    if value is None or len(value) != size:
        raise BagFormatError(_fault(place, name, value, size))
    (found,) = _NUMBERS[size].unpack(value)
    return int(found)


def time(fields: Mapping[str, bytes], name: str, place: str) -> int:
    """Return a time in ns; raise as `number` does."""
    value = fields.get(name)
    if value is None or len(value) != _TIME.size:
        raise BagFormatError(_fault(place, name, value, _TIME.size))
    seconds, nanoseconds = _TIME.unpack(value)
    return int(seconds * 1_000_000_000 + nanoseconds)


def text(fields: Mapping[str, bytes], name: str, place: str) -> str:
    """Return a text; raise BagFormatError if it is missing.

    Bytes that are not UTF-8, which comments of old definitions have, become U+FFFD.
    """
    value = fields.get(name)
    if value is None:
        raise BagFormatError(_fault(place, name, value, 0))
    return value.decode("utf-8", "replace")


def _fault(place: str, name: str, value: bytes | None, size: int) -> str:
    if value is None:
        return f"{place}: missing header field {name!r}"
    return f"{place}: header field {name!r} has {len(value)} bytes, expected {size}"


@dataclass(slots=True)
class Record:
    """A record of a file: its header, and the place of its data."""

    position: int
    op: int
    fields: dict[str, bytes]
    data_position: int
    data_size: int

    @property
    def end(self) -> int:
        """The position of the next record."""
        return self.data_position + self.data_size

    def expect(self, op: int, place: str) -> None:
        """Raise BagFormatError if this is another kind of record."""
        if self.op != op:
            raise BagFormatError(f"{place}: expected a record of kind {op}, got kind {self.op}")


class RecordFile:
    """A bag's file, from which nothing is read beyond its end.

    Args:
        file: open for reading, in binary mode.
        path: names the file in errors.
    """

    def __init__(self, file: BinaryIO, path: str) -> None:
        self.file = file
        self.path = path
        self.size = file.seek(0, 2)

    def read(self, position: int, size: int) -> bytes:
        """Return ``size`` bytes at ``position``.

        Raises:
            BagFormatError: the file ends before.
        """
        if position + size > self.size:
            raise BagFormatError(
                f"{self.path}: {size} bytes expected at byte {position}, but the file ends at byte "
                f"{self.size}"
            )
        self.file.seek(position)
        data = self.file.read(size)
        if len(data) != size:
            raise BagFormatError(f"{self.path}: the file became shorter while it was read")
        return data

    def record(self, position: int) -> Record:
        """Return the record at ``position``; its data may be longer than the file.

        Raises:
            BagFormatError: its header is incomplete or invalid.
        """
        (size,) = LENGTH.unpack(self.read(position, 4))
        place = f"{self.path}: record at byte {position}"
        if size > MAX_HEADER:
            raise BagFormatError(f"{place}: header of {size} bytes (limit: {MAX_HEADER})")
        header = self.read(position + 4, size + 4)
        fields = unpack_fields(header[:-4], place)
        (data_size,) = LENGTH.unpack(header[-4:])
        op = number(fields, "op", 1, place)
        return Record(position, op, fields, position + size + 8, data_size)

    def data(self, record: Record) -> bytes:
        """Return the data of a record; raise BagFormatError if the file ends before."""
        return self.read(record.data_position, record.data_size)


def unpack_connection(fields: Mapping[str, bytes], data: bytes, place: str) -> Connection:
    """Return the connection of a record.

    Raises:
        BagFormatError: a field is missing or invalid.
    """
    own = unpack_fields(data, place)
    return Connection(
        id=number(fields, "conn", 4, place),
        topic=text(fields, "topic", place),
        type=text(own, "type", place),
        md5sum=text(own, "md5sum", place),
        definition=text(own, "message_definition", place),
        callerid=own.get("callerid", b"").decode("utf-8", "replace"),
        latching=own.get("latching") == b"1",
        fields=own,
    )


def unpack_chunk_info(record: Record, data: bytes) -> ChunkInfo:
    """Return what the index of a bag says of a chunk, which is not all of it.

    Raises:
        BagFormatError: a field is missing or invalid, or the version is unknown.
    """
    place = f"record at byte {record.position}"
    version = number(record.fields, "ver", 4, place)
    if version != 1:
        raise BagFormatError(f"{place}: unknown version {version} of a chunk's information")
    if len(data) % COUNT.size:
        raise BagFormatError(f"{place}: incomplete count of messages")
    return ChunkInfo(
        position=number(record.fields, "chunk_pos", 8, place),
        start=time(record.fields, "start_time", place),
        end=time(record.fields, "end_time", place),
        counts=dict(COUNT.iter_unpack(data)),
    )


@dataclass(slots=True)
class UnpackedChunk:
    """Where the messages of an uncompressed chunk are in its data.

    The arrays have one number for each message, in the order of the chunk.
    """

    data: bytes
    times: array[int] = field(default_factory=lambda: array("Q"))
    """In ns."""
    ids: array[int] = field(default_factory=lambda: array("Q"))
    """The connections."""
    places: array[int] = field(default_factory=lambda: array("Q"))
    """Where the records begin."""
    begins: array[int] = field(default_factory=lambda: array("Q"))
    ends: array[int] = field(default_factory=lambda: array("Q"))
    connections: dict[int, Connection] = field(default_factory=dict)
    """The connections whose records are in the chunk, by id."""
    size: int = 0
    """How many bytes are complete records."""


def unpack_chunk(
    data: bytes, place: str, wanted: Container[int] | None = None, *, partial: bool = False
) -> UnpackedChunk:
    """Find the messages of an uncompressed chunk.

    Args:
        place: names the chunk in errors.
        wanted: the ids of connections whose messages are needed; all if None.
        partial: end at the first record that is incomplete or invalid, instead of raising.

    Raises:
        BagFormatError: a record is incomplete or invalid.
    """
    found = UnpackedChunk(data)
    add_time, add_id, add_place = found.times.append, found.ids.append, found.places.append
    add_begin, add_end = found.begins.append, found.ends.append
    position, size = 0, len(data)
    layout = _LAYOUTS[0]
    first, second, unpack_from = layout
    try:
        while position < size:
            begin = position + MESSAGE_RECORD.size
            if begin <= size:
                start, id_, middle, seconds, nanoseconds, length = unpack_from(data, position)
                if start == first and middle == second:
                    end = begin + length
                    if end > size:
                        raise BagFormatError(f"{place}: message beyond the end of the chunk")
                    if wanted is None or id_ in wanted:
                        add_time(seconds * 1_000_000_000 + nanoseconds)
                        add_id(id_)
                        add_place(position)
                        add_begin(begin)
                        add_end(end)
                    position = end
                    continue
            position = _unpack_other(found, position, place, wanted)
            layout = _layout_after(data, position, layout)
            first, second, unpack_from = layout
    except BagFormatError:
        if not partial:
            raise
    found.size = position
    return found


def _layout_after(data: bytes, position: int, layout: _Layout) -> _Layout:
    """Return the layout of the record at ``position``, or else the given one."""
    for each in _LAYOUTS:
        if data.startswith(each.first, position):
            return each
    return layout


def _unpack_other(
    found: UnpackedChunk, position: int, place: str, wanted: Container[int] | None
) -> int:
    """Add a connection, or a message with an unusual header; return the end of its record."""
    data = found.data
    size = len(data)
    place = f"{place}, record at byte {position} of its data"
    if position + 4 > size:
        raise BagFormatError(f"{place}: incomplete")
    (length,) = LENGTH.unpack_from(data, position)
    begin = position + 4 + length + 4
    if begin > size:
        raise BagFormatError(f"{place}: incomplete header")
    fields = unpack_fields(data[position + 4 : begin - 4], place)
    end = begin + LENGTH.unpack_from(data, begin - 4)[0]
    if end > size:
        raise BagFormatError(f"{place}: incomplete data")
    op = number(fields, "op", 1, place)
    if op == CONNECTION:
        connection = unpack_connection(fields, data[begin:end], place)
        found.connections[connection.id] = connection
    elif op == MESSAGE:
        id_ = number(fields, "conn", 4, place)
        if wanted is None or id_ in wanted:
            found.times.append(time(fields, "time", place))
            found.ids.append(id_)
            found.places.append(position)
            found.begins.append(begin)
            found.ends.append(end)
    return int(end)
