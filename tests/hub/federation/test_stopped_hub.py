"""A hub on a zenoh network that does not read costs the others nothing."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from asyncio.subprocess import DEVNULL, Process, create_subprocess_exec
from collections.abc import AsyncIterator
from contextlib import suppress
from itertools import count
from pathlib import Path

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String
from fibws.srv.diagnostic_msgs import AddDiagnostics

pytest.importorskip("zenoh")

from ..zenoh_endpoints import ANY_PORT, listens_at, zenoh_config
from .conftest import StartNode, until
from .networks import ROOT, WITH_LEASE
from .test_federation import peers

ROUNDS, SIZE = 700, 60_000
"""Together twice what fits into the buffers of zenoh and of a connection."""
CALLS, CALL = 90, 400_000
"""Calls, and the bytes of each, that do not fit into these buffers."""


pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes cannot be stopped there")


class Hubs:
    """Three hubs on a zenoh network, of which one can be stopped.

    Attributes:
        source: sends something to the two others.
        reading: reads all the time.
        process: of the third one, at ``url``, with the node ``/stopped``.
        lost: the nodes of the third one that the source has lost.
    """

    def __init__(self, source: HubServer, reading: HubServer, process: Process, url: str) -> None:
        self.source, self.reading = source, reading
        self.process, self.url = process, url
        self.lost: list[str] = []

    def watch(self) -> None:
        """Note from now on whether the third hub is lost: zenoh disconnects a receiver for which
        something waits in vain."""
        self.source.graph.watch("node", self._changed)

    def _changed(self, name: str) -> None:
        if name == "/stopped" and name not in self.source.graph.nodes:
            self.lost.append(name)


@pytest.fixture
async def hubs(start_hub: StartHub, tmp_path: Path) -> AsyncIterator[Hubs]:
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
        yield Hubs(source, reading, process, url.read_text().strip())
    finally:
        with suppress(ProcessLookupError):
            process.kill()
        await process.wait()


async def test_hub_that_is_stopped_costs_another_one_no_message_nor_announcement(
    hubs: Hubs, start_node: StartNode
) -> None:
    talker = await start_node("talker", hubs.source)
    large = await talker.advertise("large", String, queue_size=5, peers=True)
    small = await talker.advertise("small", String, queue_size=100, peers=True)
    viewer = await start_node("viewer", hubs.reading)
    numbers = aiter(viewer.subscribe("small", String, queue_size=100))
    ended = asyncio.Event()
    async with fibws.Node("stopped", hub=hubs.url) as node:
        node.subscribe("large", String)._hand_to(
            lambda message: ended.set() if message.data == "end" else None
        )
        await peers(large, 1)
        await peers(small, 1)
        hubs.watch()

        async def publish(number: int, text: str) -> None:
            """Publish for both, and wait until the one that reads has got it."""
            await large.publish(data=text)
            await small.publish(data=str(number))
            async with asyncio.timeout(PATIENCE):
                assert (await anext(numbers)).data == str(number)

        hubs.process.send_signal(signal.SIGSTOP)
        for number in range(ROUNDS):
            await publish(number, "x" * SIZE)
        late = await talker.advertise("late", String, peers=True)
        await until(lambda: "/late" in hubs.reading.graph.topics, hubs.reading)
        hubs.process.send_signal(signal.SIGCONT)
        for number in count(ROUNDS):
            await publish(number, "end")
            if ended.is_set():
                break
        # It learns what it has missed.
        node.subscribe("late", String)
        await peers(late, 1)
        assert not hubs.lost


async def test_calls_for_a_hub_that_is_stopped_delay_none_for_another_one(
    hubs: Hubs, start_node: StartNode
) -> None:
    caller = await start_node("caller", hubs.source)
    server = await start_node("server", hubs.reading)
    await server.service("echo", AddDiagnostics, lambda request: {"success": True})
    async with fibws.Node("stopped", hub=hubs.url) as node:
        await node.service("store", AddDiagnostics, lambda request: {"success": True})
        services = hubs.source.graph.services
        await until(lambda: {"/store", "/echo"} <= services.keys(), hubs.source)
        hubs.watch()
        hubs.process.send_signal(signal.SIGSTOP)
        request = {"load_namespace": "x" * CALL}
        calls = [
            asyncio.create_task(caller.call("/store", AddDiagnostics, request))
            for _ in range(CALLS)
        ]
        try:
            await asyncio.sleep(0)  # The tasks have begun.
            await caller.flush()
            response = await caller.call("/echo", AddDiagnostics, request)
            assert response.success
            assert not hubs.lost
        finally:
            hubs.process.kill()
            await asyncio.gather(*calls, return_exceptions=True)
