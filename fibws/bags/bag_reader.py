"""Reading of .bag files."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from typing import TYPE_CHECKING, BinaryIO, Self

from fibws.bags import bag_format, compression
from fibws.bags.bag_format import Record, RecordFile
from fibws.bags.bag_scan import BagScan
from fibws.bags.connection import ChunkInfo, Connection, with_known_types
from fibws.bags.reader import (
    ChunkMessages,
    Reader,
    advice,
    chunk_faults,
    entry_faults,
    in_file_order,
)
from fibws.errors import BagFormatError, BagNotIndexed, UnsupportedBag

if TYPE_CHECKING:
    from fibws.bags.bag_writer import BagWriter

_INDEX_FIELDS = {"op", "ver", "conn", "count"}
"""The fields of the header of an index."""


def read_start(file: RecordFile) -> Record:
    """Return the first record of a bag, which says where the index is.

    Raises:
        BagFormatError: it is damaged, or not a bag.
        UnsupportedBag: its version is not 2.0, or it is encrypted.
    """
    path = file.path
    if file.size == 0:
        raise BagFormatError(f"{path}: the file is empty")
    start = file.read(0, min(file.size, len(bag_format.VERSION_LINE)))
    if start != bag_format.VERSION_LINE:
        found = re.match(rb"#ROS(?:BAG|LOG|RECORD) V(\d+\.\d+)", start)
        if found is None:
            raise BagFormatError(f"{path}: not a bag: it does not begin with #ROSBAG V2.0")
        raise UnsupportedBag(
            f"{path}: a bag of version {found[1].decode()}, but only version 2.0 is supported; "
            "'rosbag fix' of ROS 1 converts older bags",
            "version",
        )
    header = file.record(len(start))
    if header.op != bag_format.FILE_HEADER:
        raise BagFormatError(f"{path}: the first record is not the header of a bag")
    encryptor = header.fields.get("encryptor", b"").decode("utf-8", "replace")
    if encryptor:
        fault = f"{path}: encrypted by {encryptor}, which is not supported"
        raise UnsupportedBag(fault, "encryption")
    return header


class BagReader(Reader):
    """Reads a .bag file.

    Args:
        path: the file.
        allow_unindexed: whether a bag without an index is read as a whole to make one.
        file: an open file to read instead, in binary mode.

    Raises:
        BagFormatError: it is damaged, or not a bag.
        BagNotIndexed: it has no index.
        UnsupportedBag: its version is not 2.0, or it is encrypted.
        OSError: it cannot be read.
    """

    def __init__(
        self, path: str, *, allow_unindexed: bool = False, file: BinaryIO | None = None
    ) -> None:
        opened: BinaryIO = file or open(path, "rb")
        self.path = path
        try:
            self.file = RecordFile(opened, path)
            header = read_start(self.file)
            self.header_end = header.end
            """Where the first record ends, which other programs pad differently."""
            self._read_index(header, allow_unindexed)
        except BaseException:
            if file is None:
                opened.close()
            raise
        self.version = "2.0"

    @classmethod
    def of_writer(cls, writer: BagWriter) -> Self:
        """Return a reader of what a writer has written to its file so far.

        It must not be closed, and reads only until the writer goes on.
        """
        reader = cls.__new__(cls)
        reader.path = writer.path
        reader.file = RecordFile(writer.file, writer.path)
        reader.version = "2.0"
        reader.connections = list(writer.connections)
        reader.chunks = list(writer.chunks)
        reader.index_position = writer.position
        reader.is_indexed = True
        reader._partial = {}
        return reader

    @property
    def size(self) -> int:
        return self.file.size

    @property
    def counts(self) -> dict[int, int]:
        counts: dict[int, int] = {}
        for chunk in self.chunks:
            for id_, count in chunk.counts.items():
                counts[id_] = counts.get(id_, 0) + count
        return counts

    def close(self) -> None:
        self.file.file.close()

    def _read_index(self, header: Record, allow_unindexed: bool) -> None:
        place = f"{self.path}: header"
        self.index_position = bag_format.number(header.fields, "index_pos", 8, place)
        """Where the chunks end."""
        self._partial: dict[int, bytes] = {}
        self.is_indexed = True
        fault = "it was not closed"
        if self.index_position:
            try:
                self._unpack_index(
                    bag_format.number(header.fields, "conn_count", 4, place),
                    bag_format.number(header.fields, "chunk_count", 4, place),
                )
                return
            except BagFormatError as error:
                fault = str(error).removeprefix(f"{self.path}: ")
        if not allow_unindexed:
            raise BagNotIndexed(self.path, fault)
        self.is_indexed = False
        scan = BagScan(self.file, is_closed=self.index_position != 0)
        self.chunks = []
        for chunk in scan.chunks():
            if chunk.is_partial:
                self._partial[chunk.info.position] = chunk.data
            self.chunks.append(chunk.info)
        self.connections = scan.sorted_connections()

    def _unpack_index(self, connection_count: int, chunk_count: int) -> None:
        connections: dict[int, Connection] = {}
        chunks: list[ChunkInfo] = []
        position = self.index_position
        for number in range(connection_count + chunk_count):
            record = self.file.record(position)
            data = self.file.data(record)
            place = f"record at byte {position}"
            if number < connection_count:
                record.expect(bag_format.CONNECTION, place)
                connection = bag_format.unpack_connection(record.fields, data, place)
                connections[connection.id] = connection
            else:
                record.expect(bag_format.CHUNK_INFO, place)
                chunks.append(self._read_chunk_header(bag_format.unpack_chunk_info(record, data)))
            position = record.end
        in_order = sorted(connections.values(), key=lambda each: each.id)
        self.connections = with_known_types(in_order)
        self.mended = [
            each
            for each, found in zip(in_order, self.connections, strict=True)
            if each.type != found.type
        ]
        self.chunks = in_file_order(chunks)

    def _read_chunk_header(self, info: ChunkInfo) -> ChunkInfo:
        """Complete what the index says of a chunk."""
        place = f"chunk at byte {info.position}"
        record = self.file.record(info.position)
        record.expect(bag_format.CHUNK, place)
        if record.end > self.file.size:
            raise BagFormatError(f"{place} is longer than the file")
        info.compression = bag_format.text(record.fields, "compression", place)
        info.compressed_size = record.data_size
        info.size = bag_format.number(record.fields, "size", 4, place)
        return info

    def index_order(self) -> tuple[str, ...]:
        """Return the names of the fields of the chunks' indexes, in their order.

        Some programs, such as rosbags, expect that it is the same in the whole file.
        """
        for chunk in self.chunks[:1]:
            record = self.file.record(self.file.record(chunk.position).end)
            if record.op == bag_format.INDEX and record.fields.keys() == _INDEX_FIELDS:
                return tuple(record.fields)
        return ()

    def _chunk_times(self, chunk: ChunkInfo, wanted: Collection[int]) -> Iterable[int]:
        """Return times from the index of a chunk, which is short and never compressed."""
        if not self.is_indexed:
            return super()._chunk_times(chunk, wanted)
        times: list[int] = []
        position = self.file.record(chunk.position).end
        for _ in chunk.counts:
            record = self.file.record(position)
            place = f"{self.path}: record at byte {position}"
            record.expect(bag_format.INDEX, place)
            if bag_format.number(record.fields, "conn", 4, place) in wanted:
                data = self.file.data(record)
                if len(data) % bag_format.INDEX_ENTRY.size:
                    raise BagFormatError(f"{place}: incomplete index of a chunk")
                entries = bag_format.INDEX_ENTRY.iter_unpack(data)
                times += [seconds * 1_000_000_000 + ns for seconds, ns, _ in entries]
            position = record.end
        return times

    def _index_faults(self) -> Iterator[str]:
        listed = {chunk.position for chunk in self.chunks}
        position = self.header_end
        while position < self.index_position:
            record = self.file.record(position)
            if record.op == bag_format.CHUNK and position not in listed:
                yield f"chunk at byte {position}: the index does not list it"
            position = record.end
        known = {each.id for each in self.connections}
        for chunk in self.chunks:
            found = self._unpack_chunk(chunk, None)
            yield from chunk_faults(chunk, found, known)
            yield from entry_faults(chunk, found, self._entries(chunk))

    def _entries(self, chunk: ChunkInfo) -> dict[int, list[tuple[int, int]]]:
        """Return the times and places of messages in the index of a chunk, by connection."""
        entries: dict[int, list[tuple[int, int]]] = {}
        position = self.file.record(chunk.position).end
        while position < self.index_position:
            record = self.file.record(position)
            if record.op != bag_format.INDEX:
                break
            place = f"{self.path}: record at byte {position}"
            data = self.file.data(record)
            if len(data) % bag_format.INDEX_ENTRY.size:
                raise BagFormatError(f"{place}: incomplete index of a chunk")
            entries.setdefault(bag_format.number(record.fields, "conn", 4, place), []).extend(
                (seconds * 1_000_000_000 + ns, found)
                for seconds, ns, found in bag_format.INDEX_ENTRY.iter_unpack(data)
            )
            position = record.end
        return entries

    def _unpack_chunk(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        place = f"{self.path}: chunk at byte {chunk.position}"
        data = self._partial.get(chunk.position)
        if data is None:
            record = self.file.record(chunk.position)
            with advice(self.path):
                data = compression.decompress(
                    self.file.data(record), chunk.compression, chunk.size, place
                )
        found = bag_format.unpack_chunk(data, place, wanted)
        return ChunkMessages(data, found.times, found.ids, found.places, found.begins, found.ends)
