"""A raw WebSocket client: it reads only on request, and can send any bytes."""

from __future__ import annotations

import asyncio
import itertools
import json
import socket
import struct
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

from patience import PATIENCE

from fibws.hub.server import HubServer

TEXT, BINARY, CONT, CLOSE, PING, PONG = 0x1, 0x2, 0x0, 0x8, 0x9, 0xA
PATIENT = 600.0
"""Seconds: a timeout that must not matter to the test."""

_pings = itertools.count()


def frame(opcode: int, payload: bytes = b"", *, fin: bool = True, rsv: int = 0) -> bytes:
    """Return a client's frame, masked with the zero key."""
    size = len(payload)
    if size < 126:
        length = bytes((0x80 | size,))
    elif size < 65536:
        length = b"\xfe" + struct.pack("!H", size)
    else:
        length = b"\xff" + struct.pack("!Q", size)
    return bytes((fin << 7 | rsv << 4 | opcode,)) + length + bytes(4) + payload


def fragmented(message: bytes, size: int) -> list[bytes]:
    """Return the fragments of a text frame, each of at most ``size`` bytes."""
    start = {126: 8, 127: 14}.get(message[1] & 127, 6)
    payload = message[start:]
    cuts = list(range(0, len(payload), size))
    return [
        frame(CONT if cut else TEXT, payload[cut : cut + size], fin=cut == cuts[-1]) for cut in cuts
    ]


def operation(op: str, **fields: Any) -> bytes:
    """Return the frame of one operation."""
    return frame(TEXT, json.dumps({"op": op, **fields}).encode())


def publish(topic: str, data: Any) -> bytes:
    """Return the frame that publishes ``{"data": data}``."""
    return operation("publish", topic=topic, msg={"data": data})


def handshake(path: str = "/", **headers: str) -> bytes:
    """Return a WebSocket's opening request; underscores in header names become hyphens."""
    fields = {
        "Host": "localhost",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Version": "13",
    } | {name.replace("_", "-"): value for name, value in headers.items()}
    lines = [f"GET {path} HTTP/1.1", *(f"{name}: {value}" for name, value in fields.items())]
    return "\r\n".join([*lines, "", ""]).encode("latin-1")


class Gone(Exception):
    """The hub has closed the connection."""


class Client:
    """One connection to the hub."""

    def __init__(self, sock: socket.socket) -> None:
        self.socket = sock
        self._loop = asyncio.get_running_loop()
        self._read = bytearray()

    @property
    def port(self) -> int:
        """The port by which the hub's log knows this client."""
        number: int = self.socket.getsockname()[1]
        return number

    # Writing.

    async def send(self, *parts: bytes) -> None:
        """Send bytes as they are."""
        async with asyncio.timeout(PATIENCE):
            await self._loop.sock_sendall(self.socket, b"".join(parts))

    async def send_operation(self, op: str, **fields: Any) -> None:
        """Send one operation."""
        await self.send(operation(op, **fields))

    async def subscribes(self, topic: str, type_: str = "std_msgs/Int32", **fields: Any) -> None:
        """Subscribe, and wait until the hub has done it."""
        await self.send_operation("subscribe", topic=topic, type=type_, **fields)
        await self.is_processed()

    async def advertises(self, topic: str, type_: str = "std_msgs/Int32", **fields: Any) -> None:
        """Advertise, and wait until the hub has done it."""
        await self.send_operation("advertise", topic=topic, type=type_, **fields)
        await self.is_processed()

    # Reading.

    async def is_processed(self) -> None:
        """Wait until the hub has read everything sent, by a ping; nothing else may come back."""
        name = b"%d" % next(_pings)
        await self.send(frame(PING, name))
        assert await self.frame() == (PONG, name)

    async def response(self) -> tuple[int, dict[str, str], bytes]:
        """Return status, headers and body of an HTTP response."""
        head = await self._until(b"\r\n\r\n")
        first, *lines = head.decode("latin-1").split("\r\n")[:-2]
        headers = {name.lower(): value for name, _, value in (li.partition(": ") for li in lines)}
        status = int(first.split(" ")[1])
        return status, headers, b"" if status == 101 else await self.to_the_end()

    async def frame(self) -> tuple[int, bytes]:
        """Return the opcode and payload of the next frame; raise `Gone` at the end."""
        first, length = await self._exactly(2)
        assert not first & 0x70 and not length & 0x80, (first, length)
        if length == 126:
            (length,) = struct.unpack("!H", await self._exactly(2))
        elif length == 127:
            (length,) = struct.unpack("!Q", await self._exactly(8))
        return first & 0x0F, await self._exactly(length)

    async def receive(self) -> dict[str, Any]:
        """Return the next operation."""
        opcode, payload = await self.frame()
        assert opcode == TEXT, (opcode, payload)
        received: dict[str, Any] = json.loads(payload)
        return received

    async def receive_data(self, count: int) -> list[Any]:
        """Return the data of the next messages."""
        return [(await self.receive())["msg"]["data"] for _ in range(count)]

    async def receive_all(self) -> tuple[list[Any], int, str]:
        """Return the data of all messages until the hub closes, and the close code and reason."""
        data: list[Any] = []
        while True:
            opcode, payload = await self.frame()
            if opcode == CLOSE:
                (code,) = struct.unpack("!H", payload[:2])
                return data, code, payload[2:].decode()
            if opcode == TEXT:
                data.append(json.loads(payload)["msg"]["data"])

    async def is_closed(self) -> tuple[int, str]:
        """Return code and reason of the close frame that must come next."""
        opcode, payload = await self.frame()
        assert opcode == CLOSE, (opcode, payload)
        (code,) = struct.unpack("!H", payload[:2])
        return code, payload[2:].decode()

    async def to_the_end(self) -> bytes:
        """Return the bytes until the hub disconnects."""
        while await self._more():
            pass
        rest, self._read = bytes(self._read), bytearray()
        return rest

    # Leaving.

    def leave(self) -> None:
        """Close the socket without a close frame."""
        self.socket.close()

    def reset(self) -> None:
        """Reset the TCP connection."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()

    async def _exactly(self, size: int) -> bytes:
        while len(self._read) < size:
            if not await self._more():
                raise Gone(bytes(self._read))
        data = bytes(self._read[:size])
        del self._read[:size]
        return data

    async def _until(self, mark: bytes) -> bytes:
        while mark not in self._read:
            if not await self._more():
                raise Gone(bytes(self._read))
        return await self._exactly(self._read.index(mark) + len(mark))

    async def _more(self) -> bool:
        async with asyncio.timeout(PATIENCE):
            data = await self._loop.sock_recv(self.socket, 1 << 16)
        self._read += data
        return bool(data)


@asynccontextmanager
async def dialled(port: int, *, receive_buffer: int | None = None) -> AsyncIterator[Client]:
    """Open a TCP connection without a handshake."""
    with socket.socket() as sock:
        sock.setblocking(False)
        if receive_buffer is not None:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        async with asyncio.timeout(PATIENCE):
            await asyncio.get_running_loop().sock_connect(sock, ("127.0.0.1", port))
        yield Client(sock)


@asynccontextmanager
async def connected(
    port: int, path: str = "/", *, receive_buffer: int | None = None, **headers: str
) -> AsyncIterator[Client]:
    """Open a WebSocket."""
    async with dialled(port, receive_buffer=receive_buffer) as client:
        await client.send(handshake(path, **headers))
        status, _, body = await client.response()
        assert status == 101, body
        yield client


async def until(condition: Callable[[], object]) -> None:
    """Wait for a condition within the hub that no client can observe."""
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110 - the hub has no event for it.
            await asyncio.sleep(0.005)


def timers() -> list[asyncio.TimerHandle]:
    """Return the pending timers of asyncio's loop; uvloop does not expose them."""
    scheduled = getattr(asyncio.get_running_loop(), "_scheduled", [])
    return [timer for timer in scheduled if not timer.cancelled()]


@asynccontextmanager
async def longest_turn() -> AsyncIterator[Callable[[], float]]:
    """Measure the longest turn of the event loop in seconds of CPU time.

    Unlike the time by the clock, that is not lengthened by what else the machine does.
    """
    longest = 0.0

    async def tick() -> None:
        nonlocal longest
        before = time.thread_time()
        while True:
            await asyncio.sleep(0)
            now = time.thread_time()
            longest = max(longest, now - before)
            before = now

    task = asyncio.create_task(tick())
    await asyncio.sleep(0)
    yield lambda: longest
    await asyncio.sleep(0)
    task.cancel()


def nodes(hub: HubServer) -> list[str]:
    """Return the names of the clients' nodes."""
    return [name for name in hub.graph.nodes if name not in hub.graph.rights.internal]


def topics(hub: HubServer) -> list[str]:
    """Return the names of the topics that clients use."""
    return [name for name in hub.graph.topics if name not in {"/rosout", *hub.graph.reserved}]
