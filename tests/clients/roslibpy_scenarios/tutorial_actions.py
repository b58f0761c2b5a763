"""The action of ROS 2's tutorial, which roslibpy can ask for but not serve."""

from __future__ import annotations

from typing import Any

from roslibpy import ActionClient, Goal

from .world import Collected, World


def tutorial_action_returns_the_sequence_by_operation(world: World) -> Any:
    client = ActionClient(world.connect(), "/fibonacci", "example_interfaces/action/Fibonacci")
    feedback, ends = Collected(), Collected()
    client.send_goal(Goal({"order": 5}), ends.put, feedback.put, ends.put)
    [end] = ends.many(1)
    return {
        "sequence": end["values"]["sequence"],
        "feedback": [len(each["sequence"]) for each in feedback.many(feedback.qsize())],
    }
