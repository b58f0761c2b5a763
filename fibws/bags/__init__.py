"""Bags: files with recorded messages: .bag of ROS 1, .mcap, and .db3 of ROS 2, which is only read.

    connection ─> what all formats have: connections (publishers of topics), chunks of messages
    bag_format ─> records of .bag; bag_writer, bag_reader and bag_scan use it
    mcap_files ─> a reader, a writer and a scan of .mcap, on the library mcap
    reader ─> messages in the order of time, for both
    compression ─> of chunks, with bounds
    reindex ─> a bag with an index from what is left of one
    sqlite_files ─> a reader of .db3
    rosbag2 ─> folders of .mcap and .db3 files, as one bag
    ros2_messages, on transformed_reader ─> messages in CDR as those of ROS 1, and back
    files ─> the right class for a file or a folder

Messages stay serialized: only ros2_messages knows their types. It uses no clock and no tasks.
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
