"""The tutorials' action client."""

from __future__ import annotations

import asyncio
import signal
from typing import Any

import pytest
from running_programs import Start

import fibws
from fibws.action import action_class
from fibws.hub.server import HubServer
from fibws.node.actions.actions import Over

CLIENT = "fibws.examples.action_client"


@pytest.mark.parametrize(
    ("over", "order"), [("topics", "4"), ("operations", "5")], ids=["topics", "operations"]
)
async def test_feedback_and_result_are_printed(
    hub: HubServer, start: Start, over: str, order: str
) -> None:
    await start("fibws.examples.action_server", "--hub", hub.url, "--rate", "20")
    program = await start(CLIENT, order, "--over", over, "--hub", hub.url)
    code, out, err = await program.end()
    assert (code, err) == (0, "")
    assert out.splitlines() == [
        "Waiting for action server to start.",
        "Feedback: 0, 1, 1",
        "Feedback: 0, 1, 1, 2",
        "Feedback: 0, 1, 1, 2, 3",
        "Feedback: 0, 1, 1, 2, 3, 5",
        "Result: 0, 1, 1, 2, 3, 5",
    ]


async def test_client_waits_for_the_server(hub: HubServer, start: Start) -> None:
    program = await start(CLIENT, "1", "--hub", hub.url)
    assert await program.line() == "Waiting for action server to start.\n"
    await start("fibws.examples.action_server", "--hub", hub.url, "--rate", "100")
    assert await program.line() == "Feedback: 0, 1, 1\n"
    code, out, _ = await program.end()
    assert (code, out) == (0, "Result: 0, 1, 1\n")


async def test_failed_goal_is_an_error(hub: HubServer, start: Start) -> None:
    await start("fibws.examples.action_server", "--hub", hub.url)
    program = await start(CLIENT, "-3", "--hub", hub.url)
    code, out, err = await program.end()
    assert (code, out) == (1, "Waiting for action server to start.\n")
    assert err == "Error: /fibonacci: ABORTED: order -3 is negative\n"


@pytest.mark.parametrize(
    ("over", "type_"),
    [("topics", "actionlib_tutorials/Fibonacci"), ("operations", "example_interfaces/Fibonacci")],
    ids=["topics", "operations"],
)
async def test_ctrl_c_cancels_the_goal(
    hub: HubServer, start: Start, over: Over, type_: str
) -> None:
    feedback = action_class(type_).Feedback
    canceled = asyncio.Event()

    async def execute(goal: fibws.ServerGoal[Any, Any, Any]) -> Any:
        await goal.publish_feedback(feedback())
        await goal.cancellation()
        canceled.set()
        return goal.canceled()

    async with fibws.Node("test", hub=hub.url) as node:
        await node.action_server("numbers", type_, execute, over=over)
        program = await start(
            *(CLIENT, "9", "--over", over, "--hub", hub.url),
            *("--node-name", "asker", "fibonacci:=numbers"),
        )
        assert await program.line() == "Waiting for action server to start.\n"
        assert await program.line() == "Feedback: \n"
        program.send(signal.SIGINT)
        assert await program.end() == (0, "", "")
        async with asyncio.timeout(60):
            await canceled.wait()
