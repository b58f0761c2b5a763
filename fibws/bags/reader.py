"""The base of the readers of all formats: messages in the order of time."""

from __future__ import annotations

import heapq
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from types import MappingProxyType, TracebackType
from typing import IO, NamedTuple, Self, TypeAlias

from fibws.bags.compression import MAX_RATIO
from fibws.bags.connection import ChunkInfo, Connection
from fibws.errors import BagFormatError, ChunkDamaged

MAX_MEMORY = 32 * 2**20
"""How many bytes of uncompressed chunks are kept in memory; more are in a temporary file."""
MAX_FILE = 4 * 2**30
"""Maximum size of the temporary file, unless `MAX_RATIO` times the bag is more."""

YEAR = 31_557_600 * 10**9
"""In ns."""
MAX_GAP = 10 * YEAR
"""Messages that are further apart have times of different clocks."""

Message: TypeAlias = tuple[Connection, int, bytes]
"""A message: its connection, its time in ns and its serialized data."""
LocatedMessage: TypeAlias = tuple[Connection, int, bytes, tuple[int, int]]
"""A message with its place: the position of its chunk, and that in the uncompressed chunk."""


class ChunkMessages(NamedTuple):
    """The messages of a chunk: numbers of the same length, in the order of the file."""

    data: bytes
    times: Sequence[int]
    """In ns."""
    ids: Sequence[int]
    """The connections."""
    places: Sequence[int]
    """Where the records of messages begin in the data."""
    begins: Sequence[int]
    """Where the serialized messages begin in the data."""
    ends: Sequence[int]


class Reader(ABC):
    """Reads a bag that has an index.

    Attributes:
        path: names the file in errors.
        version: the format's, such as ``2.0``.
        connections: in the order of their ids.
        chunks: in the order of the file.
        is_indexed: whether the file has an index; if not, all of it was read to make one.
    """

    path: str
    version: str
    connections: list[Connection]
    chunks: list[ChunkInfo]
    is_indexed: bool
    mended: Sequence[Connection] = ()
    """The connections whose type the file does not say; see `with_known_types`."""
    not_converted: Mapping[int, str] = MappingProxyType({})
    """Why connections are not in the encoding that was asked for, by their ids."""
    differences: Sequence[str] = ()
    """How types that were converted differ from those of the same names in ROS 1."""
    others: int = 0
    """The number of attachments and metadata records in the file."""
    notices: Sequence[str] = ()
    """Warnings for users: the file is being written, or was not closed."""

    @property
    @abstractmethod
    def size(self) -> int:
        """The size of the file in bytes."""

    @property
    @abstractmethod
    def counts(self) -> dict[int, int]:
        """The number of messages of each connection that has some."""

    @abstractmethod
    def _unpack_chunk(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        """Return a chunk's messages of these connections; all if None."""

    def _chunk_times(self, chunk: ChunkInfo, wanted: Collection[int]) -> Iterable[int]:
        """Return the times of a chunk's messages of these connections."""
        return self._unpack_chunk(chunk, wanted).times

    @abstractmethod
    def _index_faults(self) -> Iterator[str]:
        """Compare the index with what is in the file, which has to have one."""

    def faults(self) -> Iterator[str]:
        """Read the whole file, and say where its parts do not agree, or a time is implausible.

        Raises:
            BagFormatError: a part is damaged.
            UnsupportedBag: as `messages`.
        """
        for each in self.mended:
            yield f"connection {each.id} of {each.topic} has no type; reindex writes that of others"
        yield from self._index_faults()
        previous: int | None = None
        without_time: Counter[str] = Counter()
        for connection, time, _ in self.messages():
            if not time:
                without_time[connection.topic] += 1
            elif previous is not None and time - previous > MAX_GAP:
                years = (time - previous) / YEAR
                yield (
                    f"the message of {connection.topic} at {time / 1e9:.3f} s is {years:.1f} years "
                    "later than the one before"
                )
            previous = time or previous
        for topic, count in without_time.items():
            yield f"{topic} has messages with the time 0: {count}"

    @abstractmethod
    def close(self) -> None:
        """Close the file."""

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
    def start(self) -> int:
        """The time of the first message in ns; 0 in an empty bag."""
        return min((chunk.start for chunk in self.chunks), default=0)

    @property
    def end(self) -> int:
        """The time of the last message in ns; 0 in an empty bag."""
        return max((chunk.end for chunk in self.chunks), default=0)

    @property
    def message_count(self) -> int:
        """The number of messages."""
        return sum(self.counts.values())

    @property
    def compression(self) -> str:
        """The compression of most chunks: ``none``, ``bz2``, ``lz4`` or ``zstd``."""
        counts = Counter(chunk.compression for chunk in self.chunks)
        return max(counts, key=lambda method: (counts[method], method), default="none")

    def messages(
        self,
        topics: Collection[str] | None = None,
        start: int | None = None,
        end: int | None = None,
        *,
        connections: Collection[Connection] | None = None,
    ) -> Iterator[Message]:
        """Read messages in the order of their times; those of one time in that of the file.

        Args:
            topics: only messages of these.
            start: only messages of this time (ns) and later.
            end: only messages of this time (ns) and earlier.
            connections: only messages of these.

        Raises:
            BagFormatError: a chunk is damaged.
            UnsupportedBag: a chunk's compression is unknown, or its package is not installed.
        """
        return (
            message[:3]
            for message in self.located_messages(topics, start, end, connections=connections)
        )

    def located_messages(
        self,
        topics: Collection[str] | None = None,
        start: int | None = None,
        end: int | None = None,
        *,
        connections: Collection[Connection] | None = None,
    ) -> Iterator[LocatedMessage]:
        """Do the same as `messages`, and yield the place of each message in the file, too.

        That is the position of its chunk, and that of its record in the uncompressed chunk.
        """
        wanted = {
            each.id: each
            for each in (self.connections if connections is None else connections)
            if topics is None or each.topic in topics
        }
        chunks = [
            chunk
            for chunk in self.chunks
            if (end is None or chunk.start <= end)
            and (start is None or chunk.end >= start)
            and not wanted.keys().isdisjoint(chunk.counts)
        ]
        chunks.sort(key=lambda chunk: chunk.start, reverse=True)
        return self._merge(chunks, wanted, start or 0, end)

    def times(self, connections: Collection[Connection]) -> list[int]:
        """Return the sorted times (ns) of all messages of some connections."""
        wanted = {each.id for each in connections}
        found: list[int] = []
        for chunk in self.chunks:
            if not wanted.isdisjoint(chunk.counts):
                found += self._chunk_times(chunk, wanted)
        return sorted(found)

    def _merge(
        self,
        chunks: list[ChunkInfo],
        wanted: dict[int, Connection],
        start: int,
        end: int | None,
    ) -> Iterator[LocatedMessage]:
        """Read chunks, which are sorted from the last to the first, while their times overlap."""
        with _Memory(self.path, max(MAX_FILE, MAX_RATIO * self.size)) as memory:
            cursors: list[tuple[int, int, _Cursor]] = []
            while chunks or cursors:
                while chunks and (not cursors or chunks[-1].start <= cursors[0][0]):
                    chunk = chunks.pop()
                    cursor = _Cursor(self._unpack_chunk(chunk, wanted), start)
                    if cursor.time is not None:
                        memory.add(cursor)
                        heapq.heappush(cursors, (cursor.time, chunk.position, cursor))
                if not cursors:
                    continue
                _, position, cursor = heapq.heappop(cursors)
                # All that comes before the first message of any other chunk.
                limit = min(
                    cursors[0][:2] if cursors else (_NEVER, 0),
                    (chunks[-1].start, -1) if chunks else (_NEVER, 0),
                )
                while (time := cursor.time) is not None and (time, position) < limit:
                    if end is not None and time > end:
                        return
                    id_, data, place = cursor.take()
                    yield wanted[id_], time, data, (position, place)
                if time is None:
                    memory.remove(cursor)
                else:
                    heapq.heappush(cursors, (time, position, cursor))


@contextmanager
def advice(path: str) -> Iterator[None]:
    """Have the errors of a damaged chunk say how the others are restored."""
    try:
        yield
    except BagFormatError as error:
        raise ChunkDamaged(path, str(error)) from None


def in_file_order(chunks: Iterable[ChunkInfo]) -> list[ChunkInfo]:
    """Return the chunks that an index lists in the order of the file.

    Raises:
        BagFormatError: chunks overlap: a small file would be read any number of times.
    """
    found = sorted(chunks, key=lambda chunk: chunk.position)
    for chunk, following in pairwise(found):
        if following.position < chunk.position + max(1, chunk.compressed_size):
            raise BagFormatError(
                f"the chunks at bytes {chunk.position} and {following.position} overlap"
            )
    return found


def chunk_faults(chunk: ChunkInfo, found: ChunkMessages, known: Collection[int]) -> Iterator[str]:
    """Compare what the index says of a chunk with its messages.

    Args:
        found: all messages of the chunk.
        known: the connections that the index lists.
    """
    place = f"chunk at byte {chunk.position}"
    counts = Counter(found.ids)
    if unknown := sorted(counts.keys() - set(known)):
        yield f"{place}: messages of connections that the index does not list: {unknown}"
    for id_ in sorted(counts.keys() | chunk.counts.keys()):
        listed = chunk.counts.get(id_)
        # The index may say 0 for a number that it does not know.
        if listed is None or not (listed == counts[id_] or (listed == 0 and counts[id_])):
            yield f"{place}: connection {id_} has {counts[id_]} messages, the index says {listed}"
    if found.times and (min(found.times), max(found.times)) != (chunk.start, chunk.end):
        yield f"{place}: the index says other times of its first and last message"


def entry_faults(
    chunk: ChunkInfo, found: ChunkMessages, entries: Mapping[int, list[tuple[int, int]]]
) -> Iterator[str]:
    """Compare the places of messages in a chunk with those in its index.

    Args:
        found: all messages of the chunk.
        entries: the times and places of messages, by connection.
    """
    there: dict[int, list[tuple[int, int]]] = {}
    for time, id_, position in zip(found.times, found.ids, found.places, strict=True):
        there.setdefault(id_, []).append((time, position))
    for id_ in sorted(there.keys() | entries.keys()):
        if sorted(there.get(id_, ())) != sorted(entries.get(id_, ())):
            yield (
                f"chunk at byte {chunk.position}: the index of connection {id_} says other times "
                "or places of its messages"
            )


_NEVER = 2**64


class _Cursor:
    """The messages of a chunk that have not been read so far."""

    def __init__(self, messages: ChunkMessages, start: int) -> None:
        _, times, self._ids, self._places, self._begins, self._ends = messages
        self.data: bytes | None = messages.data
        self.size = len(messages.data)
        self.file: IO[bytes] | None = None
        self.offset = 0
        self._times = times
        order: Sequence[int] = range(len(times))
        if any(map(int.__gt__, times[:-1], times[1:])):
            order = sorted(order, key=times.__getitem__)
        self._order = iter(order)
        self._advance()
        while self.time is not None and self.time < start:
            self._advance()

    def _advance(self) -> None:
        self._next = next(self._order, -1)
        self.time: int | None = None if self._next < 0 else self._times[self._next]

    def take(self) -> tuple[int, bytes, int]:
        """Return the connection's id, the data and the place of the next message, and go on.

        It has the time `time`, which is None at the end.
        """
        number = self._next
        begin, end = self._begins[number], self._ends[number]
        if self.data is not None:
            data = self.data[begin:end]
        else:
            assert self.file is not None
            self.file.seek(self.offset + begin)
            data = self.file.read(end - begin)
        self._advance()
        return self._ids[number], data, self._places[number]


class _Memory:
    """The uncompressed chunks of messages to come, in memory or in a temporary file.

    Args:
        path: names the bag in errors.
        limit: maximum size of the temporary file.
    """

    def __init__(self, path: str, limit: int) -> None:
        self._path = path
        self._limit = limit
        self._cursors: list[_Cursor] = []
        self._file: IO[bytes] | None = None
        self._moved = 0
        """The bytes in the file of chunks that have messages to come."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._file is not None:
            self._file.close()

    def add(self, cursor: _Cursor) -> None:
        """Keep a chunk; if there are too many, move older ones to the file."""
        self._cursors.append(cursor)
        size = sum(each.size for each in self._cursors)
        for each in self._cursors[:-1]:
            if size <= MAX_MEMORY:
                break
            size -= each.size
            self._move(each)

    def remove(self, cursor: _Cursor) -> None:
        """Forget a chunk, all of whose messages have been read."""
        if cursor.file is None:
            self._cursors.remove(cursor)
            return
        self._moved -= cursor.size
        if not self._moved:
            cursor.file.truncate(0)

    def _move(self, cursor: _Cursor) -> None:
        assert cursor.data is not None
        if self._file is None:
            import tempfile

            self._file = tempfile.TemporaryFile()
        cursor.file, cursor.offset = self._file, self._file.seek(0, 2)
        if cursor.offset + cursor.size > self._limit:
            raise BagFormatError(
                f"{self._path}: chunks that overlap in time have more than {self._limit} bytes "
                "uncompressed"
            )
        self._moved += cursor.size
        self._file.write(cursor.data)
        cursor.data = None
        self._cursors.remove(cursor)
