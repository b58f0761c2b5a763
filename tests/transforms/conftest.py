"""Nodes at a real hub, and the republisher among them."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import suppress
from typing import TypeAlias

import pytest
from patience import PATIENCE
from running_programs import start as start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf.history import Sample
from fibws.tf.messages import write
from fibws.tf.republisher import Republisher
from fibws.tf.transform import Transform

Place: TypeAlias = tuple[str, str, float]
"""A frame, its parent, and how far along x it is there."""


Publish: TypeAlias = Callable[..., Awaitable[None]]
Transforms: TypeAlias = Sequence[TransformStamped]


@pytest.fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    """A node for clients of the republisher."""
    async with fibws.Node("client", hub=hub.url) as node:
        yield node


@pytest.fixture
async def republisher(hub: HubServer, node: fibws.Node) -> AsyncIterator[Republisher]:
    """A republisher at work."""
    async with fibws.Node("tf2_web_republisher", hub=hub.url) as serving:
        republisher = Republisher(serving)
        task = asyncio.create_task(republisher.run())
        await node.wait_for_service("republish_tfs", timeout=PATIENCE)
        yield republisher
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


@pytest.fixture
async def publish(node: fibws.Node) -> Publish:
    """Publishes where frames are, in one message."""
    topics = {
        False: await node.advertise("/tf", TFMessage),
        True: await node.advertise("/tf_static", TFMessage, latch=True),
    }

    async def publish(*places: Place, static: bool = False) -> None:
        stamp = node.now().to_nanoseconds()
        transforms = [
            write(frame, Sample(stamp, parent, Transform((x, 0.0, 0.0))))
            for frame, parent, x in places
        ]
        await topics[static].publish(TFMessage(transforms))

    return publish


def places(transforms: Transforms) -> list[Place]:
    return [
        (each.child_frame_id, each.header.frame_id, each.transform.translation.x)
        for each in transforms
    ]


@pytest.fixture
def line(node: fibws.Node) -> Callable[[str], Awaitable[Log]]:
    """Waits for the next line on /rosout with a text."""
    lines = node.subscribe("/rosout", Log, queue_size=1000)

    async def line(text: str) -> Log:
        async with asyncio.timeout(PATIENCE):
            while text not in (entry := await anext(lines)).msg:
                pass
        return entry

    return line
