"""The listener, which fills a buffer from /tf and /tf_static."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable

import pytest
from patience import PATIENCE

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Header, String
from fibws.msg.tf2_msgs import TFMessage
from fibws.tf import Buffer, TransformListener
from fibws.tf.errors import InvalidTransform, UnknownFrame
from fibws.tf.history import Sample

from .conftest import Publish


class Known:
    """A buffer that is being filled."""

    def __init__(self, node: fibws.Node) -> None:
        self.buffer = Buffer()
        self.listener = TransformListener(node, self.buffer)

    async def lookup(self, target: str, source: str) -> Sample:
        """The transform, once it is known."""
        return await self.listener.wait(target, source, timeout=PATIENCE)


@pytest.fixture
async def known(hub: HubServer) -> AsyncIterator[Known]:
    async with fibws.Node("robot", hub=hub.url) as node:
        known = Known(node)
        running = asyncio.create_task(known.listener.run())
        yield known
        running.cancel()


async def test_moving_and_static_frames_are_received(known: Known, publish: Publish) -> None:
    await publish(("base", "map", 1), ("wheel", "base", 10))
    await publish(("camera", "base", 100), static=True)
    assert (await known.lookup("map", "camera")).transform.translation == (101.0, 0.0, 0.0)
    assert (await known.lookup("camera", "wheel")).transform.translation == (-90.0, 0.0, 0.0)


async def test_all_that_wait_get_their_transforms(known: Known, publish: Publish) -> None:
    waiting = [asyncio.create_task(known.lookup("map", frame)) for frame in ("base", "arm", "hand")]
    await publish(("base", "map", 1), ("hand", "arm", 3))
    await publish(("arm", "base", 2), static=True)
    found = [(await each).transform.translation[0] for each in waiting]
    assert found == [1, 3, 6]


async def test_waiting_ends_in_time(known: Known, publish: Publish) -> None:
    await publish(("camera", "base", 1), static=True)
    await known.lookup("base", "camera")
    with pytest.raises(UnknownFrame, match="moon"):
        await known.listener.wait("base", "moon", timeout=0.05)
    with pytest.raises(InvalidTransform):
        await known.listener.wait("base", "")


async def test_invalid_transform_is_logged_once_per_frame(
    known: Known,
    node: fibws.Node,
    publish: Publish,
    line: Callable[[str], Awaitable[Log]],
) -> None:
    topic = await node.advertise("/tf", TFMessage)
    for frame in ("base", "base", "arm"):
        wrong = TransformStamped(header=Header(frame_id="map"), child_frame_id=frame)
        await topic.publish(TFMessage([wrong]))
    await publish(("good", "map", 1))
    await known.lookup("map", "good")
    first = await line("Ignored")
    assert (first.level, first.name) == (Log.WARN, "/robot")
    assert first.msg.startswith("Ignored a transform on /tf: 'base': the rotation (0.0, 0.0, 0.0,")
    assert "'arm'" in (await line("Ignored")).msg


@pytest.mark.parametrize("topic", ["/tf", "/tf_static"])
async def test_publisher_of_another_type_keeps_no_transforms_out(
    hub: HubServer, publish: Publish, topic: str
) -> None:
    async with fibws.Node("wrong", hub=hub.url) as wrong, fibws.Node("robot", hub=hub.url) as node:
        await wrong.advertise(topic, String)
        known = Known(node)
        running = asyncio.create_task(known.listener.run())
        await node.graph.nodes()  # The hub has its subscriptions by then.
        await publish(("base", "map", 1), static=topic == "/tf_static")
        await known.lookup("map", "base")
        running.cancel()


async def test_listener_ends_with_its_node(hub: HubServer) -> None:
    async with fibws.Node("robot", hub=hub.url) as node:
        running = asyncio.create_task(TransformListener(node, Buffer()).run())
        await node.graph.nodes()
    async with asyncio.timeout(PATIENCE):
        await running
