"""Nodes that are pinged and killed by a service, on real sockets."""

from __future__ import annotations

import json
from typing import Any

import pytest
from conftest import StartHub
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from fibws.hub.server import HubServer
from fibws.hub.settings import MIB

from ..raw_client import (
    PATIENT,
    PING,
    PONG,
    Client,
    connected,
    frame,
    nodes,
    operation,
    publish,
    until,
)

pytestmark = pytest.mark.both_loops

KILLED = (4002, "shutdown request: user request")


def call(service: str, node: str) -> bytes:
    return operation("call_service", service=f"/rosapi/{service}", args={"node": node})


async def receive_values(client: Client) -> dict[str, Any]:
    response = await client.receive()
    assert (response["op"], response["result"]) == ("service_response", True), response
    values: dict[str, Any] = response["values"]
    return values


async def call_rosapi(websocket: ClientConnection, service: str, node: str) -> dict[str, Any]:
    """Call a service of rosapi with a plain client of the websockets library."""
    fields = {"op": "call_service", "service": f"/rosapi/{service}", "args": {"node": node}}
    await websocket.send(json.dumps(fields))
    values: dict[str, Any] = json.loads(await websocket.recv())["values"]
    return values


async def test_pong_answers_the_ping(any_hub: HubServer) -> None:
    async with (
        connected(any_hub.port, "/?node=/talker") as talker,
        connected(any_hub.port) as caller,
    ):
        await caller.send(call("ping_node", "/talker"))
        opcode, data = await talker.frame()
        assert opcode == PING
        await talker.send(frame(PONG, b"another's"), frame(PONG))
        await talker.is_processed()
        await caller.is_processed()
        await talker.send(frame(PONG, data))
        values = await receive_values(caller)
        assert (values["success"], values["message"]) == (True, "/talker has answered")
        assert 0 < values["seconds"] < 60


async def test_raw_client_answers_a_ping_and_may_ping_itself(hub: HubServer) -> None:
    async with connect(f"{hub.url}/?node=/bare") as bare, connect(hub.url) as caller:
        assert (await call_rosapi(caller, "ping_node", "/bare"))["success"]
        assert (await call_rosapi(bare, "ping_node", "/bare"))["success"]


async def test_client_that_leaves_during_a_ping_is_reported_as_gone(any_hub: HubServer) -> None:
    async with connected(any_hub.port) as caller:
        async with connected(any_hub.port, "/?node=/talker") as talker:
            await caller.send(call("ping_node", "/talker"))
            assert (await talker.frame())[0] == PING
        values = await receive_values(caller)
        assert (values["success"], values["message"]) == (False, "/talker has left")


async def test_caller_may_leave_before_the_pong(any_hub: HubServer) -> None:
    async with connected(any_hub.port, "/?node=/talker") as talker:
        async with connected(any_hub.port, "/?node=/caller") as caller:
            await caller.send(call("ping_node", "/talker"))
            _, data = await talker.frame()
        await until(lambda: "/caller" not in any_hub.graph.nodes)
        await talker.send(frame(PONG, data))
        await talker.is_processed()


async def test_client_that_does_not_read_is_not_pinged(start_hub: StartHub) -> None:
    hub = await start_hub(stall_timeout=PATIENT)
    async with (
        connected(hub.port, "/?node=/slow", receive_buffer=4096) as slow,
        connected(hub.port) as caller,
    ):
        await slow.subscribes("/t", "std_msgs/String")
        await caller.advertises("/t", "std_msgs/String")
        await caller.send(publish("/t", "x" * MIB))
        await caller.is_processed()
        await caller.send(call("ping_node", "/slow"))
        values = await receive_values(caller)
        assert not values["success"]
        assert "/slow reads too slowly" in values["message"]


async def test_client_that_is_killed_is_closed_with_a_reason(any_hub: HubServer) -> None:
    async with (
        connected(any_hub.port, "/?node=/talker") as talker,
        connected(any_hub.port, "/?node=/killer") as killer,
    ):
        await talker.advertises("/fib")
        await killer.send(call("kill_node", "/talker"))
        assert await receive_values(killer) == {"success": True, "message": "killed /talker"}
        assert await talker.is_closed() == KILLED
        assert nodes(any_hub) == ["/killer"]
        await killer.is_processed()


async def test_raw_client_gets_the_reason_for_being_killed(hub: HubServer) -> None:
    async with connect(f"{hub.url}/?node=/bare") as bare:
        assert (await call_rosapi(bare, "kill_node", "/bare"))["success"]
        with pytest.raises(ConnectionClosed) as closed:
            await bare.recv()
    assert closed.value.rcvd is not None
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == KILLED
