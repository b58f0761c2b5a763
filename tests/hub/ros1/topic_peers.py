"""Ends of TCPROS connections without sockets, and a type with fields of all sorts."""

from __future__ import annotations

import asyncio
import hashlib
import math
import struct
from collections.abc import Callable, Iterable
from typing import Any

from fibws.errors import FibwsError
from fibws.hub.graph.types import Buffer
from fibws.hub.ros1.inlet import InletConnection

HIGH_WATER = 64 * 1024


class FakeTransport(asyncio.Transport):
    """A transport whose peer reads only when the test says so.

    Args:
        protocol: is told that the peer reads slowly once more than a socket takes is written.
    """

    def __init__(self, protocol: Any = None) -> None:
        super().__init__()
        self.written: list[Buffer] = []
        self.reads = True
        self.closes = False
        self.is_aborted = False
        self._protocol = protocol
        self._unread = 0

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return {"peername": ("10.0.0.2", 4), "sockname": ("10.0.0.1", 5)}.get(name, default)

    def write(self, data: Buffer) -> None:
        self.written.append(data)
        before, self._unread = self._unread, self._unread + len(data)
        if before <= HIGH_WATER < self._unread:
            self._protocol.pause_writing()

    def get_write_buffer_size(self) -> int:
        return self._unread

    def read(self) -> None:
        """Let the peer read all that was written."""
        is_full, self._unread = self._unread > HIGH_WATER, 0
        if is_full:
            self._protocol.resume_writing()

    @property
    def bytes(self) -> int:
        return sum(len(each) for each in self.written)

    def pause_reading(self) -> None:
        self.reads = False

    def resume_reading(self) -> None:
        self.reads = True

    def close(self) -> None:
        self.closes = True

    def abort(self) -> None:
        self.is_aborted = True


class FakeSource:
    """Records the messages that a link relays."""

    class topic:
        name = "/t"

    def __init__(self, relayed: Callable[[], object] = lambda: None) -> None:
        self.node = "/talker"
        self.messages: list[bytes] = []
        self.fault: FibwsError | None = None
        self._came = asyncio.Event()
        self._relayed = relayed

    def relay(self, data: Buffer) -> None:
        if self.fault is not None:
            raise self.fault
        self.messages.append(bytes(data))
        self._came.set()
        self._relayed()

    async def received(self, count: int) -> None:
        """Wait for this many messages."""
        while len(self.messages) < count:
            self._came.clear()
            await self._came.wait()


def feed(protocol: InletConnection, data: bytes, sizes: Iterable[int]) -> None:
    """Give a protocol bytes in pieces of at most these sizes, until they or the bytes end."""
    start = 0
    for size in sizes:
        if start == len(data):
            return
        room = protocol.get_buffer(-1)
        assert len(room) > 0
        piece = data[start : start + min(size, len(room))]
        room[: len(piece)] = piece
        protocol.buffer_updated(len(piece))
        start += len(piece)


def framed(*bodies: bytes) -> bytes:
    """Return messages with their lengths."""
    return b"".join(struct.pack("<I", len(body)) + body for body in bodies)


INNER = "int64[] ints\nfloat64 number\n"
EVERYTHING = {
    "type": "my_msgs/Everything",
    "message_definition": (
        "uint32 MOST=7\nint64 low\nuint64 high\nfloat32 nan\ntime stamp\nduration wait\n"
        f"uint8[] bytes\nuint8[3] three\nInner[] inner\nstring[] words\n{'=' * 80}\n"
        f"MSG: my_msgs/Inner\n{INNER}"
    ),
    "md5sum": hashlib.md5(
        (
            "uint32 MOST=7\nint64 low\nuint64 high\nfloat32 nan\ntime stamp\nduration wait\n"
            f"uint8[] bytes\nuint8[3] three\n{hashlib.md5(INNER.strip().encode()).hexdigest()} "
            "inner\nstring[] words"
        ).encode()
    ).hexdigest(),
}
LOW, HIGH = -(2**63), 2**64 - 1
EVERY_BODY = (
    struct.pack("<qQ", LOW, HIGH)
    + b"\x01\x02\xc0\x7f"  # A NaN that is not the usual one.
    + struct.pack("<IIii", 2**32 - 1, 999_999_999, -1, -5)
    + struct.pack("<I", 4)
    + b"\x00\xff\x80\n"
    + b"\x01\x02\x03"
    + struct.pack("<I", 2)
    + struct.pack("<Iqqd", 2, 1, LOW, -0.0)
    + struct.pack("<Id", 0, math.inf)
    + struct.pack("<II", 2, 0)
    + struct.pack("<I", 3)
    + "ä!".encode()
)
