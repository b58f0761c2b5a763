"""Bags: files with recorded messages, in the formats of ROS 1 (.bag) and MCAP (.mcap).

    connection ─> what all formats have: connections (publishers of topics), chunks of messages
    bag_format ─> records of .bag; bag_writer, bag_reader and bag_scan use it
    mcap_files ─> a reader, a writer and a scan of .mcap, on the library mcap
    reader ─> messages in the order of time, for both
    compression ─> of chunks, with bounds
    reindex ─> a bag with an index from what is left of one
    files ─> the right class for a file

Messages stay serialized: nothing here knows their types. It uses no clock and no tasks.
"""

from fibws.bags.connection import ChunkInfo, Connection
from fibws.bags.files import Writer, open_reader, open_writer
from fibws.bags.reader import Message, Reader
from fibws.bags.reindex import reindex

__all__ = [
    "ChunkInfo",
    "Connection",
    "Message",
    "Reader",
    "Writer",
    "open_reader",
    "open_writer",
    "reindex",
]
