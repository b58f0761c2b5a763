"""A scripted hub, and a session without a socket."""

from __future__ import annotations

import asyncio
import json
import logging
import ssl
import time
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from http import HTTPStatus
from typing import Any

import pytest
import uvloop
from patience import PATIENCE
from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from fibws.interfaces.serialization import Serializers
from fibws.msg import default_interfaces
from fibws.node.calls import ROUND_TRIP
from fibws.node.outgoing_queue import LIMIT, PublisherLane
from fibws.node.session import Session
from fibws.node.types import NodeTypes
from fibws.protocol.serialized import ROS1, SUBPROTOCOL, deliver_head, read_publish
from fibws.protocol.websocket import TEXT, client_frame, client_payload

LARGE = 10_000
"""Characters of a frame that fills a test's sockets."""


def pytest_asyncio_loop_factories() -> dict[str, Callable[[], asyncio.AbstractEventLoop]]:
    """Run every asynchronous test on both event loops."""
    return {"asyncio": asyncio.new_event_loop, "uvloop": uvloop.new_event_loop}


def _is_about_the_log(operation: dict[str, Any]) -> bool:
    name: str = operation.get("topic") or operation.get("service", "")
    return name == "/rosout" or name.endswith(("/get_loggers", "/set_logger_level"))


class Peer:
    """The hub's end of one connection, of `fibws.v1` if the node may have it.

    Serialized messages come as ``publish`` operations, as they do from nodes without `fibws.v1`.
    The calls by which nodes wait for their registrations are answered as soon as they arrive.
    """

    def __init__(self, websocket: ServerConnection) -> None:
        self.websocket = websocket
        self._frames: asyncio.Queue[str | bytes | None] = asyncio.Queue()
        self._is_read = asyncio.Event()
        self._is_over = False
        self.serialized = websocket.subprotocol == SUBPROTOCOL
        self._publishers: dict[int, tuple[str, str]] = {}
        self._subscriptions: dict[str, tuple[int, str]] = {}
        self._serializers = Serializers(default_interfaces())

    @property
    def path(self) -> str:
        assert self.websocket.request is not None
        return self.websocket.request.path

    async def serve(self) -> None:
        """Read the connection until it is closed, but not much further than the test has."""
        try:
            while True:
                data = await self.websocket.recv()
                if isinstance(data, str) and ROUND_TRIP in data:
                    call = json.loads(data)
                    await self.send(
                        "service_response",
                        id=call["id"],
                        service=ROUND_TRIP,
                        values="unknown service",
                        result=False,
                    )
                    continue
                self._frames.put_nowait(data)
                while len(data) > LARGE and not self._frames.empty() and not self._is_over:
                    self._is_read.clear()
                    await self._is_read.wait()
        except ConnectionClosed:
            self._frames.put_nowait(None)

    def stop(self) -> None:
        """Read to the end, whether the test has read anything or not."""
        self._is_over = True
        self._is_read.set()

    async def receive(self) -> dict[str, Any]:
        """The next operation."""
        data = await self._frames.get()
        self._is_read.set()
        if data is None:
            data = await self.websocket.recv()  # Raises why the connection was closed.
        if isinstance(data, bytes):
            number, node, message = read_publish(data)
            topic, type_ = self._publishers[number]
            values = self._serializers.of(type_).deserialize(message)
            return {"op": "publish", "topic": topic, "msg": values} | ({"to": node} if node else {})
        operation: dict[str, Any] = json.loads(data)
        if operation["op"] == "advertise" and self.serialized:
            assert len(operation.pop("md5sum")) == 32
            number = operation.pop("publisher")
            self._publishers[number] = (operation["topic"], operation["type"])
        if operation["op"] == "subscribe" and self.serialized:
            assert operation.pop("compression") == ROS1
            md5sum = operation.pop("md5sum", "")
            topic, type_ = operation["topic"], operation["type"]
            number = self._subscriptions.setdefault(topic, (len(self._subscriptions), type_))[0]
            with suppress(ConnectionClosed):  # The test may read this after the node has left.
                await self.send(
                    "subscribed",
                    id=operation["id"],
                    topic=topic,
                    topic_id=number,
                    type=type_,
                    md5sum=md5sum,
                )
            operation["compression"] = "none"
        return operation

    async def has_sent_nothing(self) -> bool:
        """Return whether the node has sent nothing that was not received, before its next pong."""
        async with asyncio.timeout(PATIENCE):
            await (await self.websocket.ping())
        await asyncio.sleep(0)  # `serve` takes what has come before it.
        return self._frames.empty()

    async def expect(self, op: str) -> dict[str, Any]:
        """Return the next operation, which must be ``op``; skip those of the node's log."""
        async with asyncio.timeout(60):
            while True:
                operation = await self.receive()
                if not _is_about_the_log(operation):
                    assert operation["op"] == op, operation
                    return operation

    async def logged(self) -> dict[str, Any]:
        """The next line of the node's log."""
        async with asyncio.timeout(60):
            while True:
                operation = await self.receive()
                if operation["op"] == "publish" and operation["topic"] == "/rosout":
                    message: dict[str, Any] = operation["msg"]
                    return message

    async def send(self, op: str, **fields: Any) -> None:
        await self.websocket.send(self.encoded(op, **fields))

    def encoded(self, op: str, **fields: Any) -> str | bytes:
        """An operation as it is sent to the node."""
        known = self._subscriptions.get(fields.get("topic", ""))
        if not self.serialized or op != "publish" or known is None:
            return json.dumps({"op": op, **fields})
        number, type_ = known
        header = json.dumps(fields["header"]).encode() if "header" in fields else b""
        message = self._serializers.of(type_).serialize(fields["msg"])
        return deliver_head(number, 0, header) + message


class ScriptedHub:
    """A hub on a free port, which it keeps after a restart.

    Args:
        serialized: whether it supports `fibws.v1`.
        tls: its certificate for wss://.
    """

    def __init__(self, *, serialized: bool, tls: ssl.SSLContext | None = None) -> None:
        self.serialized = serialized
        self.tls = tls
        self.port = 0
        self.refusal: tuple[HTTPStatus, str] | None = None
        self.attempts = 0
        self._attempted = asyncio.Event()
        self._peers: asyncio.Queue[Peer] = asyncio.Queue()
        self._connected: list[Peer] = []
        self._server: Server | None = None

    @property
    def url(self) -> str:
        return f"{'wss' if self.tls else 'ws'}://127.0.0.1:{self.port}"

    async def start(self) -> None:
        self._server = await serve(
            self._serve,
            "127.0.0.1",
            self.port,
            process_request=self._request,
            compression=None,
            max_size=None,
            ssl=self.tls,
            subprotocols=[Subprotocol(SUBPROTOCOL)] if self.serialized else None,
        )
        self.port = self._server.sockets[0].getsockname()[1]

    async def stop(self) -> None:
        for peer in self._connected:
            peer.stop()
        if self._server is not None:
            self._server.close(code=1001, reason="the hub is shutting down")
            await self._server.wait_closed()

    async def peer(self) -> Peer:
        """The next node's connection."""
        async with asyncio.timeout(60):
            return await self._peers.get()

    async def attempted(self, times: int) -> None:
        """Wait until nodes have tried to connect that often."""
        async with asyncio.timeout(60):
            while self.attempts < times:
                self._attempted.clear()
                await self._attempted.wait()

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        self.attempts += 1
        self._attempted.set()
        if self.refusal is None:
            return None
        return connection.respond(*self.refusal)

    async def _serve(self, websocket: ServerConnection) -> None:
        peer = Peer(websocket)
        self._connected.append(peer)
        self._peers.put_nowait(peer)
        await peer.serve()


class Lines(logging.Handler):
    """The lines of a node's log."""

    def __init__(self, log: logging.Logger) -> None:
        super().__init__()
        self._lines: asyncio.Queue[str] = asyncio.Queue()
        log.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        self._lines.put_nowait(record.getMessage())

    def seen(self) -> list[str]:
        """Return the lines that were not returned yet."""
        return [self._lines.get_nowait() for _ in range(self._lines.qsize())]

    async def next(self) -> str:
        async with asyncio.timeout(60):
            return await self._lines.get()


@pytest.fixture(params=["fibws.v1", "rosbridge"])
async def hub(request: pytest.FixtureRequest) -> AsyncIterator[ScriptedHub]:
    hub = ScriptedHub(serialized=request.param == SUBPROTOCOL)
    await hub.start()
    yield hub
    await hub.stop()


class Frames:
    """Receives the frames of a session like a connection to a rosbridge_suite server."""

    is_behind = False

    def __init__(self) -> None:
        self.operations: asyncio.Queue[dict[str, Any]] = asyncio.Queue()

    def write(self, frame: bytes, lane: PublisherLane | None) -> None:
        operation = json.loads(client_payload(frame) if lane is None else lane.to_json(frame))
        if operation["op"] != "filler":
            self.operations.put_nowait(operation)

    def write_joined(self, frames: list[tuple[bytes, PublisherLane | None]]) -> None:
        for frame, lane in frames:
            self.write(frame, lane)


class FakeSession(Session):
    """A connected session without a socket."""

    def __init__(self) -> None:
        super().__init__(logging.Logger("test"))
        self.frames = Frames()
        self.begin()

    def reconnect(self) -> None:
        self.connect(self.frames, serialized=False)

    def reopen(self) -> None:
        """Connect to a hub again, and skip the registrations."""
        self.connect(self.frames, serialized=False, hold=True)
        while not self.frames.operations.empty():
            self.frames.operations.get_nowait()
        self.outgoing.release()

    def fill(self) -> None:
        """Fill the queue until publishers wait."""
        self.outgoing.pause()
        filler = {"op": "filler", "text": "x" * LIMIT}
        self.outgoing.put(client_frame(TEXT, json.dumps(filler).encode()))

    def drain(self) -> None:
        """Let the socket take all queued frames."""
        self.outgoing.resume()


@pytest.fixture
async def session() -> FakeSession:
    session = FakeSession()
    session.reconnect()
    return session


@pytest.fixture
def lines(session: Session) -> Lines:
    return Lines(session.log)


@pytest.fixture
def types() -> NodeTypes:
    return NodeTypes(time.time_ns)


def sent_operations(session: FakeSession) -> list[dict[str, Any]]:
    """Return the operations sent since the last call."""
    session.outgoing.release()
    session.outgoing.resume()
    operations = session.frames.operations
    return [operations.get_nowait() for _ in range(operations.qsize())]


async def next_operation(session: FakeSession) -> dict[str, Any]:
    """Wait for the next operation that is sent."""
    async with asyncio.timeout(60):
        return await session.frames.operations.get()


def deliver(session: Session, op: str, **fields: Any) -> None:
    """Let the session receive an operation."""
    session.receive_text(json.dumps({"op": op, **fields}).encode())


def reconnected(session: FakeSession) -> list[dict[str, Any]]:
    """Reconnect; return the operations sent first."""
    sent_operations(session)
    session.on_disconnect()
    session.reconnect()
    return sent_operations(session)
