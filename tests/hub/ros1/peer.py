"""A ROS 1 node as it shows on the wire: XML-RPC and TCPROS, without code of fibws."""

from __future__ import annotations

import asyncio
import struct
import xmlrpc.client
from collections.abc import Mapping
from typing import Any, Self
from urllib.parse import urlsplit

PID = 4242
MD5_OF_INT32 = "da5909fbe378aeaf85e547e830cc1bb7"
INT32 = {"type": "std_msgs/Int32", "md5sum": MD5_OF_INT32, "message_definition": "int32 data\n"}


def header(fields: Mapping[str, str]) -> bytes:
    """Return a connection header with its length."""
    lines = [f"{key}={value}".encode() for key, value in fields.items()]
    body = b"".join(struct.pack("<I", len(line)) + line for line in lines)
    return struct.pack("<I", len(body)) + body


async def frame(reader: asyncio.StreamReader) -> bytes:
    """Read a length and as many bytes."""
    (size,) = struct.unpack("<I", await reader.readexactly(4))
    return await reader.readexactly(size)


async def read_header(reader: asyncio.StreamReader) -> dict[str, str]:
    """Read a connection header."""
    body, fields = await frame(reader), {}
    while body:
        (size,) = struct.unpack("<I", body[:4])
        key, _, value = body[4 : 4 + size].decode().partition("=")
        fields[key] = value
        body = body[4 + size :]
    return fields


class Link:
    """One TCPROS connection.

    Attributes:
        header: what the other end has sent.
    """

    def __init__(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, header: dict[str, str]
    ) -> None:
        self.header = header
        self._reader = reader
        self._writer = writer

    def send(self, *bodies: bytes) -> None:
        """Send messages."""
        for body in bodies:
            self._writer.write(struct.pack("<I", len(body)) + body)

    def write(self, data: bytes) -> None:
        """Send bytes that need not be messages."""
        self._writer.write(data)

    async def receive(self) -> bytes:
        """Return the next message."""
        async with asyncio.timeout(60):
            return await frame(self._reader)

    async def ended(self) -> bytes:
        """Wait for the end; return what came before it."""
        async with asyncio.timeout(60):
            try:
                return await self._reader.read()
            except ConnectionError:
                return b""

    def close(self) -> None:
        """Close it."""
        self._writer.close()


class Peer:
    """A node: ``async with Peer("/talker", master) as talker``.

    Args:
        name: its global name.
        master: the master's URI.
        pid: what it tells as its process.

    Attributes:
        calls: what was called of it, each with its arguments without the caller's name, in order;
            but for getPid.
        answers: what it answers, by method, in place of the default; None for no answer at all.
        publishes: the headers with which it answers subscribers, by topic.
        links: the connections of subscribers, in order.
    """

    def __init__(self, name: str, master: str, *, pid: int = PID) -> None:
        self.name = name
        self.master = master
        self.pid = pid
        self.calls: asyncio.Queue[tuple[str, list[Any]]] = asyncio.Queue()
        self.answers: dict[str, Any] = {}
        self.publishes: dict[str, dict[str, str]] = {}
        self.links: asyncio.Queue[Link] = asyncio.Queue()
        self._server: asyncio.Server
        self._writers: set[asyncio.StreamWriter] = set()
        self._is_dead = False

    async def __aenter__(self) -> Self:
        await self.listen()
        return self

    async def __aexit__(self, *error: object) -> None:
        self.die()
        for _ in range(5):  # Connections that are being accepted end, too.
            await asyncio.sleep(0)

    async def listen(self, port: int = 0) -> None:
        """Answer calls and subscribers."""
        self._is_dead = False
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", port)
        self.port: int = self._server.sockets[0].getsockname()[1]

    def die(self) -> None:
        """End as after kill -9: without a word to anybody."""
        self._is_dead = True
        self._server.close()
        for writer in self._writers:
            writer.transport.abort()

    @property
    def api(self) -> str:
        """The URI of its XML-RPC server."""
        return f"http://127.0.0.1:{self.port}/"

    # As a client of the master.

    async def call(self, method: str, *params: Any, uri: str | None = None) -> Any:
        """Call the master, or another node, in this node's name; return the answer's value.

        Raises:
            AssertionError: the answer's code is not 1; its text says why.
        """
        code, text, value = await self.ask(method, *params, uri=uri)
        assert code == 1, text
        return value

    async def ask(self, method: str, *params: Any, uri: str | None = None) -> Any:
        """Return the whole answer of such a call."""
        return await request(uri or self.master, method, self.name, *params)

    async def advertise(
        self, topic: str, fields: Mapping[str, str] = INT32, *, latching: bool = False
    ) -> list[str]:
        """Register as a publisher, with these fields in its header; return the subscribers."""
        self.publishes[topic] = {
            "callerid": self.name,
            "topic": topic,
            "latching": "1" if latching else "0",
            **fields,
        }
        type_ = self.publishes[topic]["type"]
        found: list[str] = await self.call("registerPublisher", topic, type_, self.api)
        return found

    async def subscribe(self, topic: str, type_: str = "std_msgs/Int32") -> list[str]:
        """Register as a subscriber; return the publishers."""
        found: list[str] = await self.call("registerSubscriber", topic, type_, self.api)
        return found

    async def connect(self, topic: str, uri: str | None = None, **fields: str) -> Link:
        """Connect to a publisher, by default at the hub; return the link with its header."""
        protocol, host, port = await self.call(
            "requestTopic", topic, [["TCPROS"]], uri=uri or self.master
        )
        assert protocol == "TCPROS"
        reader, writer = await asyncio.open_connection(host, port)
        self._writers.add(writer)
        own = {"callerid": self.name, "topic": topic, "type": "*", "md5sum": "*"} | fields
        writer.write(header(own))
        async with asyncio.timeout(60):
            return Link(reader, writer, await read_header(reader))

    async def called(self, method: str) -> list[Any]:
        """Wait for a call of a method; return its arguments."""
        async with asyncio.timeout(60):
            while True:
                name, params = await self.calls.get()
                if name == method:
                    return params

    def calls_of(self, method: str) -> int:
        """Return how often a method has been called, and forget all calls so far."""
        calls = [self.calls.get_nowait() for _ in range(self.calls.qsize())]
        return sum(name == method for name, _ in calls)

    async def linked(self) -> Link:
        """Wait for a subscriber."""
        async with asyncio.timeout(60):
            return await self.links.get()

    # As a server.

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self._is_dead:  # It was accepted while this ended.
            writer.transport.abort()
            return
        self._writers.add(writer)
        try:
            start = await reader.readexactly(4)
            if start == b"POST":
                await self._serve_http(reader, writer)
            else:
                await self._serve_topic(int.from_bytes(start, "little"), reader, writer)
        except (asyncio.IncompleteReadError, ConnectionError):
            writer.transport.abort()

    async def _serve_topic(
        self, size: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        rest = asyncio.StreamReader()
        rest.feed_data(struct.pack("<I", size) + await reader.readexactly(size))
        link = Link(reader, writer, await read_header(rest))
        writer.write(header(self.publishes[link.header["topic"]]))
        self.links.put_nowait(link)

    async def _serve_http(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while True:
            length = _length(await reader.readuntil(b"\r\n\r\n"))
            params, method = xmlrpc.client.loads(await reader.readexactly(length))
            assert method is not None
            answer = self._answer(method, list(params))
            if answer is None:
                return
            body = xmlrpc.client.dumps((answer,), methodresponse=True).encode()
            writer.write(b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
            await reader.readexactly(4)  # POST

    def _answer(self, method: str, params: list[Any]) -> Any:
        if method != "getPid":
            self.calls.put_nowait((method, params[1:]))
        if method in self.answers:
            return self.answers[method]
        match method:
            case "getPid":
                return [1, "", self.pid]
            case "requestTopic" if params[1] in self.publishes:
                return [1, "", ["TCPROS", "127.0.0.1", self.port]]
            case "getPublications":
                return [1, "", [[each, of["type"]] for each, of in self.publishes.items()]]
            case "getSubscriptions":
                return [1, "", []]
        return [1, "", 0]


async def request(uri: str, method: str, *params: Any) -> Any:
    """Make an XML-RPC call on a connection of its own."""
    url = urlsplit(uri)
    reader, writer = await asyncio.open_connection(url.hostname, url.port)
    body = xmlrpc.client.dumps(params, method).encode()
    path, length = url.path or "/", len(body)
    head = f"POST {path} HTTP/1.1\r\nHost: {url.netloc}\r\nContent-Length: {length}\r\n\r\n"
    writer.write(head.encode() + body)
    async with asyncio.timeout(60):
        answer = await reader.readexactly(_length(await reader.readuntil(b"\r\n\r\n")))
    writer.close()
    return xmlrpc.client.loads(answer, use_builtin_types=True)[0][0]


def _length(head: bytes) -> int:
    """Return the length of the body that follows an HTTP head."""
    fields = (line.partition(b":") for line in head.lower().splitlines())
    return next(int(value) for name, _, value in fields if name == b"content-length")
