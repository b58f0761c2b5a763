"""Connections that ROS 1 nodes open to the hub, until their header has arrived."""

from __future__ import annotations

import asyncio
import random
import socket
from collections.abc import Mapping
from weakref import ref

import pytest

from fibws.errors import OperationError
from fibws.hub.errors import TcprosError
from fibws.hub.ros1.connection import CLOSE_TIMEOUT, Handler, TcprosConnection, describe
from fibws.hub.ros1.tcpros import decode_header, encode_header

from ..fakes import FakeClock
from .topic_peers import FakeTransport

HEADER = {"topic": "/t", "md5sum": "*", "callerid": "/listener"}


class Acceptor:
    """Accepts every connection; it is its own handler."""

    waiting_bytes = 3
    incomplete_bytes = 5

    def __init__(self, answer: bytes = b"", error: Exception | None = None) -> None:
        self.headers: list[Mapping[str, str]] = []
        self.received = b""
        self.events: list[str] = []
        self._answer = answer
        self._error = error

    def accept(self, header: Mapping[str, str], connection: TcprosConnection) -> Handler | None:
        if self._error is not None:
            raise self._error
        self.headers.append(header)
        connection.transport.write(self._answer)
        return self

    def shorten(self, size: int, least: int) -> None:
        self.events.append(f"shorten {size} {least}")

    def data_received(self, data: bytes) -> None:
        self.received += data

    def pause_writing(self) -> None:
        self.events.append("pause")

    def resume_writing(self) -> None:
        self.events.append("resume")

    def connection_lost(self) -> None:
        self.events.append("lost")


class Accepted:
    """A connection with its transport, clock and acceptor."""

    def __init__(self, acceptor: Acceptor | None = None) -> None:
        self.clock = FakeClock()
        self.acceptor = acceptor or Acceptor()
        self.closed: list[TcprosConnection] = []
        acceptors = {"topic": self.acceptor}
        self.connection = TcprosConnection(acceptors, self.clock, 10.0, self.closed.append)
        self.transport = FakeTransport(self.connection)
        self.connection.connection_made(self.transport)

    @property
    def error(self) -> str:
        """The error that the peer was sent."""
        return decode_header(b"".join(self.transport.written)[4:])["error"]


@pytest.mark.parametrize("size", [1, 3, 7, 1000])
def test_header_may_arrive_in_pieces(size: int) -> None:
    accepted = Accepted()
    data = encode_header(HEADER) + b"more"
    for start in range(0, len(data), size):
        accepted.connection.data_received(data[start : start + size])
    assert accepted.acceptor.headers == [HEADER]
    assert accepted.acceptor.received == b"more"
    assert accepted.clock.timers == 0


def test_bytes_of_the_header_and_of_the_handler_count() -> None:
    accepted = Accepted()
    connection, data = accepted.connection, encode_header(HEADER)
    connection.data_received(data[:-1])
    assert (connection.waiting_bytes, connection.incomplete_bytes) == (0, len(data) - 1)
    connection.shorten(100, 1)
    connection.data_received(data[-1:])
    assert (connection.waiting_bytes, connection.incomplete_bytes) == (3, 5)
    connection.shorten(100, 1)
    assert accepted.acceptor.events == ["shorten 100 1"]


def test_silent_connection_is_closed() -> None:
    accepted = Accepted()
    accepted.connection.data_received(encode_header(HEADER)[:-1])
    accepted.clock.advance(10)
    assert "10 s" in accepted.error
    assert accepted.transport.closes
    accepted.connection.connection_lost(None)
    assert accepted.closed == [accepted.connection]
    assert accepted.clock.timers == 0


@pytest.mark.parametrize(
    ("data", "fact"),
    [
        ((2**24 - 1).to_bytes(4, "little"), "16777215"),
        (encode_header({"md5sum": "*"}), "'topic'"),
        (b"\x06\0\0\0\x02\0\0\0ab", "no ="),
    ],
)
def test_invalid_header_is_answered_with_an_error(data: bytes, fact: str) -> None:
    accepted = Accepted()
    accepted.connection.data_received(data)
    assert fact in accepted.error
    assert accepted.transport.closes
    assert accepted.acceptor.headers == []


@pytest.mark.parametrize("error", [TcprosError("no " + "x" * 10**6), OperationError("no")])
def test_refusal_is_sent_in_a_few_words(error: Exception) -> None:
    accepted = Accepted(Acceptor(error=error))
    accepted.connection.data_received(encode_header(HEADER))
    assert accepted.error.startswith("no")
    assert accepted.transport.bytes < 2000


def test_random_bytes_are_never_an_exception() -> None:
    rng = random.Random(3)
    for _ in range(500):
        accepted = Accepted()
        data = bytearray(encode_header(HEADER) if rng.random() < 0.7 else rng.randbytes(50))
        for _ in range(rng.randrange(5)):
            data[rng.randrange(len(data))] = rng.randrange(256)
        while data and not accepted.transport.closes:
            size = rng.randrange(1, 60)
            accepted.connection.data_received(bytes(data[:size]))
            del data[:size]
        accepted.connection.connection_lost(None)
        assert accepted.clock.timers == 0


def test_peer_that_does_not_read_is_marked_from_the_beginning() -> None:
    accepted = Accepted(Acceptor(answer=bytes(100_000)))
    accepted.connection.data_received(encode_header(HEADER))
    is_paused = accepted.connection.is_paused
    assert accepted.acceptor.events == ["pause"]
    accepted.transport.read()
    assert (is_paused, accepted.connection.is_paused) == (True, False)
    assert accepted.acceptor.events == ["pause", "resume"]


def test_peer_that_does_not_read_cannot_keep_a_connection_open() -> None:
    accepted = Accepted()
    accepted.connection.data_received(encode_header(HEADER))
    accepted.connection.close()
    assert accepted.transport.closes
    assert not accepted.transport.is_aborted
    accepted.clock.advance(CLOSE_TIMEOUT)
    assert accepted.transport.is_aborted


def test_connection_that_has_ended_is_freed_at_once() -> None:
    accepted = Accepted()
    accepted.connection.data_received(encode_header(HEADER))
    handler = ref(accepted.acceptor)
    accepted.connection.connection_lost(None)
    assert accepted.acceptor.events == ["lost"]
    del accepted.acceptor, accepted.connection._acceptors
    assert handler() is None


async def test_system_detects_a_peer_that_has_vanished() -> None:
    made = asyncio.get_running_loop().create_future()

    class Recording(TcprosConnection):
        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            super().connection_made(transport)
            made.set_result(self)

    loop = asyncio.get_running_loop()
    server = await loop.create_server(
        lambda: Recording({}, loop, 10.0, lambda _: None), "127.0.0.1", 0
    )
    port = server.sockets[0].getsockname()[1]
    _, writer = await asyncio.open_connection("127.0.0.1", port)
    connection = await made
    sock = connection.transport.get_extra_info("socket")
    assert sock.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
    assert sock.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
    peer = writer.get_extra_info("sockname")
    assert f"port {port} to [127.0.0.1:{peer[1]} on socket" in describe(connection.transport)
    writer.close()
    connection.abort()
    server.close()
