"""A ROS 2 program that does not read costs the others nothing."""

from __future__ import annotations

import asyncio
import signal
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process, create_subprocess_exec
from collections.abc import AsyncIterator, Awaitable, Callable
from itertools import count
from pathlib import Path

import pytest
from patience import PATIENCE

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String

from .peer import reaching

TESTS = Path(__file__).parents[2]
ROUNDS, SIZE = 700, 60_000
"""Together twice what fits into the buffers of zenoh and of a connection."""

StartReader = Callable[[str, str], Awaitable[Process]]


@pytest.fixture
async def start_reader(endpoint: str) -> AsyncIterator[StartReader]:
    """Starts a ROS 2 subscriber of a topic in a process."""
    processes: list[Process] = []

    async def start(node: str, topic: str) -> Process:
        process = await create_subprocess_exec(
            *(sys.executable, "-m", "hub.ros2.reader", endpoint, node, topic),
            cwd=TESTS,
            stdin=DEVNULL,
            stdout=PIPE,
        )
        processes.append(process)
        return process

    yield start
    for process in processes:
        process.kill()
        await process.wait()


async def line(process: Process) -> str:
    assert process.stdout is not None
    async with asyncio.timeout(PATIENCE):
        return (await process.stdout.readline()).decode().rstrip()


async def until_line(process: Process, text: str) -> None:
    while await line(process) != text:
        pass


pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes cannot be stopped there")


async def test_subscriber_that_is_stopped_costs_another_one_no_message(
    hub: HubServer, node: fibws.Node, start_reader: StartReader
) -> None:
    stopped = await start_reader("/stopped", "/large")
    reading = await start_reader("/reading", "/small")
    large = await node.advertise("/large", String, queue_size=5, peers=True)
    small = await node.advertise("/small", String, queue_size=100, peers=True)
    await reaching(large, "/stopped")
    await reaching(small, "/reading")
    lost: list[str] = []
    hub.graph.watch("node", lambda name: lost.append(name) if name == "/stopped" else None)

    async def publish(number: int, text: str) -> None:
        """Publish for both, and wait until the one that reads has got it."""
        await large.publish(data=text)
        await small.publish(data=str(number))
        assert await line(reading) == str(number)

    stopped.send_signal(signal.SIGSTOP)
    for number in range(ROUNDS):
        await publish(number, "x" * SIZE)
    stopped.send_signal(signal.SIGCONT)
    goes_on = asyncio.create_task(until_line(stopped, "end"))
    for number in count(ROUNDS):
        await publish(number, "end")
        if goes_on.done():
            break
    # zenoh disconnects a receiver that it has waited for in vain.
    assert not lost


@pytest.mark.long
async def test_hub_ends_while_a_subscriber_is_stopped(
    hub: HubServer, node: fibws.Node, start_reader: StartReader, caplog: pytest.LogCaptureFixture
) -> None:
    stopped = await start_reader("/stopped", "/large")
    large = await node.advertise("/large", String, queue_size=5, peers=True)
    await reaching(large, "/stopped")
    stopped.send_signal(signal.SIGSTOP)
    async with node.subscribe("/large", String, queue_size=5) as own:
        for _ in range(ROUNDS):
            await large.publish(data="x" * SIZE)
            await anext(own)
    await hub.close()
    assert "zenoh" not in caplog.text
