"""``fibws.v1``: serialized messages in binary frames, beside rosbridge's operations.

A client that offers the WebSocket subprotocol `SUBPROTOCOL`, and is answered with it, sends and
gets the same JSON operations as any rosbridge client. Messages of topics travel in binary frames,
in ROS 1's serialization (http://wiki.ros.org/msg); integers before them are little-endian as well:

    client to hub   u8 1, u32 publisher, message
                    u8 2, u32 publisher, u16 n, n bytes of a node's name (UTF-8), message
    hub to client   u8 1, u32 topic, u64 received, message
                    u8 2, u32 topic, u64 received, u16 n, n bytes of JSON, message
    either way      u8 3, u32 n, n bytes of JSON, values

``publisher`` is a number that the client chose in its ``advertise``. ``topic`` is a number that the
hub gives in ``subscribed``, its answer to a ``subscribe`` whose compression is `ROS1`; it is the
same for all subscribers of a topic. ``received`` counts nanoseconds from 1970. With kind 2 a client
sends a message to one node alone, and the hub sends the publisher's connection header to a
subscription that asked for headers. Kind 3 is an operation of a call or a goal: its JSON without
``args`` or ``values``, and then those, serialized.
"""

from __future__ import annotations

import struct
from typing import Final, NamedTuple

from fibws.errors import OperationError

SUBPROTOCOL: Final = "fibws.v1"
ROS1: Final = "ros1"
"""The compression that a subscription asks for to get serialized messages."""
MOST_PUBLISHERS: Final = 2**32
"""A publisher's number is below this."""

_PLAIN, _NAMED, _OPERATION = 1, 2, 3
_FROM_CLIENT = struct.Struct("<BI")
_FROM_CLIENT_NAMED = struct.Struct("<BIH")
_FROM_HUB = struct.Struct("<BIQ")
_FROM_HUB_NAMED = struct.Struct("<BIQH")
_BEFORE_OPERATION = struct.Struct("<BI")


VALUES: Final = {
    "call_service": "args",
    "service_response": "values",
    "send_action_goal": "args",
    "action_feedback": "values",
    "action_result": "values",
}
"""The operations that may travel in a frame of kind 3, and the field that is serialized."""


class FromClient(NamedTuple):
    """A message that a client published."""

    publisher: int
    node: str | None
    """The only node that is to get it; None for all subscribers."""
    message: memoryview


class FromHub(NamedTuple):
    """A message that the hub delivered."""

    topic: int
    received: int
    """When the hub received it, in nanoseconds since 1970."""
    header: bytes
    """The publisher's connection header as JSON, or empty."""
    message: memoryview


def publish_head(publisher: int, node: str | None = None) -> bytes:
    """Return the header of a message from a client; see `FromClient`."""
    if node is None:
        return _FROM_CLIENT.pack(_PLAIN, publisher)
    name = node.encode()
    return _FROM_CLIENT_NAMED.pack(_NAMED, publisher, len(name)) + name


def deliver_head(topic: int, received: int, header: bytes = b"") -> bytes:
    """Return the header of a message from the hub; see `FromHub`."""
    if not header:
        return _FROM_HUB.pack(_PLAIN, topic, received)
    return _FROM_HUB_NAMED.pack(_NAMED, topic, received, len(header)) + header


def read_publish(data: bytes | bytearray | memoryview) -> FromClient:
    """Read a client's frame; its message is a view of ``data``.

    Raises:
        OperationError: the frame is too short, of an unknown kind, or names an invalid node.
    """
    view = memoryview(data)
    try:
        if data[0] == _PLAIN:
            _, publisher = _FROM_CLIENT.unpack_from(data)
            return FromClient(publisher, None, view[_FROM_CLIENT.size :])
        if data[0] == _NAMED:
            _, publisher, size = _FROM_CLIENT_NAMED.unpack_from(data)
            end = _FROM_CLIENT_NAMED.size + size
            if end <= len(data):
                name = str(view[_FROM_CLIENT_NAMED.size : end], "utf-8")
                return FromClient(publisher, name, view[end:])
    except (IndexError, struct.error):
        pass
    except UnicodeDecodeError:
        raise OperationError("invalid binary frame: the node's name is not UTF-8") from None
    raise _invalid(data)


def read_delivery(data: bytes | bytearray) -> FromHub:
    """Read a hub's frame; its message is a view of ``data``.

    Raises:
        OperationError: the frame is too short, or of an unknown kind.
    """
    view = memoryview(data)
    try:
        if data[0] == _PLAIN:
            _, topic, received = _FROM_HUB.unpack_from(data)
            return FromHub(topic, received, b"", view[_FROM_HUB.size :])
        if data[0] == _NAMED:
            _, topic, received, size = _FROM_HUB_NAMED.unpack_from(data)
            end = _FROM_HUB_NAMED.size + size
            if end <= len(data):
                return FromHub(topic, received, bytes(data[_FROM_HUB_NAMED.size : end]), view[end:])
    except (IndexError, struct.error):
        pass
    raise _invalid(data)


def operation_head(text: bytes) -> bytes:
    """Return the header of the serialized values of an operation, which has this JSON text."""
    return _BEFORE_OPERATION.pack(_OPERATION, len(text)) + text


def is_operation(data: bytes | bytearray | memoryview) -> bool:
    """Return whether a frame is an operation with serialized values, not a topic's message."""
    return data[:1] == b"\x03"


def read_operation(data: bytes | bytearray) -> tuple[bytes, bytes]:
    """Return the JSON text and the values of an operation's frame.

    Raises:
        OperationError: the frame is too short.
    """
    if len(data) >= (start := _BEFORE_OPERATION.size):
        _, size = _BEFORE_OPERATION.unpack_from(data)
        if size <= len(data) - start:
            view = memoryview(data)
            return bytes(view[start : start + size]), bytes(view[start + size :])
    raise _invalid(data)


def read_topic(beginning: bytes) -> int:
    """Return the topic's number in the first bytes of a hub's frame; -1 if there is none."""
    if len(beginning) < _FROM_HUB.size or beginning[0] not in (_PLAIN, _NAMED):
        return -1
    number: int = _FROM_HUB.unpack_from(beginning)[1]
    return number


def _invalid(data: bytes | bytearray | memoryview) -> OperationError:
    kind = data[0] if data else None
    if kind in (_PLAIN, _NAMED, _OPERATION):
        return OperationError(f"invalid binary frame: {len(data)} bytes are too few for its header")
    return OperationError(f"invalid binary frame: kind must be 1, 2 or 3, got {kind}")
