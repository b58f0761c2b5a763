"""Several hubs in one process, and nodes connected to them."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any, Protocol

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.hub.server import HubServer

from ..zenoh_endpoints import ANY_PORT, listens_at, zenoh_config


class Reachable(Protocol):
    """A hub in this process or in another one."""

    @property
    def url(self) -> str:
        """The address for nodes."""


StartNode = Callable[[str, Reachable], Awaitable[fibws.Node]]
Join = Callable[..., Awaitable[HubServer]]
End = fibws.Publisher[Any, ...] | fibws.Subscription[Any]


async def until(condition: Callable[[], object], *hubs: HubServer) -> None:
    """Wait until a condition holds, checked whenever a graph, or the links of a hub, change."""
    changed = asyncio.Event()
    for hub in hubs:
        hub.graph.watch_topics(lambda topic: changed.set())
        for kind in ("node", "service", "action"):
            hub.graph.watch(kind, lambda name: changed.set())
        hub.graph.parameters.watch(lambda name, node: changed.set())
        hub.federation.watch(changed.set)
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await changed.wait()
            changed.clear()
            await asyncio.sleep(0)  # The change is complete in the next turn.


async def peers_are(end: End, expected: set[str]) -> None:
    """Wait until a publisher or a subscription has these peers."""
    async with asyncio.timeout(PATIENCE):
        async for names in end.peers.changes():
            if set(names) == expected:
                return
    raise AssertionError("the node has ended")


@pytest.fixture(params=["websocket"])
async def join(start_hub: StartHub, request: pytest.FixtureRequest, tmp_path: Path) -> Join:
    """Starts a hub that joins others, and waits until each of them has its links.

    Parameterized with ``zenoh`` it joins them over that.
    """
    if request.param == "zenoh":
        pytest.importorskip("zenoh")
        return _join_by_zenoh(start_hub, zenoh_config(tmp_path))

    async def start(name: str, *others: HubServer, **settings: object) -> HubServer:
        before = [len(other.federation.peers) for other in others]
        hub = await start_hub(hub_name=name, join=tuple(other.url for other in others), **settings)
        await until(
            lambda: (
                len(hub.federation.peers) == len(others)
                and all(
                    len(other.federation.peers) > count
                    for other, count in zip(others, before, strict=True)
                )
            ),
            hub,
            *others,
        )
        return hub

    return start


def _join_by_zenoh(start_hub: StartHub, config: Path) -> Join:
    endpoints: dict[HubServer, str] = {}

    async def start(name: str, *others: HubServer, **settings: object) -> HubServer:
        hub = await start_hub(
            hub_name=name,
            zenoh_listen=(ANY_PORT,),
            zenoh_config=config,
            zenoh=tuple(dict.fromkeys(endpoints[other] for other in others)),
            **settings,
        )
        group = {hub, *others}
        assert hub._zenoh is not None
        endpoints[hub] = await listens_at(hub._zenoh._session)
        ids = {each.federation.hub.id for each in group}
        await until(
            lambda: all(
                ids <= {each.federation.hub.id, *(peer.hub.id for peer in each.federation.peers)}
                for each in group
            ),
            *group,
        )
        return hub

    return start


@pytest.fixture
async def start_node() -> AsyncIterator[StartNode]:
    async with AsyncExitStack() as stack:

        async def start(name: str, hub: Reachable) -> fibws.Node:
            return await stack.enter_async_context(fibws.Node(name, hub=hub.url))

        yield start
