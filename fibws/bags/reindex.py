"""Restoring bags that were not closed, or that are damaged."""

from __future__ import annotations

import os

from fibws.bags.bag_format import RecordFile, number
from fibws.bags.bag_reader import read_start
from fibws.bags.bag_scan import BagScan
from fibws.bags.bag_writer import BagWriter
from fibws.bags.connection import Restored
from fibws.bags.files import is_mcap
from fibws.bags.mcap_files import rewrite_mcap


def reindex(source: str | os.PathLike[str], target: str | os.PathLike[str]) -> Restored:
    """Write a new bag, with an index, of all messages that are left of one.

    Chunks are copied as they are. What can be read of a damaged chunk becomes one of its own,
    without compression.

    Args:
        source: the bag, which need not have an index; it is only read.
        target: the new bag's path; a file that exists is replaced.

    Raises:
        BagFormatError: it is not a bag.
        UnsupportedBag: its version is not supported, it is encrypted, or a package is missing.
        OSError: a file cannot be read or written.
    """
    source, target = os.fspath(source), os.fspath(target)
    if is_mcap(source):
        return rewrite_mcap(source, target)
    with open(source, "rb") as opened:
        file = RecordFile(opened, source)
        header = read_start(file)
        index_position = number(header.fields, "index_pos", 8, source)
        scan = BagScan(file, is_closed=index_position != 0)
        messages = 0
        with BagWriter(target) as writer:
            for chunk in scan.chunks():
                writer.add_chunk(chunk.info, chunk.data, chunk.indexes())
                messages += sum(chunk.info.counts.values())
            used = {id_ for info in writer.chunks for id_ in info.counts}
            writer.connections += [each for each in scan.sorted_connections() if each.id in used]
        return Restored(messages, scan.lost)
