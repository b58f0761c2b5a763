"""A hub that does what the test says, with sockets and without."""

from __future__ import annotations

import asyncio
import json
import logging
import time
from collections.abc import AsyncIterator, Callable
from http import HTTPStatus
from typing import Any

import pytest
import uvloop
from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.http11 import Request, Response

from fibws.node.session import Session
from fibws.node.types import Types


def pytest_asyncio_loop_factories() -> dict[str, Callable[[], asyncio.AbstractEventLoop]]:
    """Every test that has a loop runs on both."""
    return {"asyncio": asyncio.new_event_loop, "uvloop": uvloop.new_event_loop}


def _is_about_the_log(operation: dict[str, Any]) -> bool:
    name: str = operation.get("topic") or operation.get("service", "")
    return name == "/rosout" or name.endswith(("/get_loggers", "/set_logger_level"))


class Peer:
    """The hub's end of one connection."""

    def __init__(self, websocket: ServerConnection) -> None:
        self.websocket = websocket

    @property
    def path(self) -> str:
        assert self.websocket.request is not None
        return self.websocket.request.path

    async def hears(self, op: str) -> dict[str, Any]:
        """The next operation, which is this one; what has to do with its log is passed over."""
        async with asyncio.timeout(60):
            while True:
                operation: dict[str, Any] = json.loads(await self.websocket.recv())
                if not _is_about_the_log(operation):
                    assert operation["op"] == op, operation
                    return operation

    async def logged(self) -> dict[str, Any]:
        """The next line of the node's log."""
        async with asyncio.timeout(60):
            while True:
                operation = json.loads(await self.websocket.recv())
                if operation["op"] == "publish" and operation["topic"] == "/rosout":
                    message: dict[str, Any] = operation["msg"]
                    return message

    async def says(self, op: str, **fields: Any) -> None:
        await self.websocket.send(json.dumps({"op": op, **fields}))


class ScriptedHub:
    """Listens on a port of its own, which it keeps when it is started again."""

    def __init__(self) -> None:
        self.port = 0
        self.refusal: tuple[HTTPStatus, str] | None = None
        self.attempts = 0
        self._attempted = asyncio.Event()
        self._peers: asyncio.Queue[Peer] = asyncio.Queue()
        self._server: Server | None = None

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self.port}"

    async def start(self) -> None:
        self._server = await serve(
            self._serve, "127.0.0.1", self.port, process_request=self._request, compression=None
        )
        self.port = self._server.sockets[0].getsockname()[1]

    async def stop(self) -> None:
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
        self._peers.put_nowait(Peer(websocket))
        await websocket.wait_closed()


class Lines(logging.Handler):
    """The lines of a node's log, to be waited for."""

    def __init__(self, log: logging.Logger) -> None:
        super().__init__()
        self._lines: asyncio.Queue[str] = asyncio.Queue()
        log.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        self._lines.put_nowait(record.getMessage())

    def seen(self) -> list[str]:
        """The lines so far that nobody has asked for yet."""
        return [self._lines.get_nowait() for _ in range(self._lines.qsize())]

    async def next(self) -> str:
        async with asyncio.timeout(60):
            return await self._lines.get()


@pytest.fixture
async def hub() -> AsyncIterator[ScriptedHub]:
    hub = ScriptedHub()
    await hub.start()
    yield hub
    await hub.stop()


@pytest.fixture
def session() -> Session:
    """A node's session with a hub that is there, and that has no socket."""
    session = Session(logging.Logger("test"))
    session.begin()
    session.outbox.open()
    return session


@pytest.fixture
def lines(session: Session) -> Lines:
    return Lines(session.log)


@pytest.fixture
def types() -> Types:
    return Types(time.time_ns)


def said(session: Session) -> list[dict[str, Any]]:
    """The operations that wait to be sent."""
    return [json.loads(session.outbox.pop()) for _ in range(len(session.outbox))]


def greeted(session: Session) -> list[dict[str, Any]]:
    """What the next connection would be told first."""
    return [json.loads(text) for text in session.greeting()]


async def says(session: Session) -> dict[str, Any]:
    """The next operation to be sent, once there is one."""
    async with asyncio.timeout(60):
        await session.outbox.arrival()
    operation: dict[str, Any] = json.loads(session.outbox.pop())
    return operation


def hears(session: Session, op: str, **fields: Any) -> None:
    """Let the session receive an operation."""
    session.receive(json.dumps({"op": op, **fields}).encode())
