"""Actions over topics, as the documentation of roslibpy uses them."""

from __future__ import annotations

from typing import Any

from patience import PATIENCE
from roslibpy import Message
from roslibpy.ros1.actionlib import (
    ActionClient,
    Goal,
    SimpleActionServer,
)

from .world import Collected, World, eventually

FIBONACCI = "actionlib_tutorials/FibonacciAction"


class _Followed:
    """A goal on its way, and how it goes on and ends."""

    def __init__(self, client: Any, order: int) -> None:
        self.goal = Goal(client, Message({"order": order}))
        self.feedback = Collected()
        self.goal.on("feedback", self.feedback.put)
        self.goal.send()

    def outcome(self) -> dict[str, Any]:
        result = self.goal.wait(PATIENCE)
        status = self.goal.status["status"]
        return {
            "feedback": self.feedback.many(self.feedback.qsize()),
            "status": status,
            "result": result,
        }


def _pair(world: World, name: str) -> tuple[Any, Any]:
    """A server that is not started yet, and a client that knows it."""
    server = SimpleActionServer(world.connect(), name, FIBONACCI)
    return server, ActionClient(world.connect(), name, FIBONACCI)


def _serve_until_cancelled(server: Any) -> None:
    def execute(_: Any) -> None:
        server.send_feedback({"sequence": [0, 1]})
        eventually(server.is_preempt_requested)
        server.set_preempted()

    server.start(execute)


def action_sends_feedback_and_a_result(world: World) -> Any:
    server, client = _pair(world, "/quick")

    def execute(goal: Any) -> None:
        sequence = [0, 1]
        while len(sequence) < goal["order"]:
            sequence.append(sequence[-1] + sequence[-2])
            server.send_feedback({"sequence": sequence})
        server.set_succeeded({"sequence": sequence})

    server.start(execute)
    return _Followed(client, 5).outcome()


def goal_can_be_cancelled(world: World) -> Any:
    server, client = _pair(world, "/patient")
    _serve_until_cancelled(server)
    followed = _Followed(client, 5)
    followed.goal.on("feedback", lambda _: followed.goal.cancel())
    return followed.outcome()


def all_goals_can_be_cancelled(world: World) -> Any:
    server, client = _pair(world, "/all")
    _serve_until_cancelled(server)
    followed = _Followed(client, 5)
    followed.goal.on("feedback", lambda _: client.cancel())
    return followed.outcome()


def newer_goal_replaces_the_older_one(world: World) -> Any:
    server, client = _pair(world, "/busy")

    def execute(goal: Any) -> None:
        server.send_feedback({"sequence": [goal["order"]]})
        if goal["order"] == 2:
            server.set_succeeded({"sequence": [2]})
        else:
            eventually(server.is_preempt_requested)
            server.set_preempted()

    server.start(execute)
    older = _Followed(client, 1)
    started = Collected()
    older.goal.on("feedback", started.put)
    started.many(1)
    newer = _Followed(client, 2)
    return {"older": older.outcome(), "newer": newer.outcome()}


def action_servers_are_listed(world: World) -> Any:
    _, client = _pair(world, "/listed_action")
    answers = Collected()
    client.ros.get_action_servers(answers.put)
    return "/listed_action" in answers.many(1)[0]["action_servers"]
