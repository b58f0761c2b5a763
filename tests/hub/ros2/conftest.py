"""A hub that ROS 2 nodes can join, and programs on its zenoh network."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack

import pytest
from conftest import StartHub
from running_programs import free_port

import fibws
from fibws.hub import Hub

pytest.importorskip("zenoh")
pytest.importorskip("xxhash")

from .peer import Peer

StartPeer = Callable[[], Awaitable[Peer]]


@pytest.fixture
def endpoint() -> str:
    return f"tcp/127.0.0.1:{free_port()}"


@pytest.fixture
async def hub(start_hub: StartHub, endpoint: str) -> Hub:
    return await start_hub(ros2=(endpoint,))


@pytest.fixture
async def start_peer(hub: Hub, endpoint: str) -> AsyncIterator[StartPeer]:
    async with AsyncExitStack() as stack:

        async def start() -> Peer:
            return await stack.enter_async_context(Peer(endpoint))

        yield start


@pytest.fixture
async def peer(start_peer: StartPeer) -> Peer:
    return await start_peer()


@pytest.fixture
async def node(hub: Hub) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("ours", hub=hub.url) as node:
        yield node
