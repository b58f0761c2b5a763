"""A hub whose parts are all filled at once: its memory has a bound, and the robot loses nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack, suppress
from pathlib import Path

import pytest
from conftest import StartHub

from fibws.hub.federation.records import LinkMessage
from fibws.hub.server import HubServer
from fibws.hub.settings import KIB, MIB
from fibws.hub.websocket.endpoint import STRANGER_BYTES
from fibws.protocol.websocket import BINARY, client_header

from ..http.test_robot_assets import URDF, write
from ..raw_client import (
    TEXT,
    Client,
    Gone,
    connected,
    dialled,
    frame,
    nodes,
    operation,
    publish,
    until,
)
from ..token_clients import entry

LIMIT = 16 * MIB
STRING = "std_msgs/String"


class Crowd:
    """Clients of one principal that fill a hub's memory, and the most that its parts held."""

    def __init__(self, hub: HubServer, stack: AsyncExitStack, robot: Client) -> None:
        self.hub = hub
        self.most: Counter[str] = Counter()
        self._stack = stack
        self._robot = robot

    async def client(self) -> Client:
        """Connect one that hardly takes anything at its socket."""
        opening = connected(self.hub.port, receive_buffer=4 * KIB, Authorization="Bearer pages")
        return await self._stack.enter_async_context(opening)

    async def dial(self) -> Client:
        """Connect without a handshake, likewise."""
        return await self._stack.enter_async_context(dialled(self.hub.port, receive_buffer=4 * KIB))

    async def stranger(self) -> Client:
        """Connect one without a token."""
        return await self._stack.enter_async_context(connected(self.hub.port))

    async def send(self, client: Client, *data: bytes) -> None:
        """Send something, unless the client was closed; see that the bound holds after it."""
        with suppress(OSError):
            await client.send(*data)
        await self.measure()

    async def measure(self) -> None:
        """See that the bound holds, once the hub has handled what was sent."""
        await self._robot.is_processed()
        account = self.hub._account
        assert account.total() <= LIMIT, account.held()
        self.most |= Counter(account.held())


async def queues(crowd: Crowd) -> None:
    """Let many messages wait for clients that do not read."""
    for number in range(4):
        await (await crowd.client()).send_operation("subscribe", topic=f"/q{number}", type=STRING)
    talker = await crowd.client()
    for number in range(4):
        await talker.send_operation("advertise", topic=f"/q{number}", type=STRING)
    for number in range(40):
        await crowd.send(talker, publish(f"/q{number % 4}", "q" * 300 * KIB))


async def replies(crowd: Crowd) -> None:
    """Ask for much, and do not read it."""
    client = await crowd.client()
    await client.send_operation(
        "call_service", service="/rosapi/set_param", args={"name": "/p", "value": f'"{"p" * MIB}"'}
    )
    for _ in range(12):
        ask = operation("call_service", service="/rosapi/get_param", args={"name": "/p"})
        await crowd.send(client, ask)


async def half_written(crowd: Crowd) -> None:
    """Leave a large message half read, and close."""
    for _ in range(4):
        client = await crowd.client()
        await client.send_operation("subscribe", topic="/large", type=STRING)
        talker = await crowd.client()
        await talker.send_operation("advertise", topic="/large", type=STRING)
        await crowd.send(talker, publish("/large", "l" * 4 * MIB))
        await crowd.send(client, frame(0x8, b"\x03\xe8"))


async def incoming(crowd: Crowd) -> None:
    """Send large messages in part."""
    for _ in range(6):
        client = await crowd.client()
        await crowd.send(client, client_header(BINARY, 40 * MIB), bytes(4 * MIB))


async def fragments(crowd: Crowd) -> None:
    """Send fragments of messages that are never complete."""
    for _ in range(3):
        client = await crowd.client()
        for number in range(6):
            await crowd.send(
                client, operation("fragment", id="a", num=number, total=9, data="f" * MIB)
            )


async def pending(crowd: Crowd) -> None:
    """Publish before anybody has advertised."""
    for number in range(4):
        client = await crowd.client()
        for _ in range(3):
            await crowd.send(client, publish(f"/pending{number}", "p" * 300 * KIB))


async def latched(crowd: Crowd) -> None:
    """Leave latched messages."""
    for number in range(4):
        client = await crowd.client()
        for each in range(8):
            name = f"/latched{number}_{each}"
            await client.send_operation("advertise", topic=name, type=STRING, latch=True)
            await crowd.send(client, publish(name, "l" * 700 * KIB))


async def wills(crowd: Crowd) -> None:
    """Leave wills, which cannot be dropped."""
    for number in range(4):
        client = await crowd.client()
        for each in range(8):
            name, msg = f"/will{number}_{each}", {"data": "w" * 700 * KIB}
            await crowd.send(client, operation("set_will", topic=name, type=STRING, msg=msg))


async def files(crowd: Crowd) -> None:
    """Fetch files, and do not read them."""
    for _ in range(3):
        client = await crowd.dial()
        request = b"GET /assets/package/arm/meshes/a.png HTTP/1.1\r\n"
        await crowd.send(
            client, request + b"Host: localhost\r\nAuthorization: Bearer pages\r\n\r\n"
        )
        await client._until(b"\r\n\r\n")  # A thread has read the file.
        await crowd.measure()


async def strangers(crowd: Crowd) -> None:
    """Send as much as those without a token may."""
    for _ in range(40):
        client = await crowd.stranger()
        head = client_header(BINARY, STRANGER_BYTES)
        await crowd.send(client, head, bytes(STRANGER_BYTES - 1))


ALL = (
    strangers,
    latched,
    wills,
    queues,
    replies,
    half_written,
    incoming,
    fragments,
    pending,
    files,
)
"""What fills each part."""


@pytest.mark.both_loops
@pytest.mark.parametrize("ways", [ALL, ALL[::-1]], ids=["latched first", "files first"])
async def test_all_parts_are_bounded_together_and_the_robot_loses_nothing(
    start_hub: StartHub,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    ways: tuple[Callable[[Crowd], Awaitable[None]], ...],
) -> None:
    write(tmp_path / "ws", "arm", "meshes/a.png", data=bytes(3 * MIB // 2))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ws"))
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(entry("robot", "admin = true") + entry("pages", "admin = true"))
    hub = await start_hub(
        tokens=tokens, max_memory=LIMIT, record=tmp_path / "bags", record_min_space=0
    )
    hub.graph.parameters.set("/robot_description", URDF)
    async with AsyncExitStack() as stack:
        robot = await stack.enter_async_context(
            connected(hub.port, "/?node=/robot", Authorization="Bearer robot")
        )
        await robot.advertises("/map", STRING, latch=True)
        await robot.send(publish("/map", "m" * 500 * KIB))
        await robot.is_processed()
        crowd = Crowd(hub, stack, robot)
        for fill in ways:
            await fill(crowd)
        assert min(crowd.most[part] for part in ("queues", "incoming", "latched")) > MIB
        assert crowd.most["files"] > MIB
        assert crowd.most["parameters"] >= MIB
        assert "recording" in crowd.most
        assert hub._account.total() > LIMIT // 4
        page = await stack.enter_async_context(
            connected(hub.port, "/?node=/page", Authorization="Bearer robot")
        )
        await page.send_operation("subscribe", topic="/map", type=STRING)
        assert await page.receive_data(1) == ["m" * 500 * KIB]
        await robot.is_processed()
    await until(lambda: not nodes(hub))
    await until(lambda: hub._account.total() <= 2 * MIB)


@pytest.mark.both_loops
async def test_client_that_is_closed_is_told_the_setting(start_hub: StartHub) -> None:
    hub = await start_hub(max_memory=4 * MIB)
    async with connected(hub.port) as client:
        await client.send(client_header(BINARY, 40 * MIB), bytes(3 * MIB))
        with suppress(OSError):
            await client.send(bytes(2 * MIB))
        with suppress(Gone):
            code, reason = await client.is_closed()
            assert code == 1013
            assert "--max-memory" in reason
    await until(lambda: not nodes(hub))


@pytest.mark.both_loops
async def test_client_is_told_what_is_latched_no_more(start_hub: StartHub) -> None:
    hub = await start_hub(max_memory=4 * MIB)
    async with connected(hub.port) as client:
        for number in range(5):
            await client.send_operation("advertise", topic=f"/l{number}", type=STRING, latch=True)
            await client.send(publish(f"/l{number}", "l" * MIB))
        opcode, status = await client.frame()
        assert opcode == TEXT
        assert b"/l0" in status and b"(--max-memory)" in status


@pytest.mark.both_loops
async def test_calls_to_the_ros1_master_that_are_never_complete_count(start_hub: StartHub) -> None:
    hub = await start_hub(max_memory=4 * MIB, ros1=0)
    assert hub.ros1 is not None
    head = f"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: {8 * MIB}\r\n\r\n"
    call = (head + "<methodCall><methodName>a</methodName><params><param><value>").encode()
    async with dialled(hub.ros1.port) as small, dialled(hub.ros1.port) as large:
        await small.send(call, b"a" * MIB)
        await until(lambda: hub._account.held()["incoming"] >= MIB)
        with suppress(OSError):
            await large.send(call, b"a" * 3 * MIB)
        with suppress(OSError):
            await large.to_the_end()
        await until(lambda: MIB <= hub._account.held()["incoming"] < 2 * MIB)


async def test_what_waits_for_another_hub_counts(start_hub: StartHub) -> None:
    hub = await start_hub(max_memory=32 * MIB)
    other = await start_hub(join=(hub.url,))
    await until(lambda: bool(hub.federation.peers) and bool(other.federation.peers))
    [backplane] = hub.federation.backplanes
    large = LinkMessage(1, 0, 0, bytes(MIB))
    backplane.publish(large, limit=10)
    [holding] = hub.federation.queued()
    assert holding.measure() == hub._account.held()["queues"] > MIB
    holding.shorten(0, 0, hub._account.bound)
    assert holding.measure() < MIB
    holding.end(hub._account.bound)
    await until(lambda: backplane not in hub.federation.backplanes)
