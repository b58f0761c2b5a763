"""The tutorials' action server."""

from __future__ import annotations

import asyncio
import re
import signal
from typing import Any

import pytest
from running_programs import Program, Start

import fibws
from fibws.action import actionlib_tutorials, example_interfaces
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String

SERVER = "fibws.examples.action_server"
FIRST_INT32S = [0, 1]
while FIRST_INT32S[-1] + FIRST_INT32S[-2] < 2**31:
    FIRST_INT32S.append(FIRST_INT32S[-1] + FIRST_INT32S[-2])


async def logged(program: Program) -> str:
    """The next line of the server's log, without its head."""
    line = await program.line()
    found = re.fullmatch(r"\[INFO\] \[\d{10}\.\d{6}\]: (.*)\n", line)
    assert found is not None, line
    return found[1]


async def ros1(
    node: fibws.Node,
) -> fibws.ActionClient[Any, Any, Any]:
    client = node.action_client("fibonacci", actionlib_tutorials.Fibonacci)
    await client.wait_for_server(timeout=60)
    return client


async def ros2(node: fibws.Node) -> fibws.ActionClient[Any, Any, Any]:
    client = node.action_client("fibonacci", example_interfaces.Fibonacci, over="operations")
    await client.wait_for_server(timeout=60)
    return client


async def test_server_over_topics_works_as_in_ros_1(hub: HubServer, start: Start) -> None:
    server = await start(SERVER, "--hub", hub.url, "--rate", "100")
    async with fibws.Node("test", hub=hub.url) as node:
        goal = await (await ros1(node)).send({"order": 3})
        feedback = [each.sequence async for each in goal.feedback()]
        assert feedback == [[0, 1, 1], [0, 1, 1, 2], [0, 1, 1, 2, 3]]
        assert (await goal.result()).sequence == [0, 1, 1, 2, 3]
    assert await logged(server) == (
        "fibonacci: Executing, creating fibonacci sequence of order 3 with seeds 0, 1"
    )
    assert await logged(server) == "fibonacci: Succeeded"


async def test_server_over_operations_works_as_in_ros_2(hub: HubServer, start: Start) -> None:
    server = await start(SERVER, "--hub", hub.url, "--rate", "100")
    async with fibws.Node("test", hub=hub.url) as node:
        goal = await (await ros2(node)).send({"order": 3})
        feedback = [each.sequence async for each in goal.feedback()]
        assert feedback == [[0, 1, 1], [0, 1, 1, 2]]
        assert (await goal.result()).sequence == [0, 1, 1, 2]
    assert await logged(server) == "Executing goal..."
    assert await logged(server) == "Feedback: [0, 1, 1]"
    assert await logged(server) == "Feedback: [0, 1, 1, 2]"


async def test_goals_are_canceled_over_topics_and_operations(hub: HubServer, start: Start) -> None:
    server = await start(SERVER, "--hub", hub.url, "--rate", "0.01")
    async with fibws.Node("test", hub=hub.url) as node:
        await canceled(await ros1(node))
        assert (await logged(server)).startswith("fibonacci: Executing")
        assert await logged(server) == "fibonacci: Preempted"
        await canceled(await ros2(node))
        assert await logged(server) == "Executing goal..."
        assert await logged(server) == "Feedback: [0, 1, 1]"
        assert await logged(server) == "Goal canceled"


async def canceled(client: fibws.ActionClient[Any, Any, Any]) -> None:
    """Send a goal, and cancel it as soon as it is heard of."""
    goal = await client.send({"order": 9})
    await anext(goal.feedback())
    await goal.cancel()
    with pytest.raises(fibws.ActionError) as error:
        await goal.result(timeout=60)
    assert error.value.status is fibws.GoalStatus.PREEMPTED
    assert error.value.result.sequence == []


@pytest.mark.parametrize("order", [0, 1])
async def test_shortest_sequences(hub: HubServer, start: Start, order: int) -> None:
    await start(SERVER, "--hub", hub.url, "--rate", "100")
    async with fibws.Node("test", hub=hub.url) as node:
        goal = await (await ros1(node)).send({"order": order})
        assert (await goal.result()).sequence == [0, 1, 1][: order + 2]
        goal = await (await ros2(node)).send({"order": order})
        assert (await goal.result()).sequence == [0, 1]


async def test_longest_sequence(hub: HubServer, start: Start) -> None:
    await start(SERVER, "--hub", hub.url, "--rate", "10000")
    async with fibws.Node("test", hub=hub.url) as node:
        for client, longest in ((await ros1(node), 45), (await ros2(node), 46)):
            goal = await client.send({"order": longest})
            assert (await goal.result(timeout=60)).sequence == FIRST_INT32S
            for order in (longest + 1, 2**31 - 1):
                goal = await client.send({"order": order})
                with pytest.raises(
                    fibws.ActionError,
                    match=f"order {order} is too large: F.* does not fit an int32",
                ):
                    await goal.result(timeout=60)


async def test_negative_order_is_aborted(hub: HubServer, start: Start) -> None:
    server = await start(SERVER, "--hub", hub.url)
    async with fibws.Node("test", hub=hub.url) as node:
        for client in (await ros1(node), await ros2(node)):
            goal = await client.send({"order": -3})
            with pytest.raises(fibws.ActionError, match="ABORTED: order -3 is negative"):
                await goal.result(timeout=60)
            assert "order -3 is negative" in await server.error_line()
            goal = await client.send({"order": 0})
            assert (await goal.result(timeout=60)).sequence == [0, 1]


async def test_names_can_be_chosen_and_ctrl_c_ends_it(hub: HubServer, start: Start) -> None:
    server = await start(SERVER, "--hub", hub.url, "--node-name", "counter", "fibonacci:=numbers")
    async with fibws.Node("test", hub=hub.url) as node:
        client = node.action_client("numbers", actionlib_tutorials.Fibonacci)
        await client.wait_for_server(timeout=60)
        assert "/counter" in await node.graph.nodes()
    server.send(signal.SIGINT)
    code, _, err = await server.end()
    assert (code, err) == (0, "")


async def test_default_name_is_not_anonymous(hub: HubServer, start: Start) -> None:
    await start(SERVER, "--hub", hub.url)
    async with fibws.Node("test", hub=hub.url) as node:
        await ros1(node)
        assert "/fibonacci_action_server" in await node.graph.nodes()


async def test_closed_pipe_ends_it_quietly(hub: HubServer, start: Start) -> None:
    server = await start(SERVER, "--hub", hub.url, "--rate", "100")
    async with fibws.Node("test", hub=hub.url) as node:
        client = await ros1(node)
        await (await client.send({"order": 0})).result(timeout=60)
        server.stop_reading()
        goal = await client.send({"order": 0})
        with pytest.raises(fibws.ActionError, match="ABORTED"):
            await goal.result(timeout=60)
    code, _, err = await server.end()
    assert (code, err) == (0, "")


async def test_topic_of_another_type_is_a_warning(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        await node.advertise("fibonacci/goal", String)
        server = await start(SERVER, "--hub", hub.url)
        async with asyncio.timeout(60):
            assert "type std_msgs/String (published by /test)" in await server.error_line()
