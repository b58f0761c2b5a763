"""A hub that is a ROS 1 master, and nodes of both worlds."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack

import pytest
from conftest import StartHub

import fibws
from fibws.hub.server import HubServer

from .peer import Peer

StartPeer = Callable[..., Awaitable[Peer]]


@pytest.fixture
async def hub(start_hub: StartHub) -> HubServer:
    return await start_hub(ros1=0)


@pytest.fixture
async def start_peer(hub: HubServer) -> AsyncIterator[StartPeer]:
    assert hub.ros1 is not None
    master = hub.ros1.uri
    async with AsyncExitStack() as stack:

        async def start(name: str, *, pid: int = 4242) -> Peer:
            return await stack.enter_async_context(Peer(name, master, pid=pid))

        yield start


@pytest.fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("client", hub=hub.url) as node:
        yield node
