"""Calls and goals of nodes are serialized where the hub takes that, and JSON elsewhere."""

from __future__ import annotations

import asyncio
import json
import math
import struct
from collections.abc import AsyncIterator

import pytest
from websockets.asyncio.client import connect

import fibws
from fibws.action.control_msgs import GripperCommand
from fibws.hub.server import HubServer
from fibws.node import connection
from fibws.srv.rospy_tutorials import AddTwoInts
from fibws.srv.std_srvs import SetBool

ODD_NAN = struct.unpack("<d", struct.pack("<Q", 0xFFF8000000000123))[0]
"""A NaN that JSON does not express."""
COMMAND = {"position": math.inf, "max_effort": ODD_NAN}


def bits(number: float) -> bytes:
    return struct.pack("<d", number)


@pytest.fixture(params=["new", "old"])
def is_new(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether the nodes see that the hub takes calls and goals serialized."""
    if request.param == "old":
        monkeypatch.setattr(connection, "VALUES_HEADER", "Fibws-Unknown")
    return bool(request.param == "new")


@pytest.fixture
async def node(hub: HubServer, is_new: bool) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("ends", hub=hub.url) as node:
        yield node


async def test_goals_feedback_and_results_are_exact(node: fibws.Node, is_new: bool) -> None:
    seen: list[float] = []

    async def grip(goal: fibws.ServerGoal) -> dict[str, float]:
        seen.append(goal.request.command.max_effort)
        await goal.publish_feedback({"position": -math.inf, "effort": ODD_NAN})
        return {"position": -math.inf, "effort": ODD_NAN}

    await node.action_server("/grip", GripperCommand, grip, over="operations")
    async with node.action_client("/grip", GripperCommand, over="operations") as client:
        await client.wait_for_server()
        goal = await client.send({"command": COMMAND})
        feedback = [each async for each in goal.feedback()]
        result = await goal.result()
    seen += [feedback[0].effort, result.effort]
    assert [feedback[0].position, result.position] == [-math.inf, -math.inf]
    assert all(map(math.isnan, seen))
    assert {bits(each) == bits(ODD_NAN) for each in seen} == {is_new}


async def test_calls_work(node: fibws.Node) -> None:
    await node.service("/set", SetBool, lambda request: (request.data, "ü\0"))
    response = await node.call("/set", SetBool, {"data": True})
    assert (response.success, response.message) == (True, "ü\0")


async def test_service_of_an_unknown_type_is_called_in_json(
    node: fibws.Node, hub: HubServer
) -> None:
    async with connect(hub.url, compression=None) as server:
        service = {"service": "/add", "type": "unknown_package/AddTwoInts"}
        await server.send(json.dumps({"op": "advertise_service", **service}))
        await node.wait_for_service("/add")
        async with asyncio.TaskGroup() as group:
            call = group.create_task(node.call("/add", AddTwoInts, {"a": 1, "b": 2}))
            received = json.loads(await server.recv())
            assert received["args"] == {"a": 1, "b": 2}
            response = {"id": received["id"], "service": "/add", "values": {"sum": 3}}
            await server.send(json.dumps({"op": "service_response", "result": True, **response}))
        assert call.result().sum == 3
