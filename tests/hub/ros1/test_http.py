"""The server's side of XML-RPC over HTTP."""

from __future__ import annotations

import asyncio
import re
import xmlrpc.client
from collections.abc import AsyncIterator
from typing import Any

import pytest

from fibws.hub.errors import XmlRpcError
from fibws.hub.ros1 import http
from fibws.hub.ros1.http import XmlRpcCaller, XmlRpcConnection

MOST = 1_000_000
POST = "POST /RPC2 HTTP/1.1\r\n"


class Client:
    """A client's connection, with what the server was called."""

    def __init__(self, calls: list[Any]) -> None:
        self.calls = calls
        self.reader: asyncio.StreamReader
        self.writer: asyncio.StreamWriter
        self.closed = asyncio.Event()
        """Set when the server has forgotten the connection."""

    def send(
        self, *params: Any, head: str = "POST /RPC2 HTTP/1.1\r\n", method: str = "echo"
    ) -> None:
        self.writer.write(request(*params, head=head, method=method))

    async def response(self) -> tuple[int, str, bytes]:
        """Return the status, the head and the body of a response."""
        async with asyncio.timeout(60):
            head = (await self.reader.readuntil(b"\r\n\r\n")).decode()
            found = re.search(r"\r\nContent-length: (\d+)\r\n", head)
            assert found is not None
            body = await self.reader.readexactly(int(found[1]))
            return int(head.split()[1]), head, body

    async def value(self) -> Any:
        status, _, body = await self.response()
        assert status == 200
        return xmlrpc.client.loads(body, use_builtin_types=True)[0][0]

    async def ends(self) -> bytes:
        async with asyncio.timeout(60):
            return await self.reader.read()


def request(*params: Any, head: str = POST, method: str = "echo") -> bytes:
    body = xmlrpc.client.dumps(params, method).encode()
    return f"{head}Host: here\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body


@pytest.fixture
async def client() -> AsyncIterator[Client]:
    calls: list[Any] = []

    def answer(path: str, method: str, params: list[Any], caller: XmlRpcCaller) -> object:
        calls.append((path, method, params))
        match method:
            case "fail":
                raise XmlRpcError("no such method")
            case "slow":
                return later(params)
            case "crash":
                raise RuntimeError("a bug")
        return params

    async def later(value: object) -> object:
        await asyncio.sleep(0)
        return value

    def connected() -> XmlRpcConnection:
        return XmlRpcConnection(
            answer, lambda *headers: None, MOST, lambda connection: client.closed.set()
        )

    client = Client(calls)
    server = await asyncio.get_running_loop().create_server(connected, "127.0.0.1", 0)
    address = server.sockets[0].getsockname()
    client.reader, client.writer = await asyncio.open_connection(*address)
    yield client
    client.writer.close()
    server.close()


@pytest.mark.both_loops
async def test_calls_are_answered_one_after_the_other(client: Client) -> None:
    for number in range(3):
        client.send("/a", number)
        assert await client.value() == ["/a", number]
    assert client.calls[0] == ("/RPC2", "echo", ["/a", 0])


@pytest.mark.both_loops
async def test_calls_that_come_together_are_answered_in_order(client: Client) -> None:
    methods = ["echo", "slow", "echo", "slow", "slow", "echo"]
    numbers = range(len(methods))
    calls = (request(number, method=methods[number]) for number in numbers)
    client.writer.write(b"".join(calls))
    assert [await client.value() for _ in numbers] == [[number] for number in numbers]


async def test_call_may_come_in_single_bytes(client: Client) -> None:
    for byte in request("ä"):
        client.writer.write(bytes([byte]))
        await client.writer.drain()
    assert await client.value() == ["ä"]


async def test_large_calls_and_answers(client: Client) -> None:
    value = {"text": "x" * 300_000, "list": list(range(5000))}
    client.send(value)
    client.send("next")
    assert await client.value() == [value]
    assert await client.value() == ["next"]


async def test_fault_leaves_the_connection_open(client: Client) -> None:
    client.writer.write(request(method="fail"))
    with pytest.raises(xmlrpc.client.Fault, match="no such method"):
        await client.value()
    client.writer.write(b"POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\n<oops")
    with pytest.raises(xmlrpc.client.Fault, match="invalid"):
        await client.value()
    client.send(1)
    assert await client.value() == [1]


async def test_large_invalid_call_leaves_the_connection_open(client: Client) -> None:
    body = b"<!DOCTYPE x>" + b"x" * 100_000
    client.writer.write(b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n%b" % (len(body), body))
    with pytest.raises(xmlrpc.client.Fault, match="document types"):
        await client.value()
    client.send(1)
    assert await client.value() == [1]


@pytest.mark.parametrize(
    ("head", "status"),
    [
        ("GET / HTTP/1.1", 405),
        ("POST / HTTP/1.1", 411),
        ("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\nContent-Length: 5", 411),
        ("POST / HTTP/1.1\r\nContent-Length: 1000001", 413),
        ("POST / HTTP/1.1\r\nContent-Length: " + "9" * 5000, 413),
        ("POST / HTTP/1.1\r\nContent-Length: -1", 400),
        ("POST / HTTP/1.1\r\nContent-Length: +1", 400),
        ("POST / HTTP/1.1\r\nContent-Length: ²", 400),
        ("POST / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2", 400),
        ("POST / HTTP/1.1\r\nno colon", 400),
        ("POST / HTTP/1.1\r\nName : x", 400),
        ("POST / HTTP/2", 400),
        ("POST /", 400),
        ("hello", 400),
        ("POST / HTTP/1.1\r\nX: " + "x" * http.MOST_HEAD, 431),
    ],
)
async def test_other_requests_are_refused(client: Client, head: str, status: int) -> None:
    client.writer.write(head.encode() + b"\r\n\r\n")
    found, headers, body = await client.response()
    assert found == status
    assert "Connection: close" in headers
    assert body
    assert await client.ends() == b""
    assert client.calls == []


async def test_connection_ends_when_the_caller_wants(client: Client) -> None:
    client.send(1, head="POST / HTTP/1.1\r\nConnection: close\r\n")
    client.send(2)
    assert await client.value() == [1]
    assert await client.ends() == b""
    assert len(client.calls) == 1


async def test_http_1_0_ends_after_one_call(client: Client) -> None:
    client.send(1, head="POST / HTTP/1.0\r\n")
    assert await client.value() == [1]
    assert await client.ends() == b""


async def test_caller_that_has_ended_its_side_is_answered(client: Client) -> None:
    client.writer.write(request(1, method="slow"))
    client.writer.write_eof()
    assert await client.value() == [1]
    assert await client.ends() == b""


async def test_silent_caller_is_disconnected(
    client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(http, "IDLE_TIMEOUT", 0.01)
    client.send(1)
    assert await client.value() == [1]
    assert await client.ends() == b""


async def test_call_that_never_arrives_is_given_up(
    client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(http, "BODY_TIMEOUT", 0.01)
    client.writer.write(b"POST / HTTP/1.1\r\nContent-Length: 100000\r\n\r\n<")
    assert await client.ends() == b""


async def test_connection_is_forgotten_with_its_end(client: Client) -> None:
    client.writer.write(b"POST / HTTP/1.1\r\nContent-Length: 100000\r\n\r\n<")
    await client.writer.drain()
    client.writer.close()
    async with asyncio.timeout(60):
        await client.closed.wait()
