"""Last wills of nodes."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.errors import InvalidMessage, NodeClosed
from fibws.msg.std_msgs import Int32, String


async def test_will_is_published_when_the_node_ends(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with (
        asyncio.timeout(PATIENCE),
        fibws.Node("robot", hub=hub.url) as robot,
        robot.subscribe("cmd", Int32) as commands,
    ):
        await robot.flush()
        async with fibws.Node("driver", hub=hub.url) as driver:
            publisher = await driver.advertise("cmd", Int32)
            publisher.set_will(data=0)
            await publisher.publish(5)
            await driver.flush()
        assert [(await anext(commands)).data for _ in range(2)] == [5, 0]


@pytest.mark.parametrize("withdraw", ["clear_will", "close"])
async def test_will_can_be_taken_back(start_hub: StartHub, withdraw: str) -> None:
    hub = await start_hub()
    async with (
        asyncio.timeout(PATIENCE),
        fibws.Node("robot", hub=hub.url) as robot,
        robot.subscribe("cmd", Int32) as commands,
    ):
        await robot.flush()
        async with fibws.Node("driver", hub=hub.url) as driver:
            publisher = await driver.advertise("cmd", Int32)
            publisher.set_will(Int32(7), timeout=0.5)
            getattr(publisher, withdraw)()
            await driver.flush()
        await (await robot.advertise("cmd", Int32)).publish(1)
        assert (await anext(commands)).data == 1


async def test_will_is_set_again_at_the_next_hub(start_hub: StartHub) -> None:
    first = await start_hub()
    async with asyncio.timeout(PATIENCE), fibws.Node("driver", hub=first.url) as driver:
        publisher = await driver.advertise("cmd", Int32)
        publisher.set_will(data=0, timeout=100)
        await driver.flush()
        await first.close()
        second = await start_hub(port=first.port)
        await driver.flush()
        session: Any = second.graph.nodes["/driver"]
        assert len(session.topics._wills) == 1


async def test_invalid_will_is_refused_by_the_node(start_hub: StartHub) -> None:
    hub = await start_hub()
    async with fibws.Node("driver", hub=hub.url) as driver:
        publisher = await driver.advertise("cmd", Int32)
        with pytest.raises(InvalidMessage):
            publisher.set_will(data="x")
        with pytest.raises(TypeError):
            publisher.set_will(String("x"))  # type: ignore[call-overload]
        for timeout in (0, -1, 1e9):
            with pytest.raises(ValueError, match="timeout"):
                publisher.set_will(data=0, timeout=timeout)
        publisher.close()
        with pytest.raises(NodeClosed):
            publisher.set_will(data=0)
