"""A client that follows each goal by its handle."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import fibws
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.hub.server import HubServer
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult

from .conftest import StartScript

Goal = fibws.ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]

CLIENT = """
import rospy, actionlib
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal
from std_msgs.msg import Int32

def heard(handle, feedback):
    print(numbers[handle], list(feedback.sequence), flush=True)
    told.publish(numbers[handle])

rospy.init_node("client")
told = rospy.Publisher("told", Int32, queue_size=10)
client = actionlib.ActionClient("numbers", FibonacciAction)
print(client.wait_for_action_server_to_start(rospy.Duration(60)), flush=True)
numbers = {}
handles = [client.make_goal(FibonacciGoal(order), None, heard) for order in (1, 2)]
numbers = {handle: number for number, handle in enumerate(handles)}
for handle in handles:
    client.pub_goal.publish(handle.comm_state_machine.action_goal)
while any(handle.get_comm_state() != actionlib.CommState.DONE for handle in handles):
    rospy.sleep(0.01)
for handle in handles:
    print(list(handle.get_result().sequence), flush=True)
client.stop()
"""


@pytest.mark.long
async def test_several_goals_are_followed(
    hub: HubServer, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    """Feedback may be overtaken by the result, as in ROS: each topic has its own thread."""

    async def pursue(goal: Goal) -> FibonacciResult:
        await goal.publish_feedback(FibonacciFeedback([goal.request.order]))
        await anext(told)
        return FibonacciResult([goal.request.order] * 2)

    async with fibws.Node("server", hub=hub.url) as node:
        told = node.subscribe("told", "std_msgs/Int32")
        await node.action_server("numbers", Fibonacci, pursue, over="topics", concurrent=True)
        client = await start_script(script(CLIENT))
        assert await client.line() == "True\n"
        code, out, err = await client.end()
    lines = out.splitlines()
    assert (code, err) == (0, "")
    assert sorted(lines[:2]) == ["0 [1]", "1 [2]"]
    assert lines[2:] == ["[1, 1]", "[2, 2]"]
