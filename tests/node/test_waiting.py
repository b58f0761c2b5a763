"""Waiting for services and messages."""

from __future__ import annotations

import asyncio

import pytest
from patience import PATIENCE

import fibws
from fibws.msg.std_msgs import Int32
from fibws.names import parse_remappings

from .conftest import Peer, ScriptedHub


async def answers(peer: Peer, type_: str, service: str = "/add") -> None:
    """Send the type of the service that the node requested."""
    call = await peer.expect("call_service")
    assert (call["service"], call["args"]) == ("/rosapi/service_type", {"service": service})
    await peer.send(
        "service_response",
        id=call["id"],
        service=call["service"],
        values={"type": type_},
        result=True,
    )


async def test_wait_for_service_polls_until_it_exists(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(60):
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_service("add"))
        for type_ in ("", "", "rospy_tutorials/AddTwoInts"):
            assert not waiting.done()
            await answers(peer, type_)
        await waiting


@pytest.mark.parametrize("over", ["service", "action"])
async def test_name_is_resolved_once(hub: ScriptedHub, over: str) -> None:
    remapping = parse_remappings(["a:=b", "b:=a", "b/_action/cancel_goal:=a"])
    async with (
        fibws.Node("node", hub=hub.url, remapping=remapping) as node,
        asyncio.timeout(PATIENCE),
    ):
        peer = await hub.peer()
        if over == "service":
            wait, service = node.wait_for_service("a"), "/b"
        else:
            client = node.action_client("a", "actionlib_tutorials/Fibonacci", over="operations")
            wait, service = client.wait_for_server(), "/b/_action/cancel_goal"
        waiting = asyncio.create_task(wait)
        await answers(peer, "any/Type", service)
        await waiting


async def test_service_may_appear_with_the_next_hub(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(60):
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_service("add"))
        await peer.expect("call_service")
        peer.websocket.transport.abort()
        await answers(await hub.peer(), "rospy_tutorials/AddTwoInts")
        await waiting


async def test_wait_for_service_times_out(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        text = "^timeout exceeded while waiting for service /add$"
        with pytest.raises(fibws.WaitTimeout, match=text):
            await node.wait_for_service("add", timeout=0.01)
        assert issubclass(fibws.WaitTimeout, TimeoutError)


async def test_hub_without_rosapi_is_not_polled(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_service("add"))
        call = await peer.expect("call_service")
        await peer.send(
            "service_response",
            id=call["id"],
            service=call["service"],
            values="Service /rosapi/service_type does not exist",
            result=False,
        )
        with pytest.raises(fibws.ServiceError, match="/rosapi/service_type does not exist"):
            await waiting


async def test_end_of_the_node_ends_wait_for_service(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_service("add"))
        await answers(peer, "")
        asked = asyncio.create_task(node.wait_for_service("add"))
        await peer.expect("call_service")
    for each in (waiting, asked):
        with pytest.raises(fibws.NodeClosed):
            await each


async def test_wait_for_message_returns_one_message(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(60):
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_message("numbers", Int32))
        subscribe = await peer.expect("subscribe")
        assert (subscribe["topic"], subscribe["queue_length"]) == ("/numbers", 1)
        await peer.send("publish", topic="/numbers", msg={"data": 8})
        assert await waiting == Int32(8)
        assert (await peer.expect("unsubscribe"))["id"] == subscribe["id"]


async def test_wait_for_message_times_out(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        text = "^timeout exceeded while waiting for message on topic /numbers$"
        with pytest.raises(fibws.WaitTimeout, match=text):
            await node.wait_for_message("numbers", "std_msgs/Int32", timeout=0.01)
        await peer.expect("subscribe")
        await peer.expect("unsubscribe")


async def test_refused_subscription_is_raised_by_wait_for_message(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_message("numbers", Int32))
        subscribe = await peer.expect("subscribe")
        await peer.send("status", level="error", id=subscribe["id"], msg="no")
        with pytest.raises(fibws.OperationRejected, match="no"):
            await waiting


async def test_end_of_the_node_ends_wait_for_message(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        waiting = asyncio.create_task(node.wait_for_message("numbers", Int32))
        await peer.expect("subscribe")
    with pytest.raises(fibws.NodeClosed, match="ended while waiting for message on topic /numbers"):
        await waiting


@pytest.mark.parametrize("seconds", [0, -1])
async def test_invalid_timeout_is_refused(hub: ScriptedHub, seconds: float) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        for waiting in (
            node.wait_for_service("add", timeout=seconds),
            node.wait_for_message("numbers", Int32, timeout=seconds),
            node.call("add", "std_srvs/Trigger", timeout=seconds),
        ):
            with pytest.raises(ValueError, match="timeout must be a finite number"):
                await waiting
