"""A hub that restarts again and again, under many nodes, with tokens and limits."""

from __future__ import annotations

import asyncio
import random
from contextlib import AsyncExitStack
from pathlib import Path
from typing import cast

import pytest
from conftest import StartHub

import fibws
from fibws.access.token_file import digest_of
from fibws.msg.std_msgs import Int64

NODES = 50
RESTARTS = 20
LATEST = -1
"""What a node publishes after the last restart."""


class Ring:
    """Nodes of which each publishes numbers, latched, and hears those of the next one.

    Args:
        hub: the hub's URL.
    """

    def __init__(self, hub: str) -> None:
        self._hub = hub
        self._publishers: list[fibws.Publisher[Int64]] = []
        self._subscriptions: list[fibws.Subscription[Int64]] = []
        self.nodes: list[fibws.Node] = []
        self.heard: list[list[int]] = [[] for _ in range(NODES)]
        self.sent = 0

    async def start(self, stack: AsyncExitStack) -> None:
        for number in range(NODES):
            node = fibws.Node(f"node_{number}", hub=self._hub, token=f"token-{number}")
            self.nodes.append(await stack.enter_async_context(node))
            latched = await node.advertise(f"numbers_{number}", Int64, latch=True, queue_size=1)
            self._publishers.append(latched)
        for number, node in enumerate(self.nodes):
            next_ = (number + 1) % NODES
            self._subscriptions.append(node.subscribe(f"numbers_{next_}", Int64))

    async def listen(self, number: int) -> None:
        """Hear numbers until the last one."""
        async for message in self._subscriptions[number]:
            self.heard[number].append(message.data)
            if message.data == LATEST:
                return

    async def publish(self) -> None:
        """Have each node publish the next number."""
        self.sent += 1
        for publisher in self._publishers:
            await publisher.publish(self.sent)

    async def publish_last(self) -> None:
        for publisher in self._publishers:
            await publisher.publish(LATEST)


@pytest.mark.slow  # 20 restarts, each of which 50 nodes notice and survive.
async def test_all_nodes_are_back_after_many_restarts(
    start_hub: StartHub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tokens = tmp_path / "tokens.toml"
    # One connection each: a node that comes back must not stand in its own way.
    rights = 'allow = {node = ["/**"], publish = ["/**"], subscribe = ["/**"]}'
    limits = "limits = {connections = 1}"
    tokens.write_text(
        "\n".join(
            f'[tokens.t{number}]\nsha256 = "{digest_of(f"token-{number}")}"\n{rights}\n{limits}\n'
            for number in range(NODES)
        )
    )
    chance = random.Random(0)
    # Fewer handshakes than nodes that come back at once: most are told to try again.
    monkeypatch.setattr("fibws.hub.websocket.quotas.LEAST_MESSAGES", 10)
    refused = 0
    settings = {"tokens": tokens, "max_address_handshakes_per_second": 20}
    hub = await start_hub(**settings)
    port = hub.port
    async with asyncio.timeout(110), AsyncExitStack() as stack:
        ring = Ring(hub.url)
        await ring.start(stack)
        listening = [asyncio.create_task(ring.listen(number)) for number in range(NODES)]
        for _ in range(RESTARTS):
            await ring.publish()
            if chance.random() < 0.5:
                await asyncio.gather(*(node.flush() for node in ring.nodes))
            refused += cast(int, hub.health()["refused"])
            await hub.close()
            await ring.publish()
            hub = await start_hub(port=port, **settings)
        await ring.publish_last()
        await asyncio.gather(*listening)
        assert len(hub.graph.nodes) > NODES
        assert refused  # How many depends on how long each restart takes.
    for heard in ring.heard:
        # Latched messages are sent again by each connection; apart from that, all are in order.
        assert heard[-1] == LATEST
        assert heard[:-1] == sorted(heard[:-1])
