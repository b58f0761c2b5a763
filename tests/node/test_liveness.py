"""Pings of nodes: what is a sign of the hub's life, and when the hub is lost."""

from __future__ import annotations

import asyncio

import pytest
from patience import PATIENCE

import fibws
from fibws.msg.std_msgs import Int32
from fibws.node.connection import NodeWebSocket
from fibws.node.liveness import PING_LOOKS, SILENT_LOOKS, HubLiveness

from .conftest import ScriptedHub


def test_hub_is_pinged_in_every_interval() -> None:
    keepalive = HubLiveness()
    for number in range(1, 4 * PING_LOOKS):
        keepalive.alive()
        assert keepalive.look() == (None if number % PING_LOOKS else "ping")


def test_silent_hub_is_lost() -> None:
    keepalive = HubLiveness()
    keepalive.look()
    keepalive.alive()
    assert "lost" not in [keepalive.look() for _ in range(SILENT_LOOKS - 1)]
    assert keepalive.look() == "lost"


def websocket_of(node: fibws.Node) -> NodeWebSocket:
    websocket = node._session.outgoing._writer
    assert isinstance(websocket, NodeWebSocket)
    return websocket


async def test_pong_is_a_sign_of_life(hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch) -> None:
    came = asyncio.Event()
    alive = HubLiveness.alive

    def take(keepalive: HubLiveness) -> None:
        alive(keepalive)
        came.set()

    monkeypatch.setattr(HubLiveness, "alive", take)
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(PATIENCE):
        await hub.peer()
        websocket = websocket_of(node)
        for _ in range(4 * SILENT_LOOKS // PING_LOOKS):
            came.clear()
            for _ in range(PING_LOOKS):
                websocket._look()
            await came.wait()
        assert websocket.is_open


async def test_messages_are_a_sign_of_life_while_a_pong_waits_behind_them(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.node.liveness.PING_LOOKS", 10**9)  # No pong comes.
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(PATIENCE):
        peer = await hub.peer()
        numbers = node.subscribe("numbers", Int32)
        await peer.expect("subscribe")
        websocket = websocket_of(node)
        for number in range(3 * SILENT_LOOKS):
            await peer.send("publish", topic="/numbers", msg={"data": number})
            assert (await anext(numbers)).data == number
            websocket._look()
        assert websocket.is_open


async def test_node_connects_again_after_a_silence(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.node.liveness.PING_LOOKS", 10**9)
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(PATIENCE):
        node.subscribe("numbers", Int32)
        await (await hub.peer()).expect("subscribe")
        websocket = websocket_of(node)
        for _ in range(SILENT_LOOKS):
            websocket._look()
        await (await hub.peer()).expect("subscribe")
        assert websocket_of(node) is not websocket and not websocket.is_open
