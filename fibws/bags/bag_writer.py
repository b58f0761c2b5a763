"""Writing of .bag files."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from types import TracebackType
from typing import BinaryIO, Self

from fibws.bags import bag_format, compression
from fibws.bags.bag_format import (
    INDEX_ENTRY,
    LENGTH,
    MESSAGE_MIDDLE,
    MESSAGE_RECORD,
    MESSAGE_START,
)
from fibws.bags.bag_reader import BagReader
from fibws.bags.connection import ChunkInfo, Connection
from fibws.errors import BagError
from fibws.files import open_to_write

CHUNK_SIZE = 768 * 1024
"""The default size of chunks, which is that of rosbag, too."""
_LARGEST_MESSAGE = 2**31
"""In bytes; a chunk that is larger has one message only."""


class BagWriter:
    """Writes serialized messages to a .bag file.

    A chunk is written as soon as it is large enough, and by `flush`. What has been written is
    restored by a reindex if the program ends before `close`.

    Args:
        path: the file; one that exists is replaced.
        compression: ``none``, ``bz2`` or ``lz4``.
        chunk_size: how many bytes, uncompressed, end a chunk.
        file: an open file to write to instead, in binary mode.

    Raises:
        BagError: an invalid compression, or one whose package is not installed.
        OSError: the file cannot be written; from `write`, `flush` and `close`, too.
    """

    def __init__(
        self,
        path: str,
        compression: str = "none",
        chunk_size: int = CHUNK_SIZE,
        *,
        file: BinaryIO | None = None,
    ) -> None:
        self._prepare(path, compression, chunk_size)
        self.file: BinaryIO = file or open_to_write(path)
        try:
            self._write_all(bag_format.VERSION_LINE + self._file_header(0))
        except BaseException:
            if file is None:
                self.file.close()
            raise
        self.position = self.file.tell()

    def _prepare(self, path: str, method: str, chunk_size: int) -> None:
        compression.check_method(method)
        self.path = path
        self.compression = method
        self.chunk_size = chunk_size
        self.position = 0
        """Where the next chunk begins in the file."""
        self.connections: list[Connection] = []
        """In the order of their ids."""
        self._definitions: dict[str, bytes] = {}
        self.chunks: list[ChunkInfo] = []
        """The chunks that are complete."""
        self.is_closed = False
        self._header_end = len(bag_format.VERSION_LINE) + 8 + bag_format.FILE_HEADER_SIZE
        self._index_order: tuple[str, ...] = ()
        self._chunk = bytearray()
        self._indexes: dict[int, _Index] = {}
        """Of the chunk, by connection."""
        self._written: set[int] = set()
        """The connections whose records are in a chunk."""

    @classmethod
    def append(
        cls, bag: BagReader, *, compression: str = "none", chunk_size: int = CHUNK_SIZE
    ) -> Self:
        """Continue a bag, whose index is removed until the writer is closed.

        Args:
            bag: a bag with an index, whose file is open for writing, too; it is closed with the
                writer.
        """
        writer = cls.__new__(cls)
        writer._prepare(bag.path, compression, chunk_size)
        writer.file = file = bag.file.file
        writer.connections += bag.connections
        writer.chunks += bag.chunks
        writer._header_end = bag.header_end
        writer._index_order = bag.index_order()
        writer._written |= {each.id for each in bag.connections}
        file.seek(len(bag_format.VERSION_LINE))
        writer._write_all(writer._file_header(0))
        file.truncate(bag.index_position)
        writer.position = bag.index_position
        return writer

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
    def size(self) -> int:
        """The size of the file in bytes, as if the chunk were written now without compression."""
        return self.position + len(self._chunk)

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
    ) -> Connection:
        """Add a connection: a publisher of a topic.

        Args:
            definition: the full text of the type.
            callerid: the publisher's name, if it is known.
            fields: a whole connection header to write instead of one of the other arguments.
        """
        own = {
            "topic": topic.encode(),
            "type": type.encode(),
            "md5sum": md5sum.encode(),
            "message_definition": self._encode(definition),
        }
        if callerid:
            own["callerid"] = callerid.encode()
            own["latching"] = b"1" if latching else b"0"
        elif latching:
            own["latching"] = b"1"
        connection = Connection(
            id=self.connections[-1].id + 1 if self.connections else 0,
            topic=topic,
            type=type,
            md5sum=md5sum,
            definition=definition,
            callerid=callerid,
            latching=latching,
            fields={**own, **fields} if fields else own,
        )
        self.connections.append(connection)
        return connection

    def _encode(self, definition: str) -> bytes:
        """Return the bytes of a definition, which its connections share."""
        found = self._definitions.get(definition)
        if found is None:
            found = self._definitions[definition] = definition.encode()
        return found

    def copy_connection(self, connection: Connection) -> Connection:
        """Add a connection of another bag, with all fields of its header.

        Raises:
            BagError: its messages are not serialized as in ROS 1.
        """
        if connection.encoding != "ros1":
            raise BagError(
                f"{self.path}: .bag files hold messages of ROS 1 only, but {connection.topic} is "
                f"encoded as {connection.encoding}; write a .mcap file"
            )
        return self.connection(
            connection.topic,
            connection.type,
            connection.md5sum,
            connection.definition,
            callerid=connection.callerid,
            latching=connection.latching,
            fields=connection.fields,
        )

    def write(
        self, connection: Connection, time: int, data: bytes | bytearray | memoryview
    ) -> None:
        """Add a message.

        Args:
            connection: one of this writer's.
            time: when it was received, in ns since 1970.
            data: the serialized message; a memoryview must be one of bytes.

        Raises:
            BagError: the time or the size is more than bags can hold, or the writer is closed.
            OSError: the chunk was complete, and cannot be written.
        """
        size = len(data)
        if not 0 <= time < bag_format.MAX_TIME or size > _LARGEST_MESSAGE:
            raise BagError(
                f"{self.path}: bags hold times from 1970 to 2106 and messages of up to 2 GiB, got "
                f"one of {size} bytes at {time / 1e9:.0f} s"
            )
        if len(self._chunk) + size > _LARGEST_MESSAGE:
            self.flush()
        index = self._indexes.get(connection.id) or self._begin_index(connection, time)
        chunk = self._chunk
        seconds, nanoseconds = divmod(time, 1_000_000_000)
        index.entries += INDEX_ENTRY.pack(seconds, nanoseconds, len(chunk))
        chunk += MESSAGE_RECORD.pack(
            MESSAGE_START, connection.id, MESSAGE_MIDDLE, seconds, nanoseconds, size
        )
        chunk += data
        if time >= index.end:
            index.end = time
        else:
            index.is_sorted = False
            index.start = min(index.start, time)
        if len(chunk) >= self.chunk_size:
            self.flush()

    def _begin_index(self, connection: Connection, time: int) -> _Index:
        if self.is_closed:
            raise BagError(f"{self.path}: the bag is closed")
        if connection.id not in self._written:
            self._chunk += bag_format.pack_connection(connection)
            self._written.add(connection.id)
        index = self._indexes[connection.id] = _Index(time)
        return index

    def flush(self) -> None:
        """Write the chunk, so that a reindex restores all messages so far.

        Raises:
            OSError: it cannot be written. The file remains as before, and the chunk in memory.
        """
        if not self._indexes:
            return
        data = compression.compress(self._chunk, self.compression)
        info = ChunkInfo(
            position=self.position,
            start=min(index.start for index in self._indexes.values()),
            end=max(index.end for index in self._indexes.values()),
            counts={id_: index.count for id_, index in self._indexes.items()},
            compression=self.compression,
            compressed_size=len(data),
            size=len(self._chunk),
        )
        indexes = (index.record(id_, self._index_order) for id_, index in self._indexes.items())
        self.add_chunk(info, data, b"".join(indexes))
        self._chunk = bytearray()
        self._indexes.clear()

    def add_chunk(self, info: ChunkInfo, data: bytes | bytearray, indexes: bytes) -> None:
        """Write a whole chunk.

        Args:
            info: what is in it; its position is set here.
            data: the chunk's data, compressed as ``info`` says.
            indexes: the records of its index.

        Raises:
            OSError: it cannot be written; the file remains as before.
        """
        header = bag_format.pack_fields(
            {
                "op": bytes([bag_format.CHUNK]),
                "compression": info.compression.encode(),
                "size": LENGTH.pack(info.size),
            }
        )
        self.file.seek(self.position)
        try:
            self._write_all(header + LENGTH.pack(len(data)))
            self._write_all(data)
            self._write_all(indexes)
        except OSError:
            with suppress(OSError):  # An incomplete chunk would only take space.
                self.file.truncate(self.position)
            raise
        info.position = self.position
        self.chunks.append(info)
        self.position = self.file.tell()

    def close(self) -> None:
        """Write the chunk and the index, and close the file.

        Raises:
            OSError: a part cannot be written; the file is closed, and a reindex restores the rest.
        """
        if self.is_closed:
            return
        self.is_closed = True
        with self.file:
            try:
                self.flush()
            finally:
                self._write_end()

    def _write_end(self) -> None:
        self.file.seek(self.position)
        connections = b"".join(map(bag_format.pack_connection, self.connections))
        chunks = b"".join(map(bag_format.pack_chunk_info, self.chunks))
        self._write_all(connections + chunks)
        self.file.seek(len(bag_format.VERSION_LINE))
        self._write_all(self._file_header(self.position))

    def _write_all(self, data: bytes | bytearray) -> None:
        """Write data that the operating system may accept in parts; nothing waits in a buffer."""
        rest = memoryview(data)
        while rest:
            rest = rest[self.file.write(rest) :]

    def _file_header(self, index_position: int) -> bytes:
        """Return the first record; the position is 0 until the bag is complete."""
        header = bag_format.pack_fields(
            {
                "op": bytes([bag_format.FILE_HEADER]),
                "index_pos": index_position.to_bytes(8, "little"),
                "conn_count": LENGTH.pack(len(self.connections) if index_position else 0),
                "chunk_count": LENGTH.pack(len(self.chunks) if index_position else 0),
            }
        )
        padding = self._header_end - len(bag_format.VERSION_LINE) - len(header) - 4
        if padding < 0:
            raise BagError(f"{self.path}: the first record has no room for the header of a bag")
        return header + LENGTH.pack(padding) + b" " * padding


class _Index:
    """The messages of one connection in a chunk."""

    __slots__ = ("end", "entries", "is_sorted", "start")

    def __init__(self, time: int) -> None:
        self.entries = bytearray()
        self.start = self.end = time
        self.is_sorted = True

    @property
    def count(self) -> int:
        return len(self.entries) // INDEX_ENTRY.size

    def record(self, id_: int, order: tuple[str, ...]) -> bytes:
        """Return the index as a record; readers expect its entries in the order of time."""
        if not self.is_sorted:
            entries = sorted(INDEX_ENTRY.iter_unpack(self.entries), key=lambda entry: entry[:2])
            self.entries = bytearray().join(INDEX_ENTRY.pack(*entry) for entry in entries)
        return bag_format.pack_index(id_, self.entries, order)
