"""Finding what is left of a .bag file that has no index, or a damaged one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fibws.bags import bag_format, compression
from fibws.bags.bag_format import INDEX_ENTRY, Record, RecordFile, UnpackedChunk
from fibws.bags.connection import ChunkInfo, Connection
from fibws.errors import BagFormatError

_BLOCK = 2**20
_COMPRESSION = b"compression="
_STARTS = (8, 16, 21, 29)
"""How far before the name of this field a chunk's record may begin: by the fields before it."""


class FoundChunk(NamedTuple):
    """A chunk of which at least a part is left."""

    info: ChunkInfo
    data: bytes
    """Compressed as ``info`` says."""
    messages: UnpackedChunk
    is_partial: bool
    """Whether messages at its end are missing; it is not compressed then."""

    def indexes(self) -> bytes:
        """Return the records of its index."""
        entries: dict[int, list[tuple[int, int]]] = {id_: [] for id_ in self.info.counts}
        found = self.messages
        for time, id_, place in zip(found.times, found.ids, found.places, strict=True):
            if id_ in entries:
                entries[id_].append((time, place))
        parts = []
        for id_, places in entries.items():
            places.sort()
            packed = (INDEX_ENTRY.pack(*divmod(time, 10**9), place) for time, place in places)
            parts.append(bag_format.pack_index(id_, b"".join(packed)))
        return b"".join(parts)


class BagScan:
    """Reads all records of a bag from its start, and goes on after damaged parts.

    Args:
        file: the bag.
        is_closed: whether its recorder closed it. The last chunk of another one may have a header
            that was written before its size was known.
    """

    def __init__(self, file: RecordFile, *, is_closed: bool) -> None:
        self._file = file
        self._is_closed = is_closed
        self.lost = 0
        """How many bytes between records could not be read."""
        self.connections: dict[int, Connection] = {}
        for record in self._records():
            if record.op == bag_format.CONNECTION and record.end <= file.size:
                self._add_connection(record)
        self.lost = 0

    def sorted_connections(self) -> list[Connection]:
        """Return all connections in the order of their ids; those in chunks were found by then."""
        return sorted(self.connections.values(), key=lambda each: each.id)

    def _add_connection(self, record: Record) -> None:
        try:
            data = self._file.data(record)
            found = bag_format.unpack_connection(record.fields, data, self._file.path)
        except BagFormatError:
            return  # The chunk of its messages has it, too.
        self.connections[found.id] = found

    def chunks(self) -> Iterator[FoundChunk]:
        """Find all chunks with messages of known connections, in the order of the file."""
        for record in self._records():
            if record.op == bag_format.CHUNK and (found := self._chunk(record)):
                yield found

    def _chunk(self, record: Record) -> FoundChunk | None:
        """Return a chunk, or what is left of it."""
        file = self._file
        place = f"{file.path}: chunk at byte {record.position}"
        try:
            method = bag_format.text(record.fields, "compression", place)
            size = bag_format.number(record.fields, "size", 4, place)
        except BagFormatError:
            return None
        if method not in compression.METHODS:
            return None
        try:
            if self._is_open(record):
                raise BagFormatError(f"{place}: not complete")
            data = file.data(record)
            plain = compression.decompress(data, method, size, place)
            messages, is_partial = bag_format.unpack_chunk(plain, place), False
        except BagFormatError:
            end = file.size if self._is_open(record) else min(record.end, file.size)
            length = min(end - record.data_position, compression.MAX_SIZE)
            data = file.read(record.data_position, length)
            plain = compression.decompress_start(data, method, place)
            messages = bag_format.unpack_chunk(plain, place, partial=True)
            is_partial = True
            method, data = "none", plain[: messages.size]
        self.connections |= messages.connections
        counts: dict[int, int] = {}
        for id_ in messages.ids:
            if id_ in self.connections:
                counts[id_] = counts.get(id_, 0) + 1
        if not counts:
            return None
        info = ChunkInfo(
            position=record.position,
            start=min(messages.times),
            end=max(messages.times),
            counts=counts,
            compression=method,
            compressed_size=len(data),
            size=len(plain) if not is_partial else len(data),
        )
        return FoundChunk(info, data, messages, is_partial)

    def _is_open(self, record: Record) -> bool:
        """Return whether a chunk's size was not known yet: its data ends where the file does."""
        return not self._is_closed and record.data_size == 0

    def _records(self) -> Iterator[Record]:
        """Read the records of the file; the last one's data may be cut off."""
        file = self._file
        position: int | None = len(bag_format.VERSION_LINE)
        while position is not None and position < file.size:
            try:
                record = file.record(position)
            except BagFormatError:
                position = self._skip(position)
                continue
            yield record
            if record.end > file.size:
                position = self._skip(position)
            elif record.op == bag_format.CHUNK and self._is_open(record):
                return
            else:
                position = record.end

    def _skip(self, position: int) -> int | None:
        """Return where the next chunk after a damaged record begins; None if there is none."""
        found = self._next_chunk(position + 1)
        self.lost += (self._file.size if found is None else found) - position
        return found

    def _next_chunk(self, position: int) -> int | None:
        file = self._file
        while position < file.size:
            block = file.read(position, min(_BLOCK, file.size - position))
            found = -1
            while (found := block.find(_COMPRESSION, found + 1)) >= 0:
                for before in _STARTS:
                    start = position + found - before
                    if start >= position and self._is_chunk(start):
                        return start
            if len(block) < _BLOCK:
                return None
            position += _BLOCK - 64
        return None

    def _is_chunk(self, position: int) -> bool:
        try:
            record = self._file.record(position)
            bag_format.number(record.fields, "size", 4, "")
        except BagFormatError:
            return False
        return record.op == bag_format.CHUNK
