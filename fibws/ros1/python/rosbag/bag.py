"""`Bag`, which reads and writes bags as that of ROS 1 does.

Differences: publishers of a topic keep their connections when messages are written with their
connection headers, where ROS keeps one for each topic. Messages that were read have the classes
that are installed, if these have the same definition. Files of MCAP (.mcap) can be used, too.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from pathlib import Path
from threading import RLock
from time import time
from types import TracebackType
from typing import Any, BinaryIO, NamedTuple, Self, cast

import genpy
import genpy.dynamic
from roslib.names import canonicalize_name
from rospy.rostime import Time

from fibws.bags import Connection, Reader, Writer, open_reader, open_writer, reindex, summary
from fibws.bags.bag_reader import BagReader
from fibws.bags.bag_writer import BagWriter
from fibws.bags.mcap_files import MAGIC as MCAP_MAGIC
from fibws.bags.mcap_files import McapWriter
from fibws.bags.ros2_messages import ROS1, with_encoding
from fibws.bags.rosbag2 import ZSTD_MAGIC
from fibws.errors import BagError, BagFormatError, BagNotIndexed, UnsupportedBag
from fibws.files import open_to_write, replacing

__all__ = [
    "Bag",
    "BagMessage",
    "BagMessageWithConnectionHeader",
    "Compression",
    "ROSBagEncryptException",
    "ROSBagEncryptNotSupportedException",
    "ROSBagException",
    "ROSBagFormatException",
    "ROSBagUnindexedException",
    "bag_reindex",
]


class ROSBagException(Exception):
    """The base of rosbag's errors."""

    def __init__(self, value: Any = None) -> None:
        self.value = value
        super().__init__(value)

    def __str__(self) -> str:
        return str(self.value)


class ROSBagFormatException(ROSBagException):
    """A bag is damaged."""


class ROSBagUnindexedException(ROSBagException):
    """A bag has no index, because its recorder did not close it."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Unindexed bag")


class ROSBagEncryptNotSupportedException(ROSBagException):
    """A bag is encrypted, which fibws cannot read."""


class ROSBagEncryptException(ROSBagException):
    """Encryption or decryption failed; never raised here."""


class Compression:
    """The compression methods."""

    NONE = "none"
    BZ2 = "bz2"
    LZ4 = "lz4"


class BagMessage(NamedTuple):
    """A message that was read: its topic, the message, and its time."""

    topic: str
    message: Any
    timestamp: Time


class BagMessageWithConnectionHeader(NamedTuple):
    """A message that was read, with the connection header of its publisher."""

    topic: str
    message: Any
    timestamp: Time
    connection_header: dict[str, bytes]


class ConnectionInfo(NamedTuple):
    """A publisher's connection, with the names that rosbag has for its fields."""

    id: int
    topic: str
    datatype: str
    md5sum: str
    msg_def: str
    header: dict[str, bytes]


class TopicTuple(NamedTuple):
    """What a bag has of a topic."""

    msg_type: str
    message_count: int
    connections: int
    frequency: float | None


class TypesAndTopicsTuple(NamedTuple):
    """The types of a bag with their md5sums, and its topics."""

    msg_types: dict[str, str]
    topics: dict[str, TopicTuple]


class CompressionTuple(NamedTuple):
    """The most frequent compression of a bag's chunks, and their sizes in bytes."""

    compression: str
    uncompressed: int
    compressed: int


_COMPRESSIONS = (Compression.NONE, Compression.BZ2, Compression.LZ4)
_ConnectionFilter = Callable[[str, str, str, str, "dict[str, bytes]"], Any]


class Bag:
    """A bag: its messages can be read, written, or both.

    Args:
        f: the path, or a file that is open in binary mode.
        mode: ``r`` reads, ``w`` writes a new bag, and ``a`` appends to one. Those of ``w`` and
            ``a`` can be read, too.
        compression: a method of `Compression` for messages that are written.
        chunk_threshold: how many bytes, uncompressed, end a chunk.
        allow_unindexed: whether a bag without an index is read as a whole to make one.
        options: a dict with ``compression`` and ``chunk_threshold``, which is used first.
        skip_index: whether summaries are without frequencies, and thus quicker.

    Raises:
        ValueError: an argument is invalid.
        ROSBagException: the bag cannot be read.
        ROSBagUnindexedException: it has no index.
        OSError: the file cannot be opened.
    """

    def __init__(
        self,
        f: str | os.PathLike[str] | BinaryIO | io.IOBase,
        mode: str = "r",
        compression: str = Compression.NONE,
        chunk_threshold: int = 768 * 1024,
        allow_unindexed: bool = False,
        options: dict[str, Any] | None = None,
        skip_index: bool = False,
    ) -> None:
        if options is not None:
            if type(options) is not dict:
                raise ValueError("options must be of type dict")
            compression = options.get("compression", compression)
            chunk_threshold = options.get("chunk_threshold", chunk_threshold)
        self._compression = _checked_compression(compression)
        self._chunk_threshold = _checked_threshold(chunk_threshold)
        self._has_frequencies = not skip_index
        self._lock = RLock()
        """Held while something is written: rospy calls callbacks in several threads."""
        self._reader: Reader | None = None
        self._writer: Writer | None = None
        self._connections: dict[Any, Connection] = {}
        """The connections of the writer, by what tells publishers apart."""
        if not f:
            raise ValueError("filename (or stream) is invalid")
        if mode not in ("r", "w", "a"):
            raise ValueError(f'mode "{mode}" is invalid')
        self._mode = mode
        self._file: BinaryIO | None = None
        self._filename: str | None = None
        if isinstance(f, str | os.PathLike):
            self._filename = os.fspath(f)
        elif isinstance(f, io.TextIOBase):
            raise ROSBagException("In Python 3 the bag file must be opened in binary mode")
        else:
            self._file = cast(BinaryIO, f)
        with _rosbag_errors():
            self._open(allow_unindexed)

    def __iter__(self) -> Iterator[Any]:
        return self.read_messages()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def options(self) -> dict[str, Any]:
        """The options for messages that are written."""
        return {"compression": self._compression, "chunk_threshold": self._chunk_threshold}

    @property
    def filename(self) -> str | None:
        """The path; None for a file that was open."""
        return self._filename

    @property
    def version(self) -> int:
        """The version of the format: 200 for 2.0."""
        return 200

    @property
    def mode(self) -> str:
        """The mode: ``r``, ``w`` or ``a``."""
        return self._mode

    @property
    def size(self) -> int:
        """The size in bytes, with that of a chunk that is not written so far."""
        if self._writer is not None:
            return self._writer.size
        return self._opened().size

    @property
    def compression(self) -> str:
        """The compression method for messages that are written."""
        return self._compression

    @compression.setter
    def compression(self, compression: str) -> None:
        self._compression = _checked_compression(compression)
        if isinstance(self._writer, BagWriter):
            self._writer.flush()
            self._writer.compression = compression

    @property
    def chunk_threshold(self) -> int:
        """How many bytes, uncompressed, end a chunk."""
        return self._chunk_threshold

    @chunk_threshold.setter
    def chunk_threshold(self, chunk_threshold: int) -> None:
        self._chunk_threshold = _checked_threshold(chunk_threshold)
        if self._writer is not None:
            self._writer.flush()
            self._writer.chunk_size = chunk_threshold

    def read_messages(
        self,
        topics: str | list[str] | None = None,
        start_time: genpy.Time | None = None,
        end_time: genpy.Time | None = None,
        connection_filter: _ConnectionFilter | None = None,
        raw: bool = False,
        return_connection_header: bool = False,
    ) -> Generator[Any, None, None]:
        """Read messages in the order of their times.

        Args:
            topics: only those of these topics; of all if it is empty.
            start_time: only those of this time and later.
            end_time: only those of this time and earlier.
            connection_filter: called with the topic, the type, the md5sum, the definition and the
                connection header of a publisher; returns whether to read its messages.
            raw: whether messages are tuples instead: type, bytes, md5sum, position, class.
            return_connection_header: whether to return connection headers, too.

        Yields:
            `BagMessage`, or `BagMessageWithConnectionHeader`.

        Raises:
            ROSBagException: the bag is damaged, or a definition in it is invalid.
        """
        reader = self._readable()
        connections = self._selected(reader, topics, connection_filter)
        start, end = _nanoseconds(start_time), _nanoseconds(end_time)
        return self._read(reader, connections, start, end, raw, return_connection_header)

    def _read(
        self,
        reader: Reader,
        connections: list[Connection],
        start: int | None,
        end: int | None,
        raw: bool,
        with_header: bool,
    ) -> Generator[Any, None, None]:
        classes: dict[int, type[genpy.Message]] = {}
        with _rosbag_errors():
            for connection, nanoseconds, data, place in reader.located_messages(
                start=start, end=end, connections=connections
            ):
                if connection.id not in classes:
                    classes[connection.id] = _message_class(connection)
                message_class = classes[connection.id]
                message: Any
                if raw:
                    message = (connection.type, data, connection.md5sum, place, message_class)
                else:
                    message = message_class()
                    message.deserialize(data)
                stamp = Time(*divmod(nanoseconds, 1_000_000_000))
                if with_header:
                    header = dict(connection.fields)
                    yield BagMessageWithConnectionHeader(connection.topic, message, stamp, header)
                else:
                    yield BagMessage(connection.topic, message, stamp)

    def write(
        self,
        topic: str,
        msg: Any,
        t: genpy.Time | None = None,
        raw: bool = False,
        connection_header: Mapping[str, str | bytes] | None = None,
    ) -> None:
        """Write a message.

        Args:
            msg: a message; if ``raw``, a tuple as `read_messages` yields it: type, bytes, md5sum,
                position, class, or the same without the position.
            t: its time; now if None.
            connection_header: that of the message's publisher, as `read_messages` yields it.

        Raises:
            ValueError: an argument is invalid, or the bag is closed.
            ROSBagException: a raw message's type is unknown, or a bag cannot hold the message.
            genpy.SerializationError: a field does not fit its type.
        """
        writer = self._writer
        if writer is None:
            self._opened()
            raise io.UnsupportedOperation("write: the bag was opened for reading")
        if not topic:
            raise ValueError("topic is invalid")
        if not msg:
            raise ValueError("msg is invalid")
        if raw:
            if len(msg) not in (4, 5):
                raise ValueError("msg must be of length 4 or 5")
            type_, data, md5sum, *_, message_class = msg
        else:
            type_, md5sum, message_class = type(msg)._type, type(msg)._md5sum, type(msg)
            buffer = io.BytesIO()
            msg.serialize(buffer)
            data = buffer.getvalue()
        header = tuple(sorted((connection_header or {}).items()))
        key = (topic, type_, md5sum, header)
        with self._lock, _rosbag_errors():
            connection = self._connections.get(key)
            if connection is None:
                connection = self._connections[key] = _new_connection(
                    writer, topic, type_, md5sum, message_class, connection_header
                )
            now = Time.from_sec(time()) if t is None else t
            writer.write(connection, now.secs * 1_000_000_000 + now.nsecs, data)

    def flush(self) -> None:
        """Write what is in memory to the file; raise ValueError if the bag is closed."""
        with self._lock:
            if self._writer is not None:
                self._writer.flush()
            else:
                self._opened()

    def reindex(self) -> Iterator[int]:
        """Yield the positions of the chunks of a bag that was opened with ``allow_unindexed``.

        Its index was made when it was opened; ``a`` has written it.
        """
        return iter([chunk.position for chunk in self._readable().chunks])

    def close(self) -> None:
        """Write the index, and close the file; nothing happens if it is closed."""
        with self._lock, _rosbag_errors():
            writer, reader = self._writer, self._reader
            self._writer = self._reader = None
            if writer is not None:
                writer.close()
            elif reader is not None:
                reader.close()

    def get_compression_info(self) -> CompressionTuple:
        """Return the most frequent compression method, and the sizes of all chunks."""
        found = summary.compressions(self._readable())
        return CompressionTuple(
            compression=found[0].method if found else self._compression,
            uncompressed=sum(each.uncompressed for each in found),
            compressed=sum(each.compressed for each in found),
        )

    def get_message_count(self, topic_filters: str | list[str] | None = None) -> int:
        """Return the number of messages, or of those of some topics."""
        if topic_filters is None:
            return self._readable().message_count
        found = self.get_type_and_topic_info(topic_filters).topics.values()
        return sum(topic.message_count for topic in found)

    def get_start_time(self) -> float:
        """Return the time of the first message in seconds.

        Raises:
            ROSBagException: there is no message.
        """
        reader = self._readable()
        if not reader.chunks:
            raise ROSBagException("Bag contains no message")
        return reader.start / 1e9

    def get_end_time(self) -> float:
        """Return the time of the last message in seconds; raise as `get_start_time`."""
        reader = self._readable()
        if not reader.chunks:
            raise ROSBagException("Bag contains no message")
        return reader.end / 1e9

    def get_type_and_topic_info(
        self, topic_filters: str | list[str] | None = None
    ) -> TypesAndTopicsTuple:
        """Return all types with their md5sums, and the topics, or some of them."""
        reader = self._readable()
        if isinstance(topic_filters, str):
            topic_filters = [topic_filters]
        connections = [
            each
            for each in self._used(reader)
            if topic_filters is None or each.topic in topic_filters
        ]
        found = summary.topics(reader, connections, frequencies=self._has_frequencies)
        return TypesAndTopicsTuple(
            summary.types(self._used(reader)),
            {
                each.topic: TopicTuple(each.type, each.messages, each.connections, each.frequency)
                for each in found
            },
        )

    def __str__(self) -> str:
        reader = self._readable()
        return summary.text(reader, self._filename, frequencies=self._has_frequencies)

    # Of rosbag's own methods, those that programs use.

    def _get_yaml_info(self, key: str | None = None) -> str | None:
        """Return a summary as ``rosbag info --yaml`` prints it, or the value of one key in it."""
        found = summary.as_dict(self._readable(), self._filename, frequencies=self._has_frequencies)
        if not key:
            return summary.as_yaml(found)
        try:
            return summary.value_text(found, key)
        except summary.UnknownKey:
            print(f'Error getting key "{key}"', file=sys.stderr)
            return None

    def _get_connections(
        self,
        topics: str | Iterable[str] | None = None,
        connection_filter: _ConnectionFilter | None = None,
    ) -> Iterator[ConnectionInfo]:
        """Yield the connections, or those of some topics, or those that a function chooses."""
        for each in self._selected(self._readable(), topics, connection_filter):
            yield ConnectionInfo(
                each.id, each.topic, each.type, each.md5sum, each.definition, dict(each.fields)
            )

    def _open(self, allow_unindexed: bool) -> None:
        path = self._filename
        name = path or "the bag"
        if self._mode == "r":
            if path is not None and (fault := _first_fault(path)):
                raise ROSBagException(fault)
            if path is None:
                self._reader = BagReader(name, allow_unindexed=allow_unindexed, file=self._file)
            else:
                reader = open_reader(path, allow_unindexed=allow_unindexed)
                self._reader = with_encoding(reader, ROS1)
        elif self._mode == "w" or (path is not None and not os.path.exists(path)):
            if path is None:
                self._writer = BagWriter(
                    name, self._compression, self._chunk_threshold, file=self._file
                )
            else:
                self._writer = open_writer(path, self._compression, self._chunk_threshold)
        else:
            self._append(allow_unindexed)

    def _append(self, allow_unindexed: bool) -> None:
        file = self._file
        if self._filename is not None:
            file = open_to_write(self._filename, truncate=False)
        assert file is not None
        name = self._filename or "the bag"
        try:
            bag = BagReader(name, file=file)
        except BagNotIndexed:
            file.close()
            if not allow_unindexed or self._filename is None:
                raise
            bag_reindex(self._filename)
            self._append(allow_unindexed=False)
            return
        except BaseException:
            file.close()
            raise
        self._writer = BagWriter.append(
            bag, compression=self._compression, chunk_size=self._chunk_threshold
        )
        for each in bag.connections:
            self._connections.setdefault((each.topic, each.type, each.md5sum, ()), each)

    def _opened(self) -> Reader:
        if self._reader is None:
            raise ValueError("I/O operation on closed bag")
        return self._reader

    def _readable(self) -> Reader:
        """Return a reader of all messages, also of those that were just written."""
        if self._writer is None:
            return self._opened()
        if isinstance(self._writer, McapWriter):
            raise ROSBagException("an MCAP file cannot be read while it is written")
        with self._lock:
            self._writer.flush()
            return BagReader.of_writer(self._writer)

    def _used(self, reader: Reader) -> list[Connection]:
        """Return the connections that have messages."""
        counts = reader.counts
        return [each for each in reader.connections if counts.get(each.id)]

    def _selected(
        self,
        reader: Reader,
        topics: str | Iterable[str] | None,
        connection_filter: _ConnectionFilter | None,
    ) -> list[Connection]:
        names = {topics} if isinstance(topics, str) and topics else set(topics or ())
        names = {canonicalize_name(name) for name in names}
        return [
            each
            for each in self._used(reader)
            if (not names or not names.isdisjoint((each.topic, canonicalize_name(each.topic))))
            and (
                connection_filter is None
                or connection_filter(
                    each.topic, each.type, each.md5sum, each.definition, dict(each.fields)
                )
            )
        ]


def _first_fault(path: str) -> str | None:
    """Return why a file is not even a damaged bag, or None; raise OSError if there is none."""
    if os.path.isdir(path):
        return None  # Of rosbag2.
    with open(path, "rb") as file:
        start = file.read(4)
    if not start:
        return "empty file"
    return (
        None
        if start in (b"#ROS", MCAP_MAGIC[:4], ZSTD_MAGIC)
        else "This does not appear to be a bag file"
    )


def bag_reindex(path: str | os.PathLike[str]) -> int:
    """Write an index for a bag in its place; return the number of messages.

    Raises:
        ROSBagException: it is not a bag.
        OSError: the file cannot be read or written.
    """
    with _rosbag_errors(), replacing(Path(path)) as new:
        return reindex(path, new).messages


def _new_connection(
    writer: Writer,
    topic: str,
    type_: str,
    md5sum: str,
    message_class: type[genpy.Message] | None,
    connection_header: Mapping[str, str | bytes] | None,
) -> Connection:
    if message_class is None:
        message_class = genpy.message.get_message_class(type_)
    if message_class is None:
        raise ROSBagException(
            f"cannot locate message class and no message class provided for [{type_}]"
        )
    if message_class._md5sum != md5sum:
        print(
            f"WARNING: md5sum of loaded type [{type_}] does not match that specified",
            file=sys.stderr,
        )
    fields = {
        name: value if isinstance(value, bytes) else str(value).encode()
        for name, value in (connection_header or {}).items()
    }
    return writer.connection(
        topic,
        type_,
        md5sum,
        message_class._full_text,
        callerid=fields.get("callerid", b"").decode("utf-8", "replace"),
        latching=fields.get("latching") == b"1",
        fields=fields,
    )


def _message_class(connection: Connection) -> type[genpy.Message]:
    """Return the class that is installed, if it has the same definition, or else a new one."""
    if connection.encoding != "ros1":
        raise ROSBagException(
            f"messages of {connection.topic} are encoded as {connection.encoding}, not as ros1"
        )
    try:
        installed = genpy.message.get_message_class(connection.type)
    except Exception:  # Any fault of a definition that is not that of the bag.
        installed = None
    if installed is not None and installed._md5sum == connection.md5sum:
        found: type[genpy.Message] = installed
        return found
    try:
        classes = genpy.dynamic.generate_dynamic(connection.type, connection.definition)
    except genpy.dynamic.MsgGenerationException as error:
        raise ROSBagException(f"Error generating datatype {connection.type}: {error}") from None
    made = classes[connection.type]
    if connection.md5sum not in ("*", made._md5sum):
        print(
            f"WARNING: For type [{connection.type}] stored md5sum [{connection.md5sum}] does not "
            f"match message definition [{made._md5sum}].",
            file=sys.stderr,
        )
    return made


def _checked_compression(compression: str) -> str:
    if compression not in _COMPRESSIONS:
        raise ValueError(f"compression must be one of: {', '.join(_COMPRESSIONS)}")
    return compression


def _checked_threshold(chunk_threshold: int) -> int:
    if chunk_threshold < 0:
        raise ValueError("chunk_threshold must be greater than or equal to zero")
    return chunk_threshold


def _nanoseconds(stamp: genpy.Time | None) -> int | None:
    """Return a time in ns; None for no time, and for 0, which means no time, too."""
    if not stamp:
        return None
    if not isinstance(stamp, genpy.TVal):
        raise TypeError(f"expected rospy.Time or genpy.Time, got {type(stamp).__name__}")
    return stamp.to_nsec()


class _rosbag_errors:
    """Turns the errors of fibws in the block into those of rosbag."""

    def __enter__(self) -> None:
        pass

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        match error:
            case BagNotIndexed():
                raise ROSBagUnindexedException from error
            case UnsupportedBag(feature="encryption"):
                raise ROSBagEncryptNotSupportedException(str(error)) from error
            case BagFormatError():
                raise ROSBagFormatException(str(error)) from error
            case BagError():
                raise ROSBagException(str(error)) from error
