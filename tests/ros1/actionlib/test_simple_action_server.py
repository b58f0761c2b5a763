"""A server that pursues one goal at a time, in scripts as people write them."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from ports import port as port
from running_programs import Program

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.hub import Settings
from fibws.hub.server import HubServer
from ros1.side_by_side import SCRIPTS, Part, our_ros

from .conftest import StartScript

SERVER = str(SCRIPTS / "actions" / "fibonacci_server.py")
CLIENT = str(SCRIPTS / "actions" / "fibonacci_client.py")
SUPERSEDED = "This goal was canceled because another goal was received by the simple action server"


async def test_server_executes_goals_of_a_client() -> None:
    async with our_ros() as ros:
        server, client = await ros.play(
            Part("actions/server.py", until="ready", hears=("preempted", 4)),
            Part("actions/client.py", interrupted=False),
        )
    assert server.code == client.code == 0, client.err
    heard = sections(client.out)
    assert heard["goal 3"] == [
        *("done: SUCCEEDED result: 3", "['active'], feedback [0, 1, 2]", "finished: True"),
        *("state: 3 SUCCEEDED", "text: 'counted'", "result: result: 3"),
    ]
    assert heard["goal -5"] == [
        *("done: ABORTED result: -1", "['active'], feedback []", "finished: True"),
        *("state: 4 ABORTED", "text: 'negative goal'", "result: result: -1"),
    ]
    assert "text: 'Exception in execute callback: one hundred'" in heard["goal 100"]
    assert "text: 'No terminal state was set.'" in heard["goal 101"]
    assert heard["too long"][1] == "finished: False"
    assert heard["too long"][-3:] == ["state: 2 PREEMPTED", "text: 'no more'", "result: result: 7"]
    assert heard["and wait"][0] == "True"
    assert heard["a later goal"][2] == "state: 2 PREEMPTED"
    assert heard["a later goal"][-2:] == ["text: 'counted'", "result: result: 1"]
    assert heard["all of them"][2] == "state: 2 PREEMPTED"
    logged = [line.partition(": ")[2] for line in server.out]
    assert logged[1:6] == ["goal 3", "goal -5", "goal 100", "goal 101", "goal 102"]
    assert logged[-3:] == ["goal 1000", "preempt callback", "preempted"]
    assert "Exception in your execute callback: one hundred" in server.err[0]
    assert any("did not set the goal to a terminal status" in line for line in server.err)
    assert "it is currently in state: 3" in server.err[-1]


async def test_goals_can_be_accepted_in_callbacks() -> None:
    async with our_ros() as ros:
        server, client = await ros.play(
            Part("actions/polling_server.py", until="ready", hears=("accepted", 4)),
            Part("actions/polling_client.py", interrupted=False),
        )
    assert client.out == [
        *("9", "True 3 result: 6", "True 2 result: 0"),
        *("True 2", SUPERSEDED, "True 3 result: 7"),
    ]
    assert "when a new goal is not available" in server.err[0]


@pytest.mark.long
async def test_ctrl_c_ends_a_server_during_a_goal(
    hub: HubServer, start_script: StartScript
) -> None:
    server = await start_script("fibonacci_server.py")
    assert "ready" in await server.line()
    async with fibws.Node("test", hub=hub.url) as node:
        client = node.action_client("fibonacci", Fibonacci)
        await client.wait_for_server(timeout=60)
        goal = await client.send({"order": 45})
        async for _ in goal.feedback():
            break
        server.send(signal.SIGINT)
        code, out, err = await server.end()
    assert (code, err) == (0, "")
    # As in ROS, the end lets it finish what it does, but it need not wait for that.
    assert re.findall(r"/fibonacci: (.*)", out) == ["order 45", "succeeded"]


async def test_clients_of_fibws_can_send_goals(hub: HubServer, start_script: StartScript) -> None:
    server = await start_script("fibonacci_server.py")
    assert "ready" in await server.line()
    async with fibws.Node("test", hub=hub.url) as node:
        client = node.action_client("fibonacci", Fibonacci)
        await client.wait_for_server(timeout=60)
        goal = await client.send({"order": 3})
        feedback = [each.sequence async for each in goal.feedback()]
        assert feedback == [[0, 1, 1], [0, 1, 1, 2]]
        assert (await goal.result()).sequence == [0, 1, 1, 2]
        goal = await client.send({"order": 45})
        async for _ in goal.feedback():
            await goal.cancel()
        assert goal.status is fibws.GoalStatus.PREEMPTED


async def test_goal_survives_a_restart_of_the_hub(port: int) -> None:
    async with HubServer(Settings(port=port, close_timeout=0.1)) as hub:
        server = await Program.start("fibws.rospy", SERVER, **_meeting_at(hub))
        assert "ready" in await server.line()
        client = await Program.start("fibws.rospy", CLIENT, "20", "60", **_meeting_at(hub))
        assert await client.line() == "feedback: [0, 1, 1]\n"
    async with HubServer(Settings(port=port, close_timeout=0.1)):
        code, out, err = await client.end()
        await server.stop()
    assert code == 0, err
    assert out.splitlines()[-2] == "3 "
    assert "1597, 2584, 4181, 6765]" in out.splitlines()[-1]


def _meeting_at(hub: HubServer) -> dict[str, str]:
    return {"FIBWS_HUB": hub.url, "PYTHONUNBUFFERED": "1"}


WRONG = """
import rospy, actionlib
from actionlib_tutorials.msg import FibonacciAction

rospy.init_node("wrong")
server = actionlib.SimpleActionServer("early", FibonacciAction)
def goal():
    raise ValueError("not this one")
server.register_goal_callback(goal)
executing = actionlib.SimpleActionServer("late", FibonacciAction, print, False)
executing.register_goal_callback(goal)
print("ready", flush=True)
rospy.spin()
"""


async def test_errors_of_the_program_are_logged(
    hub: HubServer, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    server = await start_script(script(WRONG))
    assert await server.line() == "ready\n"
    assert "You've passed in true for auto_start" in await server.error_line()
    assert "because an executeCallback exists" in await server.error_line()
    async with fibws.Node("test", hub=hub.url) as node:
        client = node.action_client("early", Fibonacci)
        await client.wait_for_server(timeout=60)
        await client.send({"order": 3})
        assert "internal_goal_callback - exception not this one" in await server.error_line()


def sections(lines: list[str]) -> dict[str, list[str]]:
    """Return the lines after each headline."""
    heads = {"too long", "and wait", "a later goal", "all of them"}
    found: dict[str, list[str]] = {}
    current = found.setdefault("", [])
    for line in lines:
        if line in heads or line.startswith("goal "):
            current = found.setdefault(line, [])
        else:
            current.append(line)
    return found
