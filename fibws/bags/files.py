"""The reader or the writer for a bag: by its content, or by the suffix of its name."""

from __future__ import annotations

import os
from typing import TypeAlias

from fibws.bags import mcap_files
from fibws.bags.bag_reader import BagReader
from fibws.bags.bag_writer import CHUNK_SIZE, BagWriter
from fibws.bags.compression import check_method
from fibws.bags.mcap_files import MAGIC, McapWriter
from fibws.bags.reader import Reader
from fibws.bags.rosbag2 import MCAP_SUFFIX, check_not_empty, is_zstd, open_file, open_folder
from fibws.bags.sqlite_files import is_sqlite
from fibws.errors import BagNotIndexed
from fibws.files import check_not_written

Writer: TypeAlias = BagWriter | McapWriter


def open_reader(path: str | os.PathLike[str], *, allow_unindexed: bool = False) -> Reader:
    """Open a bag for reading: a file, or a folder of rosbag2.

    Args:
        path: a .bag, .mcap or .db3 file, also one that zstd has compressed as a whole, or a
            folder.
        allow_unindexed: whether a bag without an index is read as a whole to make one.

    Raises:
        BagFormatError: it is damaged, or not a bag.
        BagNotIndexed: it has no index.
        UnsupportedBag: its version is not supported, it is encrypted, or a package is missing.
        OSError: it cannot be read.
    """
    path = os.fspath(path)
    try:
        if os.path.isdir(path):
            return open_folder(path, allow_unindexed=allow_unindexed)
        check_not_empty(path)
        if is_mcap(path) or is_sqlite(path) or is_zstd(path):
            return open_file(path, allow_unindexed=allow_unindexed)
        return BagReader(path, allow_unindexed=allow_unindexed)
    except BagNotIndexed as error:
        try:
            check_not_written(error.path)
        except BlockingIOError as writer:
            raise BagNotIndexed(error.path, writer=str(writer.strerror)) from None
        raise


def open_writer(
    path: str | os.PathLike[str],
    compression: str = "none",
    chunk_size: int = CHUNK_SIZE,
    *,
    profile: str = "ros1",
    name: str | os.PathLike[str] = "",
) -> Writer:
    """Open a bag for writing: an MCAP file if the name ends in .mcap or .mcap.active.

    Args:
        compression: ``none``, ``lz4``, or ``bz2`` for .bag, ``zstd`` for .mcap.
        chunk_size: how many bytes, uncompressed, end a chunk.
        profile: of an MCAP file; see `McapWriter`.
        name: names the file in errors, if it is written under another name.

    Raises:
        BagError: an invalid compression.
        UnsupportedBag: a package is not installed.
        OSError: the file cannot be written.
    """
    path, name = os.fspath(path), os.fspath(name)
    if path.removesuffix(".active").endswith(MCAP_SUFFIX):
        return McapWriter(path, compression, chunk_size, profile=profile, name=name)
    writer = BagWriter(path, compression, chunk_size)
    writer.path = name or path
    return writer


def check_writer(name: str, compression: str) -> None:
    """Check that a bag of a name can be written; raise as `open_writer`, except for OSError."""
    if name.endswith(MCAP_SUFFIX):
        mcap_files.check_method(compression, name)
    else:
        check_method(compression)


def is_mcap(path: str) -> bool:
    """Return whether a file begins as MCAP files do; raise OSError if it cannot be read."""
    with open(path, "rb") as file:
        return file.read(len(MAGIC)) == MAGIC
