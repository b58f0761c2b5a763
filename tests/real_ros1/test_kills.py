"""Nodes and the hub may be killed at any time: nobody else loses anything."""

from __future__ import annotations

import asyncio
import os
import xmlrpc.client
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from patience import PATIENCE

import fibws
from fibws.msg import std_msgs

from .world import Program, World, until

pytestmark = [pytest.mark.real_ros, pytest.mark.slow]

COUNTER = Path(__file__).parent / "scripts" / "counter.py"
PYTHON = "/usr/bin/python3"
"""Debian's, which its ROS packages are installed for."""
RELAYS = 12


async def chain(ros: World) -> tuple[Program, list[Program]]:
    """Start a node that counts, and relays through which the numbers come back to it."""
    topics = ["/start", *(f"/link{number}" for number in range(1, RELAYS)), "/end"]
    relays = [
        await ros.program("/usr/lib/topic_tools/relay", source, target, f"__name:=relay{number}")
        for number, (source, target) in enumerate(pairwise(topics))
    ]
    counter = await ros.program(PYTHON, str(COUNTER))
    await counter.found(r"arrived \d+")
    return counter, relays


async def arrived(counter: Program, more: int = 1) -> None:
    """Wait until the counter has reported further numbers, and none that was lost."""
    wanted = sum(line.startswith("arrived") for line in counter.lines) + more
    await counter.until(
        lambda: sum(line.startswith("arrived") for line in counter.lines) >= wanted, "numbers"
    )
    assert [line for line in counter.lines if line.startswith("lost")] == []


async def nodes_of(ros: World) -> set[str]:
    """Return the names of the nodes in the system's state."""
    state = await call(ros, "getSystemState")
    return {node for part in state for _, nodes in part for node in nodes}


async def call(ros: World, method: str) -> Any:
    """Call a method of the master, and return its value."""

    def run() -> Any:
        with xmlrpc.client.ServerProxy(ros.master) as proxy:
            return getattr(proxy, method)("/test")[2]

    return await asyncio.to_thread(run)


async def test_nodes_notice_nothing_when_the_hub_is_killed(ros: World) -> None:
    counter, _ = await chain(ros)
    # Numbers from before the whole chain was connected do not count.
    counter.lines.clear()
    before = await nodes_of(ros)
    ros_nodes = {"/counter", *(f"/relay{number}" for number in range(RELAYS))}
    assert ros_nodes < before
    await ros.saved(ros_nodes)
    ros.hub.kill()
    await ros.hub.ended()
    await arrived(counter, 2)
    await ros.start_hub()

    async def are_back() -> bool:
        return await nodes_of(ros) == before

    await until(are_back)
    await arrived(counter, 2)
    async with fibws.Node("client", hub=ros.url) as node:
        assert (await node.wait_for_message("/end", std_msgs.Int64, timeout=PATIENCE)).data > 0


async def test_killed_nodes_leave_nothing_behind(ros: World) -> None:
    async with fibws.Node("client", hub=ros.url) as node:
        await node.flush()
        before, files = await nodes_of(ros), open_files(ros)
        counter, relays = await chain(ros)
        await node.wait_for_message("/link1", std_msgs.Int64, timeout=PATIENCE)
        heard = node.subscribe("/end", std_msgs.Int64)
        await anext(heard)
        assert len(await call(ros, "getBusInfo")) >= 1
        for program in (counter, *relays):
            program.kill()
            await program.ended()
        await ros.output("rosnode", "cleanup", given="y\n")
        assert await nodes_of(ros) == {*before, "/client"}  # It subscribes to /end.
        heard.close()

        async def are_links_closed() -> bool:
            return not await call(ros, "getBusInfo") and open_files(ros) <= files

        await until(are_links_closed)


def open_files(ros: World) -> int:
    """Return how many files and connections the hub has open."""
    return len(os.listdir(f"/proc/{ros.hub.process.pid}/fd"))
