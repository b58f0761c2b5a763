"""Folders of rosbag2: .mcap or .db3 files with a metadata.yaml, maybe compressed by zstd.

The files are read as one bag. A folder whose recorder has ended before it wrote metadata.yaml is
read, too.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Collection, Iterable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import replace
from typing import Any, BinaryIO, NamedTuple, cast

from fibws.bags import compression
from fibws.bags.connection import ChunkInfo, Connection
from fibws.bags.mcap_files import McapReader
from fibws.bags.reader import MAX_FILE, ChunkMessages, Reader
from fibws.bags.sqlite_files import MAGIC, SqliteReader, is_sqlite, open_sqlite
from fibws.bags.sqlite_files import SUFFIX as SQLITE_SUFFIX
from fibws.bags.transformed_reader import TransformedReader
from fibws.errors import BagError, BagFormatError, UnsupportedBag

METADATA = "metadata.yaml"
MAX_METADATA = 16 * 2**20
"""Maximum size of metadata.yaml, in bytes."""
MCAP_SUFFIX = ".mcap"
STORAGES = ("mcap", "sqlite3")
SUFFIXES = tuple(f"{each}{end}" for each in (MCAP_SUFFIX, SQLITE_SUFFIX) for end in ("", ".zstd"))
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
_STEP = 2**20


def open_folder(path: str, *, allow_unindexed: bool = False) -> Reader:
    """Open a folder of rosbag2 for reading; raise as `fibws.bags.open_reader`."""
    metadata = _read_metadata(path)
    names = metadata.files or listed(path)
    if not names:
        bags = _bags(path)
        hint = f"; name a file in it, such as {os.path.join(path, bags[0])}" if bags else ""
        raise BagFormatError(f"{path}: a folder without .mcap or .db3 files{hint}")
    with ExitStack() as stack:
        readers = []
        for name in names:
            place = os.path.join(path, name)
            reader = open_storage(place, allow_unindexed=allow_unindexed)
            readers.append(stack.enter_context(reader))
        stack.pop_all()
    found = readers[0] if len(readers) == 1 else CombinedReader(path, readers)
    if left := [] if metadata.files else _bags(path):
        first = os.path.join(path, left[0])
        notice = (
            f"{path}: a folder is read as a recording of ROS 2, without .bag files such as {first}"
        )
        found.notices = (*found.notices, notice)
    return UnpackingReader(found) if metadata.has_compressed_messages else found


def open_file(path: str, *, allow_unindexed: bool = False) -> Reader:
    """Open a .mcap or .db3 file, which may be one of such a folder; raise as `open_folder`."""
    reader = open_storage(path, allow_unindexed=allow_unindexed)
    try:
        metadata = _read_metadata(os.path.dirname(path) or ".")
    except (BagError, OSError):
        return reader  # It may be of another recording.
    packed = metadata.has_compressed_messages and os.path.basename(path) in metadata.files
    return UnpackingReader(reader) if packed else reader


def open_storage(path: str, *, allow_unindexed: bool = False) -> Reader:
    """Open a .mcap or .db3 file, or one that is compressed as a whole, for reading."""
    check_not_empty(path)
    if not is_zstd(path):
        if is_sqlite(path):
            return open_sqlite(path)
        return McapReader(path, allow_unindexed=allow_unindexed)
    file = _decompressed(path)
    try:
        file.seek(0)
        if file.read(len(MAGIC)) != MAGIC:
            return McapReader(path, allow_unindexed=allow_unindexed, file=file)
        copy = _named_copy(file)
        try:
            return SqliteReader(path, file=copy)
        except BaseException:
            with suppress(FileNotFoundError):
                os.unlink(copy)
            raise
    except BaseException:
        file.close()
        raise


def _named_copy(file: BinaryIO) -> str:
    """Close a temporary file; return the path of a copy of it, as SQLite opens no other files."""
    from tempfile import mkstemp

    descriptor, path = mkstemp(suffix=SQLITE_SUFFIX)
    try:
        with file, open(descriptor, "wb") as copy:
            file.seek(0)
            shutil.copyfileobj(file, copy)
    except BaseException:
        os.unlink(path)
        raise
    return path


def check_not_empty(path: str) -> None:
    """Raise BagFormatError if a file is empty, and OSError if it does not exist."""
    if not os.path.getsize(path) and os.path.isfile(path):
        raise BagFormatError(f"{path}: the file is empty")


def is_zstd(path: str) -> bool:
    """Return whether a file is compressed by zstd; raise OSError if it cannot be read."""
    with open(path, "rb") as file:
        return file.read(len(ZSTD_MAGIC)) == ZSTD_MAGIC


class _Metadata(NamedTuple):
    """What metadata.yaml says.

    Attributes:
        files: the names of the files; empty if there is no metadata.yaml.
        has_compressed_messages: whether each message is compressed on its own.
    """

    files: list[str]
    has_compressed_messages: bool


def _read_metadata(path: str) -> _Metadata:
    place = os.path.join(path, METADATA)
    if not os.path.exists(place):
        return _Metadata([], has_compressed_messages=False)
    found = _information(place)
    storage = _text(found, "storage_identifier", place) or "mcap"
    if storage not in STORAGES:
        known = " or ".join(STORAGES)
        raise UnsupportedBag(
            f"{path}: recorded in {storage}, which is not read; expected {known}", "format"
        )
    files = found.get("relative_file_paths") or []
    if not isinstance(files, list) or not all(isinstance(each, str) for each in files):
        raise BagFormatError(f"{place}: relative_file_paths must be a list of names")
    # Some releases wrote the folder's name before those of the files.
    names = list(dict.fromkeys(map(os.path.basename, files)))
    mode = _text(found, "compression_mode", place).upper()
    format_ = _text(found, "compression_format", place)
    if mode == "MESSAGE" and format_ != "zstd":
        raise UnsupportedBag(f"{path}: unknown compression {format_!r}", "compression")
    return _Metadata(names, has_compressed_messages=mode == "MESSAGE")


def _text(information: dict[str, Any], name: str, place: str) -> str:
    """Return a text in metadata.yaml; empty if there is none."""
    value = information.get(name)
    if value is not None and not isinstance(value, str):
        raise BagFormatError(f"{place}: {name} must be a text")
    return value or ""


def _information(place: str) -> dict[str, Any]:
    """Return the content of a metadata.yaml."""
    import yaml

    if os.path.getsize(place) > MAX_METADATA:
        raise BagFormatError(f"{place}: more than {MAX_METADATA // 2**20} MiB")
    with open(place, "rb") as file:
        content = file.read()
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        found = yaml.load(content, loader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        fault = str(error).partition("\n")[0]
        raise BagFormatError(f"{place}: invalid YAML ({fault})") from None
    found = found.get("rosbag2_bagfile_information") if isinstance(found, dict) else None
    if not isinstance(found, dict):
        raise BagFormatError(f"{place}: rosbag2_bagfile_information is missing")
    return found


def _bags(path: str) -> list[str]:
    """Return the names of the .bag files in a folder."""
    return sorted(each for each in os.listdir(path) if each.endswith(".bag"))


def listed(path: str) -> list[str]:
    """Return the names of the .mcap and .db3 files in a folder.

    Originals that were kept when a file was rewritten have the same messages: they are left out.
    """
    names = {each for each in os.listdir(path) if each.endswith(SUFFIXES)}
    return sorted(each for each in names if ".orig." not in each or not _is_rewritten(each, names))


def _is_rewritten(name: str, names: Collection[str]) -> bool:
    """Return whether a file such as ``walk.orig.mcap`` is the original of one of these."""
    return "".join(name.rsplit(".orig", 1)) in names


def _decompressed(path: str) -> BinaryIO:
    """Return a temporary file with the content of one that is compressed by zstd.

    Raises:
        BagFormatError: it is damaged, or decompresses to too much.
        UnsupportedBag: the package zstandard is not installed.
    """
    from tempfile import TemporaryFile  # Few need it.

    zstandard = compression.zstandard(path)
    limit = max(MAX_FILE, compression.MAX_RATIO * os.path.getsize(path))
    file = cast(BinaryIO, TemporaryFile())
    try:
        with open(path, "rb") as packed:
            decompressor = zstandard.ZstdDecompressor()
            with decompressor.stream_reader(packed, read_across_frames=True) as source:
                while part := source.read(_STEP):
                    file.write(part)
                    if file.tell() > limit:
                        raise BagFormatError(f"{path}: decompresses to more than {limit} bytes")
    except zstandard.ZstdError as error:
        file.close()
        raise BagFormatError(f"{path}: invalid zstd data ({error})") from None
    except BaseException:
        file.close()
        raise
    return file


class CombinedReader(Reader):
    """Reads several files as one bag.

    Args:
        path: names them in errors.
        readers: of the files, which are closed with this one.
    """

    def __init__(self, path: str, readers: Collection[Reader]) -> None:
        self.path = path
        self._readers = list(readers)
        self.version = self._readers[0].version
        self.is_indexed = all(each.is_indexed for each in readers)
        self.notices = [notice for each in readers for notice in each.notices]
        self.connections = []
        self.chunks = []
        self._ids: list[dict[int, int]] = []
        """The ids here of the connections of each reader."""
        self._chunks: dict[int, tuple[int, ChunkInfo]] = {}
        """The number of the reader, and its chunk, by the position of the chunk here."""
        known: dict[tuple[Any, ...], int] = {}
        begin = 0
        for number, reader in enumerate(self._readers):
            self._ids.append({each.id: self._add(each, known) for each in reader.connections})
            for chunk in reader.chunks:
                own = replace(
                    chunk,
                    position=begin + chunk.position,
                    counts=self._renumbered(number, chunk.counts.items()),
                )
                self._chunks[own.position] = number, chunk
                self.chunks.append(own)
            begin += reader.size
        self.mended = [
            replace(each, id=self._ids[number][each.id])
            for number, reader in enumerate(self._readers)
            for each in reader.mended
        ]

    def _add(self, connection: Connection, known: dict[tuple[Any, ...], int]) -> int:
        """Return the id of a connection, which several files may have."""
        fields = tuple(sorted(connection.fields.items()))
        key = (*(connection.topic, connection.type, connection.encoding), fields)
        if key not in known:
            known[key] = len(self.connections)
            self.connections.append(replace(connection, id=known[key]))
        return known[key]

    def _renumbered(self, number: int, counts: Iterable[tuple[int, int]]) -> dict[int, int]:
        found: dict[int, int] = {}
        for id_, count in counts:
            if (own := self._ids[number].get(id_)) is not None:
                found[own] = found.get(own, 0) + count
        return found

    @property
    def size(self) -> int:
        return sum(each.size for each in self._readers)

    @property
    def counts(self) -> dict[int, int]:
        found: dict[int, int] = {}
        for number, reader in enumerate(self._readers):
            for id_, count in self._renumbered(number, reader.counts.items()).items():
                found[id_] = found.get(id_, 0) + count
        return found

    def close(self) -> None:
        for each in self._readers:
            each.close()

    def _unpack_chunk(self, chunk: ChunkInfo, wanted: Collection[int] | None) -> ChunkMessages:
        number, own = self._chunks[chunk.position]
        ids = self._ids[number]
        theirs = {id_ for id_, here in ids.items() if wanted is None or here in wanted}
        found = self._readers[number]._unpack_chunk(own, theirs)
        return found._replace(ids=[ids[id_] for id_ in found.ids])

    def _index_faults(self) -> Iterator[str]:
        for each in self._readers:
            name = os.path.basename(each.path)
            yield from (f"{name}: {fault}" for fault in each._index_faults())


class UnpackingReader(TransformedReader):
    """Reads a bag each of whose messages is compressed by zstd."""

    def _transform(self, connection: Connection, data: bytes) -> bytes:
        place = f"{self.path}: message on {connection.topic}"
        return compression.decompress_all(data, "zstd", place)
