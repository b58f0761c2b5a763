"""Finding what is left of a .bag file that has no index, or a damaged one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fibws.bags import bag_format, compression
from fibws.bags.bag_format import INDEX_ENTRY, Record, RecordFile, UnpackedChunk
from fibws.bags.connection import ChunkInfo, Connection, with_known_types
from fibws.errors import BagFormatError

_SMALLEST_BLOCK, _LARGEST_BLOCK = 2**12, 2**20
"""How many bytes are searched at once; few at first, as the next chunk may be near."""
_OVERLAP = 64
"""More bytes than those up to the name of the field in `_COMPRESSION`."""
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
        self._resume = 0
        """Where to go on after a record: behind it, or at a chunk inside a damaged one."""
        self._budget = 4 * file.size
        """How many bytes of damaged chunks may be read again, to find chunks inside them."""
        self.lost = 0
        """About how many bytes could not be read."""
        self.connections: dict[int, Connection] = {}
        for record, _ in self._records():
            if record.op == bag_format.CONNECTION and record.end <= file.size:
                self._add_connection(record)
        self.lost = 0

    def sorted_connections(self) -> list[Connection]:
        """Return all connections in the order of their ids; those in chunks were found by then."""
        return with_known_types(sorted(self.connections.values(), key=lambda each: each.id))

    def _add_connection(self, record: Record) -> None:
        try:
            data = self._file.data(record)
            found = bag_format.unpack_connection(record.fields, data, self._file.path)
        except BagFormatError:
            return  # The chunk of its messages has it, too.
        self.connections[found.id] = found

    def chunks(self) -> Iterator[FoundChunk]:
        """Find all chunks with messages of known connections, in the order of the file."""
        for record, stop in self._records():
            if record.op == bag_format.CHUNK and (found := self._chunk(record, stop)):
                yield found

    def _chunk(self, record: Record, stop: int) -> FoundChunk | None:
        """Return a chunk, or what is left of it before ``stop``."""
        file = self._file
        place = f"{file.path}: chunk at byte {record.position}"
        try:
            method = bag_format.text(record.fields, "compression", place)
            size = bag_format.number(record.fields, "size", 4, place)
        except BagFormatError:
            method = ""
        if method not in compression.METHODS:
            self.lost += stop - record.position
            return None
        try:
            if stop != record.end:
                raise BagFormatError(f"{place}: not complete")
            data = file.data(record)
            plain = compression.decompress(data, method, size, place)
            messages, is_partial = bag_format.unpack_chunk(plain, place), False
        except BagFormatError:
            stop = self._stop_inside(record, stop)
            length = min(stop - record.data_position, compression.MAX_SIZE)
            data = file.read(record.data_position, length)
            plain = compression.decompress_start(data, method, place)
            messages = bag_format.unpack_chunk(plain, place, partial=True)
            is_partial = True
            self.lost += min(max(0, size - messages.size), file.size)
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

    def _stop_inside(self, record: Record, stop: int) -> int:
        """Return where the next chunk begins if a damaged one is too long: its length is wrong."""
        if stop == record.end and self._budget > 0:
            self._budget -= record.data_size
            following = self._next_chunk(record.data_position, stop)
            if following is not None:
                self._resume = stop = following
        return stop

    def _is_open(self, record: Record) -> bool:
        """Return whether a chunk's size was not known yet: its data ends where the file does."""
        return record.op == bag_format.CHUNK and not self._is_closed and record.data_size == 0

    def _records(self) -> Iterator[tuple[Record, int]]:
        """Yield the records of the file, each with the end of its data, which may be cut off."""
        file = self._file
        self.lost = 0
        position: int | None = len(bag_format.VERSION_LINE)
        while position is not None and position < file.size:
            try:
                record = file.record(position)
            except BagFormatError:
                following = self._next_chunk(position + 1, file.size)
                self.lost += (file.size if following is None else following) - position
                position = following
                continue
            if self._is_open(record):
                yield record, file.size
                return
            if record.end <= file.size:
                self._resume = record.end
                yield record, record.end
                position = self._resume
                continue
            position = self._next_chunk(record.data_position, file.size)
            stop = file.size if position is None else position
            yield record, stop
            if record.op != bag_format.CHUNK:
                self.lost += stop - record.position

    def _next_chunk(self, position: int, end: int) -> int | None:
        """Return where the next chunk begins before ``end``; None if there is none."""
        size = _SMALLEST_BLOCK
        while position < end:
            block = self._file.read(position, min(size, end - position))
            found = -1
            while (found := block.find(_COMPRESSION, found + 1)) >= 0:
                for before in _STARTS:
                    start = position + found - before
                    if start >= position and self._is_chunk(start):
                        return start
            if position + len(block) == end:
                return None
            position += len(block) - _OVERLAP
            size = min(2 * size, _LARGEST_BLOCK)
        return None

    def _is_chunk(self, position: int) -> bool:
        try:
            record = self._file.record(position)
            bag_format.number(record.fields, "size", 4, "")
        except BagFormatError:
            return False
        return record.op == bag_format.CHUNK
