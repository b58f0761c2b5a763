"""The example servers with the services and actions of the ROS tutorials."""

from __future__ import annotations

from typing import Any

from patience import PATIENCE
from roslibpy import Message, Service, ServiceRequest
from roslibpy.ros1.actionlib import ActionClient, Goal, GoalStatus

from .world import World, eventually


def tutorial_service_adds_two_ints(world: World) -> Any:
    service = Service(world.connect(), "/add_two_ints", "rospy_tutorials/AddTwoInts")
    return service.call(ServiceRequest({"a": 1, "b": 2}), timeout=PATIENCE)


def tutorial_action_returns_the_sequence_and_can_be_cancelled(world: World) -> Any:
    client = ActionClient(world.connect(), "/fibonacci", "actionlib_tutorials/FibonacciAction")
    goal = Goal(client, Message({"order": 5}))
    goal.send()
    sequence = goal.wait(PATIENCE)["sequence"]
    long = Goal(client, Message({"order": 40}))
    long.on("feedback", lambda _: long.cancel())
    long.send()
    long.wait(PATIENCE)
    # The status follows the result, and roslibpy waits for it only if the goal was active before.
    eventually(lambda: long.status["status"] != GoalStatus.PREEMPTING)
    return {
        "done": {"sequence": sequence, "status": goal.status["status"]},
        "cancelled": long.status["status"],
    }
