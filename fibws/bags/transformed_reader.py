"""A reader that changes the messages of another one."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterable, Iterator

from fibws.bags.connection import ChunkInfo, Connection
from fibws.bags.reader import ChunkMessages, LocatedMessage, Reader


class TransformedReader(Reader):
    """Reads a bag with changed messages.

    Args:
        reader: the bag's, which is closed with this one.
    """

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self.path, self.version, self.mended = reader.path, reader.version, reader.mended
        self.connections, self.chunks = reader.connections, reader.chunks
        self.is_indexed, self.notices = reader.is_indexed, reader.notices

    @abstractmethod
    def _transform(self, connection: Connection, data: bytes) -> bytes:
        """Return the new bytes of a message; raise BagFormatError if it is invalid."""

    @property
    def size(self) -> int:
        return self._reader.size

    @property
    def counts(self) -> dict[int, int]:
        return self._reader.counts

    def close(self) -> None:
        self._reader.close()

    def located_messages(
        self,
        topics: Collection[str] | None = None,
        start: int | None = None,
        end: int | None = None,
        *,
        connections: Collection[Connection] | None = None,
    ) -> Iterator[LocatedMessage]:
        """Read messages as `Reader.located_messages`, and change them."""
        own = {each.id: each for each in self.connections}
        wanted = None
        if connections is not None:
            ids = {each.id for each in connections}
            wanted = [each for each in self._reader.connections if each.id in ids]
        for found, time, data, place in self._reader.located_messages(
            topics, start, end, connections=wanted
        ):
            connection = own[found.id]
            yield connection, time, self._transform(connection, data), place

    def _unpack_chunk(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        return self._reader._unpack_chunk(chunk, wanted)

    def _chunk_times(self, chunk: ChunkInfo, wanted: Collection[int]) -> Iterable[int]:
        return self._reader._chunk_times(chunk, wanted)

    def _index_faults(self) -> Iterator[str]:
        return self._reader._index_faults()
