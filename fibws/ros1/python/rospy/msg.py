"""Messages of any type as bytes, and the other public names of rospy.msg."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from io import BytesIO
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar, Self, TypeVar

from genpy.classes import message_class
from genpy.message import DeserializationError, Message

from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.message import ObjectStyle
from fibws.interfaces.serialization import Buffer, ClassCodec
from rospy.exceptions import ROSException

if TYPE_CHECKING:
    from fibws.msg.std_msgs import Header
else:
    Header = message_class("std_msgs/Header")

__all__ = [
    "AnyMsg",
    "Header",
    "Message",
    "args_kwds_to_message",
    "deserialize_messages",
    "serialize_message",
    "serialized",
]

_LENGTH = struct.Struct("<I")
"""Bytes of a message, which precede it on a TCPROS connection."""


class AnyMsg(Message):
    """A message of any type, in ROS 1's bytes: ``_buff``, which is None at first.

    Raises:
        ROSException: fields are given.
    """

    __slots__ = ["_buff"]
    _type: ClassVar[str] = "*"
    _md5sum: ClassVar[str] = "*"
    _has_header: ClassVar[bool] = False
    _full_text: ClassVar[str] = ""

    _buff: bytes | None

    def __init__(self, *args: Any) -> None:
        if args:
            raise ROSException("AnyMsg does not accept arguments")
        self._buff = None

    def serialize(self, buff: BinaryIO) -> None:
        """Write the bytes to a file.

        Raises:
            ROSException: the bytes are not set.
        """
        if self._buff is None:
            raise ROSException("AnyMsg is not initialized")
        buff.write(self._buff)

    @classmethod
    def _make_codec(cls, interfaces: Definitions, style: ObjectStyle) -> ClassCodec[Self]:
        return _RawCodec(cls, interfaces, style)

    def deserialize(self, str: bytes) -> Self:
        """Keep the bytes; return the message itself."""
        self._buff = str
        return self


A = TypeVar("A", bound=AnyMsg)


class _RawCodec(ClassCodec[A]):
    """Passes the bytes through unchanged."""

    def serialize(self, message: A) -> bytes:
        if message._buff is None:
            raise ROSException("AnyMsg is not initialized")
        return message._buff

    def serialize_after(self, head: Callable[[int], bytes], message: A) -> bytes:
        data = self.serialize(message)
        return head(len(data)) + data

    def deserialize(self, data: Buffer) -> A:
        return self.message_class().deserialize(bytes(data))


def args_kwds_to_message(
    data_class: type[Message], args: tuple[Any, ...], kwds: Mapping[str, Any]
) -> Message:
    """Return the given message, or create one of the given fields.

    Args:
        data_class: the class of the message.
        args: one message of that class, or of `AnyMsg`; or all the fields in order.
        kwds: some of the fields by name.

    Raises:
        TypeError: both are given, or a message of another class, or not all fields.
        AttributeError: a field is unknown.
    """
    if args and kwds:
        raise TypeError("publish() can be called with arguments or keywords, but not both.")
    if kwds or len(args) != 1:
        return data_class(*args, **kwds)
    given = args[0]
    if not hasattr(given, "_md5sum"):
        return data_class(given)
    if given._md5sum in (data_class._md5sum, "*"):
        message: Message = given
        return message
    expected = data_class._slot_types[0] if data_class._slot_types else ""
    if given._type != expected:
        raise TypeError(f"expected [{expected}] but got [{given._type}]")
    return data_class(given)


def serialized(message: Message) -> bytes:
    """Serialize a message as ROS 1 does.

    Raises:
        genpy.SerializationError: a value does not fit its field.
    """
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def number_header(header: Any, seq: int) -> None:
    """Set a header's sequence number; that of ROS 2 has none."""
    if hasattr(header, "seq"):
        header.seq = seq
    if header.frame_id is None:
        header.frame_id = "0"


def serialize_message(b: BinaryIO, seq: int, msg: Message) -> None:
    """Append a message to a buffer, after its length, as TCPROS does.

    Args:
        b: the buffer.
        seq: the sequence number for the message's header, if it has one.
        msg: the message.

    Raises:
        genpy.SerializationError: a value does not fit its field.
    """
    if msg._has_header:
        number_header(msg.header, seq)
    data = serialized(msg)
    b.write(_LENGTH.pack(len(data)) + data)


def deserialize_messages(
    b: BytesIO,
    msg_queue: list[Any],
    data_class: type[Message],
    queue_size: int | None = None,
    max_msgs: int | None = None,
    start: int = 0,
) -> None:
    """Move the messages in a buffer, each after its length, to a list.

    What is left of the buffer, a part of a message, moves to its begin.

    Args:
        b: the buffer; what was written to it ends at its position.
        msg_queue: the list.
        data_class: the class of the messages.
        queue_size: how many messages the list keeps, the newest ones.
        max_msgs: how many messages to read at most.
        start: where the buffer begins.

    Raises:
        genpy.DeserializationError: a message is invalid.
    """
    end, at = b.tell(), start
    data = b.getbuffer()[:end].tobytes()
    found: list[bytes] = []
    while (not max_msgs or len(found) < max_msgs) and end - at >= _LENGTH.size:
        (size,) = _LENGTH.unpack_from(data, at)
        if end - at - _LENGTH.size < size:
            break
        at += _LENGTH.size + size
        found.append(data[at - size : at])
    if queue_size is not None:
        del found[: max(0, len(found) - queue_size)]
    try:
        msg_queue += [data_class().deserialize(each) for each in found]
    except Exception as error:
        raise DeserializationError(f"cannot deserialize: {error}") from error
    if queue_size is not None:
        del msg_queue[: max(0, len(msg_queue) - queue_size)]
    b.seek(start)
    b.truncate()
    b.write(data[at:])
