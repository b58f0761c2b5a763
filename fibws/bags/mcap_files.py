"""Reading and writing of .mcap files (https://mcap.dev/spec), on the library mcap.

ROS 1's messages have the encoding ``ros1``, and their definitions ``ros1msg``. The metadata of a
channel has the rest of its connection header: ``md5sum``, ``callerid`` and ``latching``.
"""

from __future__ import annotations

import re
import struct
import zlib
from array import array
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from io import BufferedWriter, BytesIO
from itertools import chain
from types import TracebackType
from typing import TYPE_CHECKING, Any, BinaryIO, Self

from fibws.bags import compression
from fibws.bags.bag_format import RecordFile
from fibws.bags.connection import ANY_TYPE, ChunkInfo, Connection, Restored, with_known_types
from fibws.bags.reader import (
    ChunkMessages,
    Reader,
    advice,
    chunk_faults,
    entry_faults,
    in_file_order,
)
from fibws.errors import BagError, BagFormatError, BagNotIndexed, InterfaceError, UnsupportedBag
from fibws.files import open_to_write

if TYPE_CHECKING:
    from mcap.records import Channel, Schema

MAGIC = b"\x89MCAP0\r\n"
METHODS = ("none", "lz4", "zstd")
"""The compression methods of .mcap files."""
CHUNK_SIZE = 768 * 1024

_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK = range(1, 7)
_MESSAGE_INDEX = 7
_CHUNK_INDEX, _ATTACHMENT, _STATISTICS, _METADATA, _DATA_END = 8, 9, 11, 12, 15
_RECORD = struct.Struct("<BQ")
"""The kind of a record, and the length of its content."""
_MESSAGE_RECORD = struct.Struct("<BQHIQQ")
"""A message's record without its data: kind, length, channel, number, log and publish time."""
_MESSAGE_FIELDS = _MESSAGE_RECORD.size - _RECORD.size
_OTHERS = {_HEADER: "Header", _ATTACHMENT: "Attachment", _METADATA: "Metadata"}
_CHUNK_START = struct.Struct("<QQQII")
"""The head of a chunk: times, uncompressed size, checksum, length of the method's name."""
_CHUNK_LIKE = re.compile(rb"\x06(?=[\s\S]{36}(?:\x00{4}|\x03\x00{3}lz4|\x04\x00{3}zstd))")
"""The start of what may be a chunk: its kind, and the name of a compression method further on."""
_FOOTER_SIZE = _RECORD.size + 20 + len(MAGIC)
_RUN = 2**20
"""How many bytes of messages outside chunks are read at once."""


class McapWriter:
    """Writes serialized messages to a .mcap file; it has the methods of `BagWriter`.

    Args:
        path: the file; one that exists is replaced.
        compression: ``none``, ``lz4`` or ``zstd``.
        chunk_size: how many bytes, uncompressed, end a chunk.
        profile: what messages the file has: ``ros1``, ``ros2``, or empty for several kinds.
        name: names the file in errors, if it is written under another name.

    Raises:
        BagError: an invalid compression.
        UnsupportedBag: the package mcap is not installed.
        OSError: the file cannot be written; from `write`, `flush` and `close`, too.
    """

    def __init__(
        self,
        path: str,
        compression: str = "none",
        chunk_size: int = CHUNK_SIZE,
        *,
        profile: str = "ros1",
        name: str = "",
    ) -> None:
        name = name or path
        check_method(compression, name)
        from mcap.writer import CompressionType, Writer

        self.path = name
        self.compression = compression
        self.chunk_size = chunk_size
        self.connections: list[Connection] = []
        self.is_closed = False
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._file = BufferedWriter(open_to_write(path))
        self.mcap = Writer(
            self._file, chunk_size=chunk_size, compression=CompressionType[compression.upper()]
        )
        self.mcap.start(profile, "fibws")
        try:
            self._file.flush()  # An empty file would not be an MCAP file.
        except BaseException:
            self._file.raw.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def position(self) -> int:
        """Where the next chunk begins in the file."""
        return 0 if self.is_closed else self._file.tell()

    @property
    def size(self) -> int:
        """The size of the file in bytes, without the chunk that is in memory."""
        return self.position

    def connection(
        self,
        topic: str,
        type: str,
        md5sum: str,
        definition: str,
        *,
        callerid: str = "",
        latching: bool = False,
        fields: Mapping[str, bytes] | None = None,
        encoding: str = "ros1",
        definition_format: str = "ros1msg",
    ) -> Connection:
        """Add a connection, as `BagWriter.connection` does; the format has at most 65,535.

        Args:
            encoding: how messages are serialized.
            definition_format: the language of the definition.
        """
        if len(self.connections) == 65535:
            raise BagError(f"{self.path}: too many connections (limit of MCAP: 65,535)")
        own = dict(fields or {})
        text = own.pop("message_definition", definition.encode())
        if md5sum:
            own.setdefault("md5sum", md5sum.encode())
        if callerid:
            own.setdefault("callerid", callerid.encode())
        if callerid or latching:
            own.setdefault("latching", b"1" if latching else b"0")
        schema = (type, definition_format, text)
        if schema not in self._schemas:
            self._schemas[schema] = self.mcap.register_schema(*schema) if definition_format else 0
        metadata = {name: value.decode("utf-8", "replace") for name, value in own.items()}
        for name in ("topic", "type"):  # They have their own places.
            metadata.pop(name, None)
        connection = Connection(
            id=self.mcap.register_channel(topic, encoding, self._schemas[schema], metadata),
            topic=topic,
            type=type,
            md5sum=md5sum,
            definition=definition,
            callerid=callerid,
            latching=latching,
            fields={**own, "message_definition": text},
            encoding=encoding,
            definition_format=definition_format,
        )
        self.connections.append(connection)
        return connection

    def copy_connection(self, connection: Connection) -> Connection:
        """Add a connection of another bag, with all fields of its header."""
        return self.connection(
            connection.topic,
            connection.type,
            connection.md5sum,
            connection.definition,
            callerid=connection.callerid,
            latching=connection.latching,
            fields=connection.fields,
            encoding=connection.encoding,
            definition_format=connection.definition_format,
        )

    def write(
        self, connection: Connection, time: int, data: bytes | bytearray | memoryview
    ) -> None:
        """Add a message; it raises as `BagWriter.write` does."""
        if self.is_closed:
            raise BagError(f"{self.path}: the bag is closed")
        if not 0 <= time < 2**64:
            raise BagError(f"{self.path}: MCAP holds times from 1970 to 2554, got {time} ns")
        # Its types want bytes; it takes any buffer. Other functions of it have no types.
        self.mcap.add_message(connection.id, time, data, time)  # type: ignore[arg-type]

    def flush(self) -> None:
        """Write the chunk, so that a reindex restores all messages so far."""
        self.mcap.flush()  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Write the chunk and the index, and close the file."""
        if self.is_closed:
            return
        self.is_closed = True
        with self._file:
            self.mcap.finish()  # type: ignore[no-untyped-call]


@dataclass(slots=True)
class _Records:
    """The schemas, channels and messages in a sequence of records."""

    data: bytes
    times: array[int] = field(default_factory=lambda: array("Q"))
    ids: array[int] = field(default_factory=lambda: array("Q"))
    places: array[int] = field(default_factory=lambda: array("Q"))
    """Where the records of messages begin."""
    begins: array[int] = field(default_factory=lambda: array("Q"))
    ends: array[int] = field(default_factory=lambda: array("Q"))
    schemas: list[Schema] = field(default_factory=list)
    channels: list[Channel] = field(default_factory=list)


def _unpack_records(
    data: bytes, place: str, wanted: Collection[int] | None = None, *, partial: bool = False
) -> _Records:
    """Find the messages in the data of a chunk, as `bag_format.unpack_chunk` does."""
    found = _Records(data)
    try:
        _find_records(found, place, wanted)
    except BagFormatError:
        if not partial:
            raise
    return found


def _find_records(found: _Records, place: str, wanted: Collection[int] | None) -> None:
    data = found.data
    add_time, add_id, add_place = found.times.append, found.ids.append, found.places.append
    add_begin, add_end = found.begins.append, found.ends.append
    position, size = 0, len(data)
    unpack = _MESSAGE_RECORD.unpack_from
    while position < size:
        if size - position < _RECORD.size:
            raise BagFormatError(f"{place}: incomplete record at byte {position} of its data")
        kind, length = _RECORD.unpack_from(data, position)
        end = position + _RECORD.size + length
        if end > size:
            raise BagFormatError(f"{place}: record beyond the end of the chunk")
        if kind == _MESSAGE:
            if length < _MESSAGE_FIELDS:
                raise BagFormatError(f"{place}: message of {length} bytes")
            _, _, id_, _, time, _ = unpack(data, position)
            if wanted is None or id_ in wanted:
                add_time(time)
                add_id(id_)
                add_place(position)
                add_begin(position + _MESSAGE_RECORD.size)
                add_end(end)
        elif kind == _SCHEMA:
            found.schemas.append(_parse("Schema", data[end - length : end], place))
        elif kind == _CHANNEL:
            found.channels.append(_parse("Channel", data[end - length : end], place))
        position = end


def _parse(name: str, content: bytes, place: str) -> Any:
    """Return a record of the library by the name of its class.

    Raises:
        BagFormatError: its content is invalid.
    """
    from mcap import records
    from mcap.data_stream import ReadDataStream
    from mcap.exceptions import McapError

    try:
        return getattr(records, name).read(ReadDataStream(BytesIO(content)))
    except (McapError, struct.error, ValueError, OverflowError) as error:
        fault = str(error) or "its content ends too early"
        raise BagFormatError(f"{place}: invalid {name} record ({fault})") from None


class _Connections:
    """Makes connections of schemas and channels."""

    def __init__(self) -> None:
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._definitions: dict[int, str] = {}
        """Texts of schemas, which may be long, and shared by thousands of channels."""
        self._md5sums: dict[int, str] = {}

    def add(self, records: _Records) -> None:
        for schema in records.schemas:
            self._schemas[schema.id] = schema
            self._definitions.pop(schema.id, None)
            self._md5sums.pop(schema.id, None)
        for channel in records.channels:
            self._channels[channel.id] = channel

    def __contains__(self, id_: object) -> bool:
        return id_ in self._channels

    def ids(self) -> set[int]:
        return set(self._channels)

    def sorted(self) -> list[Connection]:
        """Return the connections in the order of their ids."""
        return with_known_types(self.connection(id_) for id_ in sorted(self._channels))

    def mended(self) -> list[Connection]:
        """Return those of no known type that `sorted` gives one."""
        pairs = zip(map(self.connection, sorted(self._channels)), self.sorted(), strict=True)
        return [each for each, found in pairs if each.type != found.type]

    def connection(self, id_: int) -> Connection:
        channel = self._channels[id_]
        schema = self._schemas.get(channel.schema_id)
        data = b"" if schema is None else schema.data
        type_ = "" if schema is None else schema.name
        definition = self._definitions.get(channel.schema_id)
        if definition is None:
            definition = self._definitions[channel.schema_id] = data.decode("utf-8", "replace")
        format_ = "" if schema is None else schema.encoding
        fields = {name: value.encode() for name, value in channel.metadata.items()}
        md5sum = channel.metadata.get("md5sum", "")
        if not md5sum and format_ == "ros1msg":
            if channel.schema_id not in self._md5sums:
                self._md5sums[channel.schema_id] = _md5sum(type_, definition)
            md5sum = self._md5sums[channel.schema_id]
        return Connection(
            id=id_,
            topic=channel.topic,
            type=type_,
            md5sum=md5sum,
            definition=definition,
            callerid=channel.metadata.get("callerid", ""),
            latching=channel.metadata.get("latching") in ("1", "true"),
            fields={**fields, "message_definition": data},
            encoding=channel.message_encoding,
            definition_format=format_,
        )


def _md5sum(type_: str, definition: str) -> str:
    """Return the md5sum of a type with its full text; ``*`` if that is invalid."""
    from fibws.interfaces.catalogue import TextDefinitions

    try:
        return TextDefinitions(type_, definition).md5(type_)
    except InterfaceError:
        return "*"


class McapReader(Reader):
    """Reads a .mcap file.

    Args:
        path: the file.
        allow_unindexed: whether a file without a summary is read as a whole to make one.
        file: an open file to read instead, in binary mode, which is closed with the reader.

    Raises:
        BagFormatError: it is damaged, or not a .mcap file.
        BagNotIndexed: it has no summary.
        UnsupportedBag: the package mcap is not installed.
        OSError: it cannot be read.
    """

    version = "MCAP0"

    def __init__(
        self, path: str, *, allow_unindexed: bool = False, file: BinaryIO | None = None
    ) -> None:
        _import_mcap(path)
        self.path = path
        opened = file or open(path, "rb")
        try:
            self.file = RecordFile(opened, path)
            self._runs: dict[int, int] = {}
            """Messages outside chunks: the sizes of sequences of records, by position."""
            self._partial: dict[int, bytes] = {}
            """The uncompressed data of damaged chunks, by position."""
            self._counts: dict[int, int] | None = None
            if self.file.read(0, min(8, self.file.size)) != MAGIC:
                raise BagFormatError(f"{path}: not an MCAP file")
            fault = self._read_summary()
            self.is_indexed = fault is None
            if fault is not None:
                if not allow_unindexed:
                    raise BagNotIndexed(path, fault)
                self._scan()
        except BaseException:
            opened.close()
            raise

    @property
    def size(self) -> int:
        return self.file.size

    @property
    def counts(self) -> dict[int, int]:
        if self._counts is None:
            self._counts = {}
            known = [each.id for each in self.connections]
            for chunk in self.chunks:
                for id_ in self._unpack_chunk(chunk, known).ids:
                    self._counts[id_] = self._counts.get(id_, 0) + 1
        return self._counts

    def close(self) -> None:
        self.file.file.close()

    def _read_summary(self) -> str | None:
        """Read the summary at the end of the file; return why it is missing, or None."""
        file = self.file
        position = file.size - _FOOTER_SIZE
        if position < len(MAGIC) or file.read(file.size - len(MAGIC), len(MAGIC)) != MAGIC:
            return "its end is missing"
        footer = file.read(position, _FOOTER_SIZE)
        kind, length, start, _, _ = struct.unpack_from("<BQQQI", footer)
        if (kind, length) != (_FOOTER, 20):
            return "its last record is not a footer"
        if start == 0:
            return "it was written without a summary"
        if start >= position:
            return "its summary is damaged"
        try:
            return self._unpack_summary(file.read(start, position - start))
        except BagFormatError as error:
            return f"its summary is damaged: {str(error).removeprefix(f'{self.path}: ')}"

    def _unpack_summary(self, data: bytes) -> str | None:
        records = _unpack_records(data, self.path)
        connections = _Connections()
        connections.add(records)
        self.connections = connections.sorted()
        self.mended = connections.mended()
        self.chunks = []
        statistics = None
        for kind, content in _split(data):
            if kind == _STATISTICS:
                statistics = _parse("Statistics", content, self.path)
            elif kind == _CHUNK_INDEX:
                self.chunks.append(self._chunk_info(content))
        self.chunks = in_file_order(self.chunks)
        if statistics is not None:
            self.others = statistics.attachment_count + statistics.metadata_count
        if statistics is not None and self.chunks:
            self._counts = {
                id_: count
                for id_, count in statistics.channel_message_counts.items()
                if count and id_ in connections
            }
        if not self.chunks and (statistics is None or statistics.message_count):
            return "its summary does not say where messages are"
        return None

    def _chunk_info(self, content: bytes) -> ChunkInfo:
        index = _parse("ChunkIndex", content, self.path)
        ids = index.message_index_offsets or [each.id for each in self.connections]
        if index.chunk_start_offset + index.chunk_length > self.file.size:
            raise BagFormatError("a chunk beyond the end of the file")
        return ChunkInfo(
            position=index.chunk_start_offset,
            start=index.message_start_time,
            end=index.message_end_time,
            counts=dict.fromkeys(ids, 0),
            compression=index.compression or "none",
            compressed_size=index.compressed_size,
            size=index.uncompressed_size,
        )

    def _scan(self) -> None:
        """Find chunks and messages by reading the whole file."""
        scan = McapScan(self.file)
        connections = scan.connections
        self.chunks = []
        self._counts = {}
        for part in scan.parts():
            connections.add(part.records)
            if not part.records.times:
                continue
            counts: dict[int, int] = {}
            for id_ in part.records.ids:
                counts[id_] = counts.get(id_, 0) + 1
            for id_, count in counts.items():
                self._counts[id_] = self._counts.get(id_, 0) + count
            times = part.records.times
            if part.is_run:
                self._runs[part.position] = len(part.records.data)
            elif part.is_partial:
                self._partial[part.position] = part.records.data
            self.chunks.append(
                ChunkInfo(
                    *(part.position, min(times), max(times), counts, part.compression),
                    *(part.compressed_size, len(part.records.data)),
                )
            )
        self.connections = connections.sorted()

    def _index_faults(self) -> Iterator[str]:
        listed = {chunk.position for chunk in self.chunks}
        for kind, position, _ in McapScan(self.file).records():
            if kind == _CHUNK and position not in listed:
                yield f"chunk at byte {position}: the index does not list it"
            elif kind == _MESSAGE:
                yield f"message at byte {position}: it is in no chunk"
        known = {each.id for each in self.connections}
        counts: Counter[int] = Counter()
        for chunk in self.chunks:
            found = self._unpack_chunk(chunk, None)
            counts.update(found.ids)
            yield from chunk_faults(chunk, found, known)
            if entries := self._entries(chunk):
                yield from entry_faults(chunk, found, entries)
        for id_ in sorted(counts.keys() | self.counts.keys()):
            if counts[id_] != self.counts.get(id_, 0):
                said = self.counts.get(id_, 0)
                yield f"channel {id_} has {counts[id_]} messages, the statistics say {said}"

    def _entries(self, chunk: ChunkInfo) -> dict[int, list[tuple[int, int]]]:
        """Return the times and places in the indexes behind a chunk, by channel."""
        entries: dict[int, list[tuple[int, int]]] = {}
        position = chunk.position
        kind, length = _RECORD.unpack(self.file.read(position, _RECORD.size))
        while True:
            position += _RECORD.size + length
            kind, length = _RECORD.unpack(self.file.read(position, _RECORD.size))
            if kind != _MESSAGE_INDEX:
                return entries
            content = self.file.read(position + _RECORD.size, length)
            index = _parse("MessageIndex", content, self.path)
            entries.setdefault(index.channel_id, []).extend(index.records)

    def _unpack_chunk(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        place = f"{self.path}: chunk at byte {chunk.position}"
        if chunk.position in self._runs:
            data = self.file.read(chunk.position, self._runs[chunk.position])
        elif chunk.position in self._partial:
            data = self._partial[chunk.position]
        else:
            with advice(self.path):
                data = _read_chunk(self.file, chunk.position, place)[1]
        found = _unpack_records(data, place, wanted, partial=not self.is_indexed)
        return ChunkMessages(data, found.times, found.ids, found.places, found.begins, found.ends)


def _split(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the kinds and contents of records that were checked before."""
    position = 0
    while position < len(data):
        kind, length = _RECORD.unpack_from(data, position)
        position += _RECORD.size + length
        yield kind, data[position - length : position]


def _read_chunk(file: RecordFile, position: int, place: str) -> tuple[str, bytes, int]:
    """Return the compression method, the uncompressed data and the compressed size of a chunk.

    Raises:
        BagFormatError: it is damaged.
        UnsupportedBag: the method is unknown.
    """
    kind, length = _RECORD.unpack(file.read(position, _RECORD.size))
    if kind != _CHUNK:
        raise BagFormatError(f"{place}: expected a chunk, got a record of kind {kind}")
    chunk = _parse("Chunk", file.read(position + _RECORD.size, length), place)
    method = chunk.compression or "none"
    if method not in METHODS:
        raise UnsupportedBag(f"{place}: unknown compression {method!r}", "compression")
    data = compression.decompress(chunk.data, method, chunk.uncompressed_size, place)
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise BagFormatError(f"{place}: its checksum is wrong")
    return method, data, len(chunk.data)


@dataclass(slots=True)
class FoundPart:
    """A chunk, or a sequence of records outside chunks."""

    position: int
    records: _Records
    is_run: bool
    compression: str = "none"
    compressed_size: int = 0
    is_partial: bool = False


class McapScan:
    """Reads all records of a .mcap file from its start, and goes on after damaged parts.

    Args:
        is_strict: whether a damaged chunk is an error instead.

    Attributes:
        connections: those whose records are outside chunks, such as at the end.
        lost: how many bytes could not be read.
        damaged: how many chunks have a wrong checksum, though something in them was read.
        others: the attachments and the metadata, as records of the library.
        profile: what messages the file has.
    """

    def __init__(self, file: RecordFile, *, is_strict: bool = False) -> None:
        self.path = file.path
        self._file = file
        self._is_strict = is_strict
        self.others: list[Any] = []
        self.profile = ""
        self.connections = _Connections()
        for kind, position, end in self.records():
            if kind in (_SCHEMA, _CHANNEL):
                self.connections.add(self._run(position, end).records)
        self.lost = self.damaged = 0

    def parts(self) -> Iterator[FoundPart]:
        """Find all chunks and all messages outside them, in the order of the file."""
        begin = stop = 0
        for kind, position, end in self.records():
            if kind in (_SCHEMA, _CHANNEL, _MESSAGE):
                if position == stop and end - begin <= _RUN:
                    stop = end
                    continue
                if begin < stop:
                    yield self._run(begin, stop)
                begin, stop = position, end
                continue
            if begin < stop:
                yield self._run(begin, stop)
                begin = stop
            if kind == _CHUNK and (part := self._chunk(position, end)):
                yield part
            elif kind in _OTHERS:
                start = position + _RECORD.size
                self._add_other(_OTHERS[kind], self._file.read(start, end - start))
            elif kind == _DATA_END:
                return
        if begin < stop:
            yield self._run(begin, stop)

    def records(self) -> Iterator[tuple[int, int, int]]:
        """Yield kind, start and end of each record; a chunk may be cut off by the file's end."""
        file = self._file
        self.lost = 0
        position = len(MAGIC)
        while position + _RECORD.size <= file.size:
            kind, length = _RECORD.unpack(file.read(position, _RECORD.size))
            end = position + _RECORD.size + length
            if kind and end <= file.size:
                yield kind, position, end
                if kind == _FOOTER:
                    return
                position = end
                continue
            found = self._next_chunk(position + 1)
            stop = file.size if found is None else found
            if kind == _CHUNK:
                yield kind, position, stop
            self.lost += stop - position
            if found is None:
                return
            position = found
        self.lost += file.size - position

    def _next_chunk(self, position: int) -> int | None:
        """Return where the next chunk begins; None if there is none."""
        file = self._file
        size = 2**12
        while position < file.size:
            block = file.read(position, min(size, file.size - position))
            for found in _CHUNK_LIKE.finditer(block):
                if self._is_chunk(position + found.start()):
                    return position + found.start()
            if position + len(block) == file.size:
                return None
            position += len(block) - 64  # A chunk's start is shorter.
            size = min(2 * size, _RUN)
        return None

    def _is_chunk(self, position: int) -> bool:
        try:
            start = self._file.read(position, _RECORD.size + _CHUNK_START.size)
            _, length = _RECORD.unpack_from(start)
            *_, name = _CHUNK_START.unpack_from(start, _RECORD.size)
            place = position + _RECORD.size + _CHUNK_START.size + name
            size = int.from_bytes(self._file.read(place, 8), "little")
        except BagFormatError:
            return False
        return bool(length == _CHUNK_START.size + name + 8 + size)

    def _run(self, begin: int, end: int) -> FoundPart:
        data = self._file.read(begin, end - begin)
        return FoundPart(begin, _unpack_records(data, self._file.path, partial=True), is_run=True)

    def _chunk(self, position: int, end: int) -> FoundPart | None:
        """Return a chunk, or what is left of it."""
        file = self._file
        place = f"{file.path}: chunk at byte {position}"
        try:
            method, data, size = _read_chunk(file, position, place)
            return FoundPart(position, _unpack_records(data, place), False, method, size)
        except BagFormatError:
            if self._is_strict:
                raise
            length = min(end - position - _RECORD.size, compression.MAX_SIZE)
            content = file.read(position + _RECORD.size, length)
        if len(content) < _CHUNK_START.size:
            return None
        _, _, size, _, length = _CHUNK_START.unpack_from(content)
        kind_and_length = _RECORD.unpack(file.read(position, _RECORD.size))
        begin = _CHUNK_START.size + length
        method = content[_CHUNK_START.size : begin].decode("utf-8", "replace") or "none"
        if method not in METHODS:
            return None
        data = compression.decompress_start(content[begin + 8 :], method, place)
        records = _unpack_records(data, place, partial=True)
        if kind_and_length == (_CHUNK, end - position - _RECORD.size):  # It was not cut off.
            self.damaged += bool(records.ends)
            read = records.ends[-1] if records.ends else 0
            self.lost += max(0, min(size, file.size) - read)
        return FoundPart(position, records, False, method, len(content), is_partial=True)

    def _add_other(self, name: str, content: bytes) -> None:
        try:
            record = _parse(name, content, self._file.path)
        except BagFormatError:
            return
        if name == "Header":
            self.profile = record.profile
        else:
            self.others.append(record)


def rewrite_mcap(
    source: str,
    target: str,
    method: str | None = None,
    *,
    chunk_size: int = CHUNK_SIZE,
    is_strict: bool = False,
) -> Restored:
    """Write a new .mcap file, with an index, of what is left of one.

    Args:
        method: the compression; that of the first chunk if None.
        is_strict: whether damage is an error.

    Returns:
        What was found.

    Raises:
        BagFormatError: it is not a .mcap file, or damaged if ``is_strict``.
        BagError: an invalid compression.
        OSError: a file cannot be read or written.
    """
    _import_mcap(source)
    with open(source, "rb") as opened:
        file = RecordFile(opened, source)
        if file.read(0, min(len(MAGIC), file.size)) != MAGIC:
            raise BagFormatError(f"{source}: not an MCAP file")
        scan = McapScan(file, is_strict=is_strict)
        count, found = _rewrite(scan, target, method, chunk_size, {})
        if any(each.type == ANY_TYPE for each in found):
            known = {each.id: each for each in with_known_types(found)}
            scan = McapScan(file, is_strict=is_strict)
            count, _ = _rewrite(scan, target, method, chunk_size, known)
        if is_strict and scan.lost:
            raise BagFormatError(f"{source}: {scan.lost} bytes cannot be read")
        return Restored(count, scan.lost, scan.damaged)


def _rewrite(
    scan: McapScan,
    target: str,
    method: str | None,
    chunk_size: int,
    known: Mapping[int, Connection],
) -> tuple[int, list[Connection]]:
    """Write what is left of a file.

    Args:
        known: connections to write in place of those of the same id.

    Returns:
        The number of messages, and the file's connections.
    """
    parts = scan.parts()
    first = next(parts, None)
    if method is None:
        method = first.compression if first else "none"
    connections = scan.connections
    ids: dict[int, Connection] = {}
    count = 0
    writer = McapWriter(target, method, chunk_size, profile=scan.profile, name=scan.path)
    with writer:
        for part in chain([first] if first else [], parts):
            records = part.records
            connections.add(records)
            for place, end in zip(records.places, records.ends, strict=True):
                _, _, id_, number, time, publish_time = _MESSAGE_RECORD.unpack_from(
                    records.data, place
                )
                if id_ not in connections:
                    continue
                if id_ not in ids:
                    connection = known.get(id_) or connections.connection(id_)
                    ids[id_] = writer.copy_connection(connection)
                data = records.data[place + _MESSAGE_RECORD.size : end]
                writer.mcap.add_message(ids[id_].id, time, data, publish_time, number)
                count += 1
        for id_ in connections.ids() - ids.keys():
            writer.copy_connection(known.get(id_) or connections.connection(id_))
        for other in scan.others:
            if hasattr(other, "metadata"):
                writer.mcap.add_metadata(other.name, other.metadata)
            else:
                writer.mcap.add_attachment(
                    *(other.create_time, other.log_time, other.name, other.media_type),
                    other.data,
                )
    found = [connections.connection(id_) for id_ in sorted(connections.ids())]
    return count, found


def check_method(method: str, path: str) -> None:
    """Check that a .mcap file can be written with a compression.

    Raises:
        BagError: the compression is unknown.
        UnsupportedBag: the package mcap is not installed.
    """
    if method not in METHODS:
        raise BagError(
            f"{path}: compression {method!r} does not exist in MCAP, expected {', '.join(METHODS)}"
        )
    _import_mcap(path)


def _import_mcap(path: str) -> None:
    """Raise UnsupportedBag if the package mcap is not installed."""
    try:
        import mcap  # noqa: F401 - only whether it is there
    except ImportError:
        fault = f"{path}: MCAP files need the package mcap: pip install 'fibws[mcap]'"
        raise UnsupportedBag(fault, "format") from None
