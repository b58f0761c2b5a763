"""A hub that ROS 2 nodes can join, and programs on its zenoh network."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub

import fibws
from fibws.hub.server import HubServer

pytest.importorskip("zenoh")
pytest.importorskip("xxhash")

from ..zenoh_endpoints import ANY_PORT, listens_at, zenoh_config
from .peer import Peer

StartRos2Hub = Callable[..., Awaitable[tuple[HubServer, str]]]
StartPeer = Callable[[], Awaitable[Peer]]


@pytest.fixture
def start_ros2_hub(start_hub: StartHub, tmp_path: Path) -> StartRos2Hub:
    """Starts a hub that ROS 2 nodes can join; returns it and their endpoint."""

    async def start(**settings: Any) -> tuple[HubServer, str]:
        config = zenoh_config(tmp_path)
        hub = await start_hub(ros2=(ANY_PORT,), zenoh_config=config, **settings)
        assert hub.ros2 is not None
        return hub, await listens_at(hub.ros2.network._session)

    return start


@pytest.fixture
async def started(start_ros2_hub: StartRos2Hub) -> tuple[HubServer, str]:
    return await start_ros2_hub()


@pytest.fixture
def hub(started: tuple[HubServer, str]) -> HubServer:
    return started[0]


@pytest.fixture
def endpoint(started: tuple[HubServer, str]) -> str:
    """Where ROS 2 nodes join the hub."""
    return started[1]


@pytest.fixture
async def start_peer(hub: HubServer, endpoint: str) -> AsyncIterator[StartPeer]:
    async with AsyncExitStack() as stack:

        async def start() -> Peer:
            return await stack.enter_async_context(Peer(endpoint))

        yield start


@pytest.fixture
async def peer(start_peer: StartPeer) -> Peer:
    return await start_peer()


@pytest.fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("ours", hub=hub.url) as node:
        yield node
