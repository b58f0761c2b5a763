"""Messages that are larger than the hub, or the node, takes."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.action.actionlib import TestRequest
from fibws.action.nav_msgs import GetMap
from fibws.errors import ActionError, MessageTooLarge
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32, String
from fibws.srv.roscpp import SetLoggerLevel
from fibws.srv.rospy_tutorials import AddTwoInts
from fibws.srv.std_srvs import Trigger

LIMIT = 20_000
LARGE = "x" * LIMIT
HEAD = 5 + 4
"""Bytes of a published String besides its text: the frame's head, and the text's length."""


@pytest.fixture
async def hub(start_hub: StartHub) -> HubServer:
    return await start_hub(max_message_size=LIMIT)


async def latched(node: fibws.Node) -> None:
    await (await node.advertise("large", String, latch=True)).publish(LARGE)


async def published(node: fibws.Node) -> None:
    await (await node.advertise("large", String)).publish(data=LARGE)


async def sent(node: fibws.Node) -> None:
    publisher = await node.advertise("large", String)
    publisher._send(publisher._encode(LARGE))


async def sent_as_bytes(node: fibws.Node) -> None:
    publisher = await node.advertise("large", String)
    publisher._send(publisher._encode_serialized(b"\0" * LIMIT))


async def sent_to_one(node: fibws.Node) -> None:
    publisher = await node.advertise("large", String)
    publisher._send(publisher._encode_to("/other", String(LARGE)))


async def will(node: fibws.Node) -> None:
    (await node.advertise("large", String)).set_will(data=LARGE)


async def parameter(node: fibws.Node) -> None:
    await node.params.set("/large", LARGE)


async def called(node: fibws.Node) -> None:
    await node.call("large", SetLoggerLevel, {"logger": LARGE})


async def goal(node: fibws.Node) -> None:
    client = node.action_client("large", TestRequest)
    await client.send({"result_text": LARGE})


@pytest.mark.parametrize(
    "act",
    [published, latched, sent, sent_as_bytes, sent_to_one, will, parameter, called, goal],
)
async def test_what_the_hub_does_not_take_is_an_error_of_its_causer(
    hub: HubServer, act: Callable[[fibws.Node], Awaitable[None]]
) -> None:
    async with (
        asyncio.timeout(PATIENCE),
        fibws.Node("robot", hub=hub.url) as node,
        node.subscribe("numbers", Int32) as numbers,
    ):
        publisher = await node.advertise("numbers", Int32)
        with pytest.raises(MessageTooLarge, match=rf"large.*\(limit {LIMIT}, --max-message-size"):
            await act(node)
        await publisher.publish(7)
        assert (await anext(numbers)).data == 7


async def test_largest_message_is_sent(hub: HubServer) -> None:
    async with (
        asyncio.timeout(PATIENCE),
        fibws.Node("robot", hub=hub.url) as node,
        node.subscribe("large", String) as texts,
    ):
        publisher = await node.advertise("large", String)
        await publisher.publish("x" * (LIMIT - HEAD))
        assert len((await anext(texts)).data) == LIMIT - HEAD
        with pytest.raises(MessageTooLarge):
            await publisher.publish("x" * (LIMIT - HEAD + 1))


async def test_response_that_the_hub_does_not_take_fails_the_call(hub: HubServer) -> None:
    async with asyncio.timeout(PATIENCE), fibws.Node("robot", hub=hub.url) as node:
        await node.service("large", Trigger, lambda request: (True, LARGE))
        with pytest.raises(fibws.ServiceError, match=f"limit {LIMIT}"):
            await node.call("large", Trigger)
        await node.service("add", AddTwoInts, lambda request: request.a + request.b)
        assert (await node.call("add", AddTwoInts, {"a": 1, "b": 2})).sum == 3


@pytest.mark.parametrize("over", ["topics", "operations"])
async def test_result_that_the_hub_does_not_take_aborts_the_goal(hub: HubServer, over: Any) -> None:
    async def execute(goal: Any) -> dict[str, Any]:
        return {"map": {"data": [0] * LIMIT}}

    async with asyncio.timeout(PATIENCE), fibws.Node("robot", hub=hub.url) as node:
        await node.action_server("large", GetMap, execute, over=over)
        client = node.action_client("large", GetMap, over=over)
        await client.wait_for_server()
        sent = await client.send({})
        with pytest.raises(ActionError, match=f"limit {LIMIT}") as error:
            await sent.result()
        assert error.value.status == fibws.GoalStatus.ABORTED


@pytest.mark.long
async def test_messages_that_another_hub_does_not_take_are_dropped(start_hub: StartHub) -> None:
    first = await start_hub()
    async with asyncio.timeout(PATIENCE), fibws.Node("robot", hub=first.url) as node:
        kept = await node.advertise("kept", String, latch=True)
        queued = await node.advertise("queued", String)
        await kept.publish(LARGE)
        await node.flush()
        await first.close()
        await queued.publish(LARGE)
        await queued.publish("small")
        second = await start_hub(port=first.port, max_message_size=LIMIT)
        async with fibws.Node("other", hub=second.url) as other:
            texts = other.subscribe("queued", String)
            await other.flush()
            assert (await anext(texts)).data == "small"
        assert queued.dropped == 1
        await second.close()
        third = await start_hub(port=first.port)  # It would take the latched message.
        await node.flush()
        async with fibws.Node("other", hub=third.url) as other:
            texts = other.subscribe("kept", String)
            await other.flush()
            await kept.publish("small")
            assert (await anext(texts)).data == "small"


class TestReceiving:
    async def test_too_large_messages_are_dropped_and_counted(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with (
            asyncio.timeout(PATIENCE),
            fibws.Node("talker", hub=hub.url) as talker,
            fibws.Node("ear", hub=hub.url, max_message_size=LIMIT) as ear,
            ear.subscribe("texts", String) as texts,
        ):
            await ear.flush()
            publisher = await talker.advertise("texts", String, latch=True)
            for text in ("a", LARGE, "b", LARGE):
                await publisher.publish(text)
            await publisher.publish("c")
            assert [(await anext(texts)).data for _ in range(3)] == ["a", "b", "c"]
            assert texts.dropped == 2

    async def test_too_large_response_fails_the_call(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with (
            asyncio.timeout(PATIENCE),
            fibws.Node("server", hub=hub.url) as server,
            fibws.Node("ear", hub=hub.url, max_message_size=LIMIT) as ear,
        ):
            await server.service("large", Trigger, lambda request: (True, LARGE))
            with pytest.raises(fibws.ServiceError, match=f"limit {LIMIT}"):
                await ear.call("large", Trigger)

    @pytest.mark.parametrize("value", ["0", "-1", "many", "1.5"])
    def test_invalid_limit_is_an_error(self, value: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("FIBWS_MAX_MESSAGE_SIZE", value)
        with pytest.raises(ValueError, match=f"FIBWS_MAX_MESSAGE_SIZE .*{value}"):
            fibws.Node("ear")

    async def test_limit_of_the_environment(
        self, start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        hub = await start_hub()
        monkeypatch.setenv("FIBWS_MAX_MESSAGE_SIZE", f"{LIMIT}")
        async with (
            asyncio.timeout(PATIENCE),
            fibws.Node("robot", hub=hub.url) as node,
            node.subscribe("texts", String) as texts,
        ):
            publisher = await node.advertise("texts", String)
            await publisher.publish(LARGE)
            await publisher.publish("small")
            assert (await anext(texts)).data == "small"
