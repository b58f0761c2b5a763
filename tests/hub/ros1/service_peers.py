"""Services and service clients of ROS 1 nodes, as far as they show on the wire."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Callable
from contextlib import suppress
from typing import Self

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.ros1.http import NodeCalls
from fibws.hub.ros1.nodes import Ros1Node, Ros1Nodes
from fibws.hub.ros1.tcpros import decode_header, encode_header


def new_nodes(graph: Graph) -> Ros1Nodes:
    """Return the ROS 1 nodes of a graph, none so far."""
    return Ros1Nodes(graph, NodeCalls(), principal=None, quota=LatchQuota, port=lambda: 11311)


def new_node(nodes: Ros1Nodes, name: str) -> Ros1Node:
    """Return a ROS 1 node, and let it be known."""
    nodes.by_name[name] = node = Ros1Node(name, "http://127.0.0.1:1/", "127.0.0.1", 0, nodes)
    return node


class FakeService:
    """A service of a ROS 1 node, which a function responds to.

    Args:
        header: the fields that it sends to clients.
        respond: returns the bytes that follow a request; None keeps silent.
        closes: whether connections end after one call, even persistent ones.
    """

    def __init__(
        self,
        header: dict[str, str],
        respond: Callable[[bytes], bytes | None] = lambda _: None,
        *,
        closes: bool = False,
    ) -> None:
        self.header = header
        self.respond = respond
        self.closes = closes
        self.headers: list[dict[str, str]] = []
        """The headers of its clients."""
        self.requests: list[bytes] = []
        self.probed = asyncio.Event()
        """Set when a header has come."""
        self.asked = asyncio.Event()
        """Set when a request has come."""
        self.left = asyncio.Event()
        """Set when a client has left after a request."""
        self._server: asyncio.Server
        self._writers: list[asyncio.StreamWriter] = []

    async def __aenter__(self) -> Self:
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *error: object) -> None:
        self._server.close()
        self.disconnect()

    def disconnect(self) -> None:
        """Close all connections."""
        for writer in self._writers:
            writer.close()

    @property
    def uri(self) -> str:
        return f"rosrpc://127.0.0.1:{self.port}"

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._writers.append(writer)
        try:
            header = decode_header(await _frame(reader))
            self.headers.append(header)
            self.probed.set()
            writer.write(encode_header(self.header))
            while header.get("probe") != "1":
                request = await _frame(reader)
                self.requests.append(request)
                self.asked.set()
                response = self.respond(request)
                if response is None:
                    await reader.read()
                    self.left.set()
                    return
                writer.write(response)
                if header.get("persistent") != "1" or self.closes:
                    break
        except (asyncio.IncompleteReadError, ConnectionError):
            self.left.set()
        finally:
            writer.close()


def ok(body: bytes) -> bytes:
    """Return a service's answer with a response."""
    return struct.pack("<BI", 1, len(body)) + body


def failed(text: str) -> bytes:
    """Return a service's answer with an error."""
    data = text.encode()
    return struct.pack("<BI", 0, len(data)) + data


async def _frame(reader: asyncio.StreamReader) -> bytes:
    (size,) = struct.unpack("<I", await reader.readexactly(4))
    return await reader.readexactly(size)


class FakeClient:
    """A ROS 1 client of a service."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer

    @classmethod
    async def connect(cls, port: int, **header: str) -> tuple[Self, dict[str, str]]:
        """Connect; return the client and the header that it gets."""
        self = cls(*await asyncio.open_connection("127.0.0.1", port))
        fields = {"service": "/add", "md5sum": "*", "callerid": "/caller"} | header
        self._writer.write(encode_header({key: value for key, value in fields.items() if value}))
        return self, decode_header(await _frame(self._reader))

    def write(self, data: bytes) -> None:
        self._writer.write(data)

    def send(self, *requests: bytes) -> None:
        for request in requests:
            self._writer.write(struct.pack("<I", len(request)) + request)

    async def answer(self) -> tuple[bool, bytes]:
        """Return whether a call succeeded, and the response or the error's text."""
        is_ok, size = struct.unpack("<BI", await self._reader.readexactly(5))
        return bool(is_ok), await self._reader.readexactly(size)

    async def call(self, request: bytes) -> tuple[bool, bytes]:
        self.send(request)
        return await self.answer()

    async def ends(self) -> bool:
        """Wait for the end of the connection; return whether nothing came before it."""
        return await self._reader.read() == b""

    async def leave(self) -> None:
        self._writer.close()
        with suppress(ConnectionError):
            await self._writer.wait_closed()
