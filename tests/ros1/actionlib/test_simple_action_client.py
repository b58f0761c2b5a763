"""A client of one goal at a time, with fibws' own servers."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.hub.server import HubServer
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult

from .conftest import StartScript

Goal = fibws.ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]


async def count(goal: Goal) -> FibonacciResult:
    """Count up to an order of 10; beyond that, until the goal is canceled."""
    if goal.request.order < 0:
        raise ValueError("there is no such order")
    await goal.publish_feedback(FibonacciFeedback([0, 1]))
    if goal.request.order > 10:
        await goal.cancellation()
        return goal.canceled(FibonacciResult([8]), "enough")
    return FibonacciResult(list(range(goal.request.order)))


async def test_goal_succeeds(hub: HubServer, start_script: StartScript) -> None:
    async with fibws.Node("server", hub=hub.url) as node:
        await node.action_server("fibonacci", Fibonacci, count)
        client = await start_script("fibonacci_client.py", "3", "20")
        assert await client.end() == (0, "feedback: [0, 1]\n3 \n[0, 1, 2]\n", "")


async def test_goal_is_aborted(hub: HubServer, start_script: StartScript) -> None:
    async with fibws.Node("server", hub=hub.url) as node:
        await node.action_server("fibonacci", Fibonacci, count)
        client = await start_script("fibonacci_client.py", "-3", "20")
        assert await client.end() == (0, "4 ValueError: there is no such order\n[]\n", "")


async def test_goal_is_canceled(hub: HubServer, start_script: StartScript) -> None:
    async with fibws.Node("server", hub=hub.url) as node:
        await node.action_server("fibonacci", Fibonacci, count)
        client = await start_script("fibonacci_client.py", "11", "0.5")
        code, out, err = await client.end()
        assert (code, err) == (0, "")
        assert out == "feedback: [0, 1]\n2 enough\n[8]\n"


async def test_goal_that_its_server_forgot_is_lost(
    hub: HubServer, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    async with fibws.Node("server", hub=hub.url) as node:
        for topic, type_ in (
            ("result", "actionlib_tutorials/FibonacciActionResult"),
            ("feedback", "actionlib_tutorials/FibonacciActionFeedback"),
        ):
            await node.advertise(f"fibonacci/{topic}", type_)
        goals = node.subscribe("fibonacci/goal", "actionlib_tutorials/FibonacciActionGoal")
        node.subscribe("fibonacci/cancel", "actionlib_msgs/GoalID")
        statuses = await node.advertise(
            "fibonacci/status", "actionlib_msgs/GoalStatusArray", latch=True
        )
        await statuses.publish()
        client = await start_script(script(WAITING))
        goal: Any = await anext(goals)
        goal_id = {"id": goal.goal_id.id, "stamp": "now"}
        await statuses.publish(status_list=[{"goal_id": goal_id, "status": 1}])
        assert await client.line() == "active\n"
        await statuses.publish()
        assert await client.end() == (0, "done 9 None\nTrue\n", "")


async def test_ctrl_c_interrupts_the_wait_for_a_server(
    hub: HubServer, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        feedback = await node.advertise(
            "fibonacci/feedback", "actionlib_tutorials/FibonacciActionFeedback", peers=True
        )
        client = await start_script(script(LOOKING))
        async for peers in feedback.peers.changes():
            if "/looking" in peers:
                break
        client.send(signal.SIGINT)
        assert await client.end() == (0, "False\n", "")


LOOKING = """
import rospy, actionlib
from actionlib_tutorials.msg import FibonacciAction

rospy.init_node("looking")
print(actionlib.SimpleActionClient("fibonacci", FibonacciAction).wait_for_server(), flush=True)
"""

WAITING = """
import rospy, actionlib
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal

def done(state, result):
    print("done", state, result, flush=True)

def active():
    print("active", flush=True)

rospy.init_node("waiting")
client = actionlib.SimpleActionClient("fibonacci", FibonacciAction)
client.wait_for_server()
client.send_goal(FibonacciGoal(11), done, active)
print(client.wait_for_result(), flush=True)
"""


async def test_ctrl_c_interrupts_the_wait_for_a_result(
    hub: HubServer, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    async with fibws.Node("server", hub=hub.url) as node:
        await node.action_server("fibonacci", Fibonacci, count)
        client = await start_script(script(WAITING))
        assert await client.line() == "active\n"
        client.send(signal.SIGINT)
        assert await client.end() == (0, "False\n", "")


CHAINED = """
import threading
import rospy, actionlib
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal

over = threading.Event()

def first_done(state, result):
    client.send_goal(FibonacciGoal(2), second_done)

def second_done(state, result):
    print("second", list(result.sequence), flush=True)
    over.set()

rospy.init_node("chained")
client = actionlib.SimpleActionClient("fibonacci", FibonacciAction)
client.wait_for_server()
client.send_goal(FibonacciGoal(1), first_done)
over.wait()
print(client.wait_for_result(), client.get_state(), flush=True)
client.stop_tracking_goal()
print(client.get_state(), client.wait_for_result(), client.get_result(), flush=True)
"""


async def test_next_goal_can_be_sent_in_the_done_callback(
    hub: HubServer, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    async with fibws.Node("server", hub=hub.url) as node:
        await node.action_server("fibonacci", Fibonacci, count)
        client = await start_script(script(CHAINED))
        code, out, err = await client.end()
        assert (code, out) == (0, "second [0, 1]\nTrue 3\n9 False None\n")
        assert "Called get_result when no goal is running" in err
