"""A hub on a zenoh network that does not read costs the others nothing."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from asyncio.subprocess import DEVNULL, create_subprocess_exec
from itertools import count
from pathlib import Path

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.msg.std_msgs import String

pytest.importorskip("zenoh")

from ..zenoh_endpoints import ANY_PORT, listens_at, zenoh_config
from .conftest import StartNode, until
from .networks import ROOT, WITH_LEASE
from .test_federation import peers

ROUNDS, SIZE = 700, 60_000
"""Together twice what fits into the buffers of zenoh and of a connection."""


@pytest.mark.skipif(sys.platform == "win32", reason="processes cannot be stopped there")
async def test_hub_that_is_stopped_costs_another_one_no_message_nor_announcement(
    start_hub: StartHub, start_node: StartNode, tmp_path: Path
) -> None:
    source = await start_hub(zenoh_listen=(ANY_PORT,), zenoh_config=zenoh_config(tmp_path))
    assert source._zenoh is not None
    endpoint = await listens_at(source._zenoh._session)
    reading = await start_hub(zenoh=(endpoint,))
    url = tmp_path / "url"
    process = await create_subprocess_exec(
        *(sys.executable, "-c", WITH_LEASE.format(3600.0), "--port", "0"),
        *("--zenoh", endpoint, "--url-file", str(url)),
        stdin=DEVNULL,
        stdout=DEVNULL,
        stderr=DEVNULL,
        cwd=ROOT,
        env={name: value for name, value in os.environ.items() if "FIBWS" not in name},
    )
    try:
        await until(lambda: len(source.federation.peers) == 2, source)
        talker = await start_node("talker", source)
        large = await talker.advertise("large", String, queue_size=5, peers=True)
        small = await talker.advertise("small", String, queue_size=100, peers=True)
        viewer = await start_node("viewer", reading)
        numbers = aiter(viewer.subscribe("small", String, queue_size=100))
        ended = asyncio.Event()
        async with fibws.Node("stopped", hub=url.read_text().strip()) as node:
            node.subscribe("large", String)._hand_to(
                lambda message: ended.set() if message.data == "end" else None
            )
            await peers(large, 1)
            await peers(small, 1)
            lost: list[str] = []
            source.graph.watch(
                "node", lambda name: lost.append(name) if name == "/stopped" else None
            )

            async def publish(number: int, text: str) -> None:
                """Publish for both, and wait until the one that reads has got it."""
                await large.publish(data=text)
                await small.publish(data=str(number))
                async with asyncio.timeout(PATIENCE):
                    assert (await anext(numbers)).data == str(number)

            process.send_signal(signal.SIGSTOP)
            for number in range(ROUNDS):
                await publish(number, "x" * SIZE)
            late = await talker.advertise("late", String, peers=True)
            await until(lambda: "/late" in reading.graph.topics, reading)
            process.send_signal(signal.SIGCONT)
            for number in count(ROUNDS):
                await publish(number, "end")
                if ended.is_set():
                    break
            # It learns what it has missed.
            node.subscribe("late", String)
            await peers(late, 1)
            # zenoh disconnects a receiver that it has waited for in vain.
            assert not lost
    finally:
        process.kill()
        await process.wait()
