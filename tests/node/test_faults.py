"""Each way in which a connection may fail: what passes is survived, what is permanent is told.

The table is that of ``docs/protocol.md``, section Faults.
"""

from __future__ import annotations

import asyncio
import struct
from collections.abc import AsyncIterator, Awaitable
from contextlib import suppress
from http import HTTPStatus
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.action.actionlib import TestRequest
from fibws.errors import ActionError, HubUnreachable, NodeKilled, NodeReplaced, ServiceLost
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32
from fibws.node import connection
from fibws.srv.std_srvs import Trigger

LOST = 1006
"""Stands for a connection that breaks without a close frame (RFC 6455, section 7.4.1)."""
PASSING_CODES = (1000, 1001, LOST, 1008, 1009, 1011, 1012, 1013, 4429)
PASSING_STATUSES = (408, 425, 429, 500, 502, 503, 504)
ENDING_CODES: dict[int, type[Exception]] = {
    4001: NodeReplaced,
    4002: NodeKilled,
    4401: fibws.NotAuthorized,
    4403: fibws.MissingRight,
}
ENDING_STATUSES = (400, 401, 403, 404)


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes come back at once, so that tests need not wait."""
    for name in ("FIRST_RETRY", "LONGEST_RETRY", "LONGEST_WAIT"):
        monkeypatch.setattr(connection, name, 0.01)


class Gate:
    """A relay in front of a hub, which fails as a test wants.

    Args:
        port: the hub's.
    """

    def __init__(self, port: int) -> None:
        self.url = ""
        self.statuses: list[int] = []
        """The HTTP statuses with which the next handshakes are refused."""
        self._port = port
        self._writers: set[asyncio.StreamWriter] = set()

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Relay one connection."""
        if self.statuses:
            await reader.readuntil(b"\r\n\r\n")
            status = HTTPStatus(self.statuses.pop(0))
            writer.write(f"HTTP/1.1 {status} {status.phrase}\r\nContent-Length: 0\r\n\r\n".encode())
            writer.close()
            return
        from_hub, to_hub = await asyncio.open_connection("127.0.0.1", self._port)
        self._writers.add(writer)
        try:
            await asyncio.wait(
                [
                    asyncio.create_task(_pump(reader, to_hub)),
                    asyncio.create_task(_pump(from_hub, writer)),
                ]
            )
        finally:
            self._writers.discard(writer)
            to_hub.close()
            writer.close()

    def fail(self, code: int) -> None:
        """End all connections with a close code; the hub sees them break."""
        for writer in self._writers:
            if code == LOST:
                writer.transport.abort()
            else:
                writer.write(b"\x88\x02" + struct.pack("!H", code))
                writer.close()


async def _pump(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with suppress(OSError):
        while data := await reader.read(65536):
            writer.write(data)
    writer.close()


@pytest.fixture
async def hub(start_hub: StartHub) -> HubServer:
    return await start_hub()


@pytest.fixture
async def gate(hub: HubServer) -> AsyncIterator[Gate]:
    gate = Gate(hub.port)
    async with await asyncio.start_server(gate.serve, "127.0.0.1", 0) as server:
        gate.url = f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
        yield gate


class Robot:
    """A node with one of everything, and a call and a goal of its own under way."""

    def __init__(self, node: fibws.Node) -> None:
        self.node = node
        self.heard: fibws.Subscription[Int32] = node.subscribe("commands", Int32)
        self.call: asyncio.Task[Any]
        self.goal: asyncio.Task[Any]

    async def set_up(self) -> None:
        node = self.node
        await (await node.advertise("map", Int32, latch=True)).publish(7)
        wheels = await node.advertise("wheels", Int32)
        wheels.set_will(data=0)
        await node.service("ready", Trigger, lambda request: (True, "yes"))
        await node.action_server("act", TestRequest, self._execute)
        client = node.action_client("endless_act", TestRequest)
        await client.wait_for_server()
        self.goal = asyncio.create_task((await client.send({})).result())
        self.call = asyncio.create_task(node.call("endless", Trigger))

    async def _execute(self, goal: Any) -> dict[str, Any]:
        return {}


class Other:
    """A node at the hub itself, whose service and action never answer."""

    def __init__(self, node: fibws.Node) -> None:
        self.node = node
        self.calls = 0
        self.news = asyncio.Event()

    async def set_up(self) -> None:
        await self.node.service("endless", Trigger, self._wait)
        await self.node.action_server("endless_act", TestRequest, self._execute)

    async def _wait(self, request: Any) -> Any:
        self._count()
        await asyncio.Event().wait()

    async def _execute(self, goal: Any) -> dict[str, Any]:
        self._count()
        await asyncio.Event().wait()
        return {}

    def _count(self) -> None:
        self.calls += 1
        self.news.set()

    async def is_waited_for(self) -> None:
        """Wait until the call and the goal have come."""
        while self.calls < 2:
            self.news.clear()
            await self.news.wait()


async def check_all_is_back(hub: HubServer, robot: Robot, other: fibws.Node) -> None:
    """Use everything that the robot has registered."""
    assert (await other.wait_for_message("map", Int32)).data == 7
    await other.wait_for_service("ready")
    assert (await other.call("ready", Trigger)).message == "yes"
    commands = await other.advertise("commands", Int32, latch=True)
    await commands.publish(5)
    assert (await anext(robot.heard)).data == 5
    client = other.action_client("act", TestRequest)
    await client.wait_for_server()
    await (await client.send({})).result()
    session: Any = hub.graph.nodes["/robot"]
    assert len(session.topics._wills) == 1


async def error_of(awaitable: Awaitable[Any]) -> BaseException:
    with pytest.raises(Exception) as caught:
        await awaitable
    return caught.value


@pytest.mark.parametrize(
    ("code", "statuses"),
    [(code, ()) for code in PASSING_CODES] + [(LOST, (each, each)) for each in PASSING_STATUSES],
)
async def test_what_passes_is_survived(
    hub: HubServer, gate: Gate, code: int, statuses: tuple[int, ...]
) -> None:
    async with (
        asyncio.timeout(PATIENCE),
        fibws.Node("other", hub=hub.url) as other,
        fibws.Node("robot", hub=gate.url) as node,
    ):
        waiting = Other(other)
        await waiting.set_up()
        robot = Robot(node)
        await robot.set_up()
        await waiting.is_waited_for()
        gate.statuses.extend(statuses)
        gate.fail(code)
        assert type(await error_of(robot.call)) is ServiceLost
        assert type(await error_of(robot.goal)) is ActionError
        await node.flush()
        assert not gate.statuses
        await check_all_is_back(hub, robot, other)


@pytest.mark.parametrize(
    ("code", "status", "error"),
    [(code, None, error) for code, error in ENDING_CODES.items()]
    + [(LOST, status, HubUnreachable) for status in ENDING_STATUSES],
)
async def test_what_is_permanent_ends_the_node(
    hub: HubServer, gate: Gate, code: int, status: int | None, error: type[Exception]
) -> None:
    async with asyncio.timeout(PATIENCE), fibws.Node("other", hub=hub.url) as other:
        waiting = Other(other)
        await waiting.set_up()
        async with fibws.Node("robot", hub=gate.url, token="secret") as node:
            robot = Robot(node)
            await robot.set_up()
            await waiting.is_waited_for()
            gate.statuses.extend([status] if status is not None else [])
            gate.fail(code)
            lost = (error,) if status is None else (error, ServiceLost, ActionError)
            assert isinstance(await error_of(robot.call), lost)
            assert isinstance(await error_of(robot.goal), lost)
            assert type(await error_of(node.spin())) is error
            assert type(await error_of(anext(robot.heard))) is error
        assert not gate.statuses


@pytest.mark.parametrize("status", PASSING_STATUSES)
async def test_node_waits_for_a_hub_without_room(gate: Gate, status: int) -> None:
    gate.statuses = [status] * 3
    async with asyncio.timeout(PATIENCE), fibws.Node("robot", hub=gate.url) as node:
        assert not gate.statuses
        await node.flush()


@pytest.mark.parametrize("status", ENDING_STATUSES)
async def test_refused_node_is_not_entered(gate: Gate, status: int) -> None:
    gate.statuses = [status] * 3
    async with asyncio.timeout(PATIENCE):
        with pytest.raises(HubUnreachable, match=f"HTTP {status}"):
            async with fibws.Node("robot", hub=gate.url):
                pytest.fail("the hub refuses it")
    assert len(gate.statuses) == 2, "the node tried again"
