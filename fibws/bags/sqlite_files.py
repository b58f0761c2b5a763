"""Reading .db3 files, in which rosbag2 records with SQLite: messages in CDR, a row for each."""

from __future__ import annotations

import os
import shutil
from array import array
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from fibws.bags.connection import ChunkInfo, Connection
from fibws.bags.reader import ChunkMessages, Reader
from fibws.errors import BagError, BagFormatError
from fibws.files import has_write_lock, lock_holder, wait_for_write_lock

if TYPE_CHECKING:
    import sqlite3

MAGIC = b"SQLite format 3\0"
SUFFIX = ".db3"
WAL, JOURNAL, MEMORY = "-wal", "-journal", "-shm"
"""The ends of the names of files beside a database: messages that are to be added to it, pages as
they were before changes that are not complete, and what programs share that have it open."""
CHUNK_SIZE, CHUNK_ROWS = 2**20, 1000
"""Bytes and messages that are read at once."""
MAX_TOPICS = 65_535
LOCKED = 0x4000_0002
"""A byte that SQLite locks, to write, while pages of a database are replaced."""
HEAD = 100
"""Bytes of a database's head."""
MOST_COPIES = 10
"""How often a file is copied that changes meanwhile."""
_NEVER = 2**63
T = TypeVar("T")


class _Rows(NamedTuple):
    """The rows of a chunk: the first and the last one."""

    first: int
    last: int


class SqliteReader(Reader):
    """Reads a .db3 file. Rows that follow each other are its chunks.

    It never locks the file: its recorder would fail. If a program has changed the file, a copy is
    read from then on, which has the same rows, as recorders only add some.

    Args:
        path: names the file in errors.
        file: a copy of it, which is read in its place, and removed when this is closed.
        notices: see `Reader`.

    Raises:
        BagFormatError: it is damaged, or not of rosbag2.
        OSError: it cannot be read.
    """

    def __init__(self, path: str, *, file: str = "", notices: Sequence[str] = ()) -> None:
        self.path, self.notices = path, tuple(notices)
        self.is_indexed = True
        self._copy = file
        self._unknown: Counter[int] = Counter()
        """How many messages have a topic that the file does not list, by its id."""
        self._state = () if file else _state(path)
        self._open(file or path)
        try:
            self._unchanged(self._read_all)
            if self._copy and not file and not notices:
                self.notices = (_being_written(path),)
        except BaseException:
            self.close()
            raise
        self.version = "rosbag2 sqlite3"

    @property
    def size(self) -> int:
        return self._size

    @property
    def counts(self) -> dict[int, int]:
        found: Counter[int] = Counter()
        for chunk in self.chunks:
            found.update(chunk.counts)
        return dict(found)

    def close(self) -> None:
        self._database.close()
        if self._copy:
            Path(self._copy).unlink(missing_ok=True)

    def _open(self, place: str) -> None:
        self._size = os.path.getsize(place)
        with errors_of(self.path):
            self._database = _connect(place, "mode=ro&immutable=1", self._size)

    def _unchanged(self, read: Callable[[], T]) -> T:
        """Return what a function reads: again, from a copy, if the file was changed meanwhile."""
        if not self._copy:
            with suppress(BagFormatError):
                found = read()
                if self._is_unchanged():
                    return found
            if not self._is_unchanged():
                copy = _copied(self.path)
                self._database.close()
                self._copy = copy
                self._open(copy)
        return read()

    def _is_unchanged(self) -> bool:
        return _state(self.path) == self._state and not has_write_lock(self.path, LOCKED)

    def _read_all(self) -> None:
        with errors_of(self.path):
            self._unknown.clear()
            self._check_tables()
            self.connections, self._ids = self._read_topics()
            self.chunks, self._rows = self._read_chunks()

    def _check_tables(self) -> None:
        """Check that the tables have rows, and do not compute them: a file may be made to harm."""
        for table in ("topics", "messages"):
            self._check_table(table)

    def _check_table(self, table: str) -> None:
        [kind] = self._read("SELECT type, sql FROM sqlite_master WHERE name = ?", table) or [None]
        if kind is None:
            raise BagFormatError(f"{self.path}: not of rosbag2: it has no table {table}")
        is_plain = kind[0] == "table" and str(kind[1]).upper().startswith("CREATE TABLE")
        columns = self._read(f"PRAGMA table_xinfo({table})")
        if not is_plain or any(column[6] for column in columns):
            raise BagFormatError(f"{self.path}: {table} must be a table without computed columns")

    def _read(self, query: str, *values: Any) -> list[Any]:
        return self._database.execute(query, values).fetchall()

    def _columns(self, table: str) -> set[str]:
        return {column[1] for column in self._read(f"PRAGMA table_xinfo({table})")}

    def _read_topics(self) -> tuple[list[Connection], dict[int, int]]:
        """Return the connections, and their ids by those of the file."""
        definitions = self._read_definitions()
        has_qos = "offered_qos_profiles" in self._columns("topics")
        qos = "offered_qos_profiles" if has_qos else "''"
        query = f"SELECT id, name, type, serialization_format, {qos} FROM topics ORDER BY id"
        connections: list[Connection] = []
        ids: dict[int, int] = {}
        for id_, *texts in self._database.execute(query):
            if not isinstance(id_, int) or not all(isinstance(text, str) for text in texts):
                raise BagFormatError(f"{self.path}: invalid row in the table topics")
            if len(connections) == MAX_TOPICS:
                raise BagFormatError(f"{self.path}: more than {MAX_TOPICS} topics")
            topic, type_, encoding, profiles = texts
            format_, definition = definitions.get(type_, ("", ""))
            ids[id_] = len(connections)
            connections.append(
                Connection(
                    id=len(connections),
                    topic=topic,
                    type=type_,
                    md5sum="",
                    definition=definition,
                    fields={
                        "message_definition": definition.encode(),
                        "offered_qos_profiles": profiles.encode(),
                    },
                    encoding=encoding,
                    definition_format=format_,
                )
            )
        return connections, ids

    def _read_definitions(self) -> dict[str, tuple[str, str]]:
        """Return the formats and texts of types; files of releases before Iron have none."""
        table = "message_definitions"
        if not self._read("SELECT 1 FROM sqlite_master WHERE name = ?", table):
            return {}
        self._check_table(table)
        rows = self._read(f"SELECT topic_type, encoding, encoded_message_definition FROM {table}")
        return {
            type_: (format_, text)
            for type_, format_, text in rows
            if isinstance(type_, str) and isinstance(format_, str) and isinstance(text, str)
            if text
        }

    def _read_chunks(self) -> tuple[list[ChunkInfo], dict[int, _Rows]]:
        """Return the chunks in the order of the file, and their rows by their positions."""
        chunks: list[ChunkInfo] = []
        rows: dict[int, _Rows] = {}
        begin, first, last = 0, 0, 0
        chunk = ChunkInfo(position=begin, start=_NEVER, end=0, counts={})
        count = 0

        def finish() -> None:
            if chunk.counts:
                chunk.compressed_size = chunk.size
                chunks.append(chunk)
                rows[chunk.position] = _Rows(first, last)

        columns = "rowid, topic_id, timestamp, length(data)"
        query = f"SELECT {columns} FROM messages NOT INDEXED ORDER BY rowid"
        for row, topic, time, size in self._database.execute(query):
            if not isinstance(time, int) or not 0 <= time < _NEVER or not isinstance(size, int):
                raise BagFormatError(f"{self.path}: invalid message in row {row}")
            id_ = self._ids.get(topic)
            if id_ is None:
                self._unknown[topic] += 1
                continue
            if count and (count == CHUNK_ROWS or chunk.size + size > CHUNK_SIZE):
                finish()
                begin += chunk.size + 1
                chunk = ChunkInfo(position=begin, start=_NEVER, end=0, counts={})
                count = 0
            if not count:
                first = row
            last = row
            count += 1
            chunk.counts[id_] = chunk.counts.get(id_, 0) + 1
            chunk.start, chunk.end = min(chunk.start, time), max(chunk.end, time)
            chunk.size += size
        finish()
        return chunks, rows

    def _unpack_chunk(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        return self._unchanged(lambda: self._unpack(chunk, wanted))

    def _unpack(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        times, ids, places = array("Q"), array("Q"), array("q")
        begins, ends = array("Q"), array("Q")
        data = bytearray()
        with errors_of(self.path):
            for row, id_, time, content in self._select(chunk, wanted, "data"):
                if not isinstance(content, bytes):
                    raise BagFormatError(f"{self.path}: invalid message in row {row}")
                times.append(time)
                ids.append(id_)
                places.append(row)
                begins.append(len(data))
                data += content
                ends.append(len(data))
        return ChunkMessages(bytes(data), times, ids, places, begins, ends)

    def _chunk_times(self, chunk: ChunkInfo, wanted: Collection[int]) -> list[int]:
        def read() -> list[int]:
            with errors_of(self.path):
                return [time for _, _, time, _ in self._select(chunk, wanted, "0")]

        return self._unchanged(read)

    def _select(
        self, chunk: ChunkInfo, wanted: Collection[int] | None, column: str
    ) -> Iterator[tuple[int, int, int, Any]]:
        """Read the rows of a chunk: their numbers, connections, times and a column."""
        topics = {topic: id_ for topic, id_ in self._ids.items() if wanted is None or id_ in wanted}
        query = (
            f"SELECT rowid, topic_id, timestamp, {column} FROM messages NOT INDEXED "
            f"WHERE rowid BETWEEN ? AND ? AND topic_id IN ({', '.join(map(str, topics))}) "
            "ORDER BY rowid"
        )
        for row, topic, time, value in self._database.execute(query, self._rows[chunk.position]):
            yield row, topics[topic], time, value

    def _index_faults(self) -> Iterator[str]:
        def read() -> list[Any]:
            with errors_of(self.path):
                return self._read("PRAGMA integrity_check(20)")

        for (text,) in self._unchanged(read):
            if text != "ok":
                yield " ".join(str(text).split())
        for topic, count in self._unknown.items():
            yield f"messages of the topic {topic}, which the file does not list: {count}"


@contextmanager
def errors_of(path: str) -> Iterator[None]:
    """Turn errors of SQLite into a BagFormatError that names a file."""
    import sqlite3

    try:
        yield
    except (sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
        raise BagFormatError(f"{path}: {error}") from None


def is_sqlite(path: str) -> bool:
    """Return whether a file is one of SQLite; raise OSError if it cannot be read.

    The name decides, too: a .db3 file that does not begin as one of SQLite is damaged.
    """
    with open(path, "rb") as file:
        return file.read(len(MAGIC)) == MAGIC or path.endswith(SUFFIX)


def open_sqlite(path: str) -> SqliteReader:
    """Open a .db3 file for reading; raise as `SqliteReader`.

    What is beside a file that was not closed belongs to the program that writes it, or to the next
    one that opens it: the file is copied then, together with that.
    """
    writer = lock_holder(path, "POSIX")
    beside = _beside(path)
    if writer:
        notices = [f"{path} is open in {writer}, which may still write it: it is read as it is now"]
    else:
        notices = [f"{path} was not closed by its recorder; {each} is read, too" for each in beside]
    if not beside:
        return SqliteReader(path, notices=notices)
    copy = _copied(path)
    try:
        return SqliteReader(path, file=copy, notices=notices)
    except BaseException:
        with suppress(FileNotFoundError):
            os.unlink(copy)
        raise


def _has_content(path: str) -> bool:
    return os.path.isfile(path) and os.path.getsize(path) > 0


def _beside(path: str) -> list[str]:
    """Return the files beside a database that belong to it."""
    return [path + end for end in (WAL, JOURNAL) if _has_content(path + end)]


def _being_written(path: str) -> str:
    return f"{path} is being written: it is read as it is now"


def _state(path: str) -> tuple[Any, ...]:
    """Return what changes whenever a program changes a database, or what is beside it.

    Raises:
        OSError: it cannot be read.
    """
    found: list[Any] = []
    for each in (path, path + WAL, path + JOURNAL):
        try:
            info = os.stat(each)
        except FileNotFoundError:
            found.append(None)
        else:
            found.append((info.st_ino, info.st_size, info.st_mtime_ns))
    with open(path, "rb") as file:
        found.append(file.read(HEAD))  # It has a counter of changes.
    return tuple(found)


def _copied(path: str) -> str:
    """Return the path of a copy of a file, with what is beside it, in a single file.

    Raises:
        BagFormatError: it is damaged.
        BagError: a program changes it all the time.
        OSError: it cannot be read, or the copy cannot be written.
    """
    import sqlite3
    from tempfile import TemporaryDirectory, mkstemp

    descriptor, copy = mkstemp(suffix=SUFFIX)
    os.close(descriptor)
    try:
        with errors_of(path), TemporaryDirectory() as folder:
            size = sum(map(os.path.getsize, [path, *_beside(path)]))
            if os.path.exists(path + MEMORY):
                # Programs that have the file open share this: SQLite copies all of one moment.
                with suppress(sqlite3.Error), closing(_connect(path, "mode=ro", size)) as source:
                    with closing(_connect(copy, "mode=rw", size)) as target:
                        source.backup(target)
                    return _in_one_file(copy, size)
            for _ in range(MOST_COPIES):
                if place := _copy_of_one_moment(path, folder):
                    shutil.move(_in_one_file(place, size), copy)
                    return copy
        raise BagError(f"{path} is being written; try again in a while")
    except BaseException:
        os.unlink(copy)
        raise


def _copy_of_one_moment(path: str, folder: str) -> str:
    """Copy a file, and what is beside it, to a folder.

    Returns:
        The copy's path; empty if a program has changed the file meanwhile.
    """
    state, beside = _state(path), _beside(path)
    # Without a journal, only the program's memory can take back what is not yet complete.
    if not beside and not wait_for_write_lock(path, LOCKED):
        return ""
    with suppress(FileNotFoundError):
        for end in ("", WAL, JOURNAL):
            place = os.path.join(folder, os.path.basename(path) + end)
            Path(place).unlink(missing_ok=True)
            if not end or path + end in beside:
                shutil.copyfile(path + end, place)
        if _state(path) == state and (beside or not has_write_lock(path, LOCKED)):
            return os.path.join(folder, os.path.basename(path))
    return ""


def _in_one_file(path: str, size: int) -> str:
    """Move to a database what is beside it; return its path."""
    with closing(_connect(path, "mode=rw", size)) as database:
        database.execute("PRAGMA journal_mode = DELETE").fetchall()
    return path


def _connect(path: str, mode: str, size: int) -> sqlite3.Connection:
    """Open a database, in any thread.

    Args:
        mode: parameters of the address.
        size: of the file, in bytes.
    """
    import sqlite3

    address = f"{Path(os.path.abspath(path)).as_uri()}?{mode}"
    database = sqlite3.connect(address, uri=True, check_same_thread=False)
    # A file may be made to harm: no value is larger than the file, and no text runs programs.
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, max(size, 2**20))
    database.execute("PRAGMA trusted_schema = OFF")
    return database
