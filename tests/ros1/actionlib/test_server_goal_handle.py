"""What a server can do with a goal, and what it cannot."""

from __future__ import annotations

import threading
from typing import Any, cast

import pytest
import rospy
from actionlib import ActionServer, ServerGoalHandle
from actionlib_msgs.msg import GoalStatus
from actionlib_tutorials.msg import (
    FibonacciActionGoal,
    FibonacciFeedback,
    FibonacciGoal,
    FibonacciResult,
)

from fibws.node.actions.status import Record


class Told:
    """What a server would tell its clients."""

    ActionResultType = FibonacciResult

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.told: list[Any] = []

    def publish_status(self) -> None:
        self.told.append("status")

    def publish_feedback(self, status: Any, feedback: Any) -> None:
        self.told.append((status.status, feedback))

    def goal_ended(self, record: Record, result: Any) -> None:
        self.told.append((int(record.status), record.text, result))


@pytest.fixture
def errors(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    found: list[str] = []
    monkeypatch.setattr(rospy, "logerr", found.append)
    monkeypatch.setattr(rospy, "logdebug", lambda *args: None)
    return found


@pytest.fixture
def server() -> Told:
    return Told()


@pytest.fixture
def handle(server: Told, errors: list[str]) -> ServerGoalHandle:
    return handle_of("/client-1", server)


def handle_of(name: str, server: Told) -> ServerGoalHandle:
    goal = FibonacciActionGoal(goal=FibonacciGoal(5))
    return ServerGoalHandle(Record(name, 3_000_000_004), cast(ActionServer, server), goal)


def test_a_goal_is_reached(handle: ServerGoalHandle, server: Told, errors: list[str]) -> None:
    handle.set_accepted("begun")
    assert handle.get_goal_status().status == GoalStatus.ACTIVE
    assert handle.get_goal_status().text == "begun"
    handle.publish_feedback(FibonacciFeedback([2]))
    handle.set_succeeded(FibonacciResult([8]), "done")
    assert server.told == [
        "status",
        (GoalStatus.ACTIVE, FibonacciFeedback([2])),
        (GoalStatus.SUCCEEDED, "done", FibonacciResult([8])),
    ]
    assert errors == []


def test_it_tells_what_it_is_of(handle: ServerGoalHandle) -> None:
    assert handle.get_goal() == FibonacciGoal(5)
    assert handle.get_goal_id().id == "/client-1"
    assert handle.get_goal_id().stamp == rospy.Time(3, 4)
    assert handle.get_default_result() == FibonacciResult()


@pytest.mark.parametrize(
    ("step", "status"),
    [
        ("set_canceled", GoalStatus.RECALLED),
        ("set_rejected", GoalStatus.REJECTED),
    ],
)
def test_a_goal_ends_before_it_began(
    handle: ServerGoalHandle, server: Told, step: str, status: int
) -> None:
    getattr(handle, step)()
    assert server.told == [(status, "", None)]


@pytest.mark.parametrize(
    ("step", "status"),
    [
        ("set_canceled", GoalStatus.PREEMPTED),
        ("set_aborted", GoalStatus.ABORTED),
        ("set_succeeded", GoalStatus.SUCCEEDED),
    ],
)
def test_a_goal_ends_after_it_began(
    handle: ServerGoalHandle, server: Told, step: str, status: int
) -> None:
    handle.set_accepted()
    getattr(handle, step)(None, "why")
    assert server.told == ["status", (status, "why", None)]


def test_a_cancel_is_news_once(handle: ServerGoalHandle, server: Told) -> None:
    assert handle.set_cancel_requested()
    assert not handle.set_cancel_requested()
    assert server.told == ["status"]
    handle.set_accepted()
    assert handle.get_goal_status().status == GoalStatus.PREEMPTING


@pytest.mark.parametrize(
    ("step", "text"),
    [
        ("set_accepted", "an active state, the goal must be in a pending or recalling state"),
        ("set_rejected", "a rejected state, the goal must be in a pending or recalling state"),
        (
            "set_canceled",
            "a cancelled state, the goal must be in a pending, recalling, active, or preempting "
            "state",
        ),
        ("set_succeeded", "a succeeded state, the goal must be in a preempting or active state"),
        ("set_aborted", "an aborted state, the goal must be in a preempting or active state"),
    ],
)
def test_after_its_end_nothing_becomes_of_it(
    handle: ServerGoalHandle, server: Told, errors: list[str], step: str, text: str
) -> None:
    handle.set_rejected()
    server.told.clear()
    getattr(handle, step)()
    assert errors == [f"To transition to {text}, it is currently in state: 5"]
    assert server.told == []


def test_two_are_equal_if_they_are_of_one_goal(server: Told) -> None:
    one, other = handle_of("/client-1", server), handle_of("/client-2", server)
    assert one == handle_of("/client-1", server)
    assert one != other
    assert one != "/client-1"
    assert len({one, other, handle_of("/client-1", server)}) == 2


def test_one_of_no_goal_does_nothing(errors: list[str]) -> None:
    nothing = ServerGoalHandle()
    assert nothing.get_goal() is None
    assert nothing.get_default_result() is None
    assert nothing.get_goal_id().id == ""
    assert nothing.get_goal_status().status == GoalStatus.PENDING
    nothing.set_accepted()
    nothing.set_succeeded()
    nothing.publish_feedback(FibonacciFeedback())
    assert not nothing.set_cancel_requested()
    assert nothing != ServerGoalHandle()
    assert hash(nothing) == hash(ServerGoalHandle())
    assert [error.partition(" on an uninitialized ServerGoalHandle")[0] for error in errors] == [
        "Attempt to get a goal id",
        "Attempt to get goal status",
        "Attempt to set status",
        "Attempt to set status",
        "Attempt to publish feedback",
    ]
