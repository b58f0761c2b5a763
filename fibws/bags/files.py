"""The reader or the writer for a bag: by its content, or by the suffix of its name."""

from __future__ import annotations

import os
from typing import TypeAlias

from fibws.bags.bag_reader import BagReader
from fibws.bags.bag_writer import CHUNK_SIZE, BagWriter
from fibws.bags.mcap_files import MAGIC, McapReader, McapWriter
from fibws.bags.reader import Reader

Writer: TypeAlias = BagWriter | McapWriter

MCAP_SUFFIX = ".mcap"


def open_reader(path: str | os.PathLike[str], *, allow_unindexed: bool = False) -> Reader:
    """Open a bag for reading.

    Args:
        allow_unindexed: whether a bag without an index is read as a whole to make one.

    Raises:
        BagFormatError: it is damaged, or not a bag.
        BagNotIndexed: it has no index.
        UnsupportedBag: its version is not supported, it is encrypted, or a package is missing.
        OSError: it cannot be read.
    """
    path = os.fspath(path)
    if is_mcap(path):
        return McapReader(path, allow_unindexed=allow_unindexed)
    return BagReader(path, allow_unindexed=allow_unindexed)


def open_writer(
    path: str | os.PathLike[str], compression: str = "none", chunk_size: int = CHUNK_SIZE
) -> Writer:
    """Open a bag for writing: an MCAP file if the name ends in .mcap or .mcap.active.

    Args:
        compression: ``none``, ``lz4``, or ``bz2`` for .bag, ``zstd`` for .mcap.
        chunk_size: how many bytes, uncompressed, end a chunk.

    Raises:
        BagError: an invalid compression.
        UnsupportedBag: a package is not installed.
        OSError: the file cannot be written.
    """
    path = os.fspath(path)
    if path.removesuffix(".active").endswith(MCAP_SUFFIX):
        return McapWriter(path, compression, chunk_size)
    return BagWriter(path, compression, chunk_size)


def is_mcap(path: str) -> bool:
    """Return whether a file begins as MCAP files do; raise OSError if it cannot be read."""
    with open(path, "rb") as file:
        return file.read(len(MAGIC)) == MAGIC
