"""A server's handle of a goal."""

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

from fibws.node.actions.status import GoalRecord


class Told:
    """Keeps what a server would publish."""

    ActionResultType = FibonacciResult

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.published: list[Any] = []

    def publish_status(self) -> None:
        self.published.append("status")

    def publish_feedback(self, status: Any, feedback: Any) -> None:
        self.published.append((status.status, feedback))

    def goal_ended(self, record: GoalRecord, result: Any) -> None:
        self.published.append((int(record.status), record.text, result))


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
    return ServerGoalHandle(GoalRecord(name, 3_000_000_004), cast(ActionServer, server), goal)


def test_goal_succeeds(handle: ServerGoalHandle, server: Told, errors: list[str]) -> None:
    handle.set_accepted("begun")
    assert handle.get_goal_status().status == GoalStatus.ACTIVE
    assert handle.get_goal_status().text == "begun"
    handle.publish_feedback(FibonacciFeedback([2]))
    handle.set_succeeded(FibonacciResult([8]), "done")
    assert server.published == [
        "status",
        (GoalStatus.ACTIVE, FibonacciFeedback([2])),
        (GoalStatus.SUCCEEDED, "done", FibonacciResult([8])),
    ]
    assert errors == []


def test_handle_returns_goal_and_id(handle: ServerGoalHandle) -> None:
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
def test_goal_can_end_before_it_is_accepted(
    handle: ServerGoalHandle, server: Told, step: str, status: int
) -> None:
    getattr(handle, step)()
    assert server.published == [(status, "", None)]


@pytest.mark.parametrize(
    ("step", "status"),
    [
        ("set_canceled", GoalStatus.PREEMPTED),
        ("set_aborted", GoalStatus.ABORTED),
        ("set_succeeded", GoalStatus.SUCCEEDED),
    ],
)
def test_goal_can_end_after_it_is_accepted(
    handle: ServerGoalHandle, server: Told, step: str, status: int
) -> None:
    handle.set_accepted()
    getattr(handle, step)(None, "why")
    assert server.published == ["status", (status, "why", None)]


def test_second_cancel_request_returns_false(handle: ServerGoalHandle, server: Told) -> None:
    assert handle.set_cancel_requested()
    assert not handle.set_cancel_requested()
    assert server.published == ["status"]
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
def test_transitions_after_the_end_are_refused(
    handle: ServerGoalHandle, server: Told, errors: list[str], step: str, text: str
) -> None:
    handle.set_rejected()
    server.published.clear()
    getattr(handle, step)()
    assert errors == [f"To transition to {text}, it is currently in state: 5"]
    assert server.published == []


def test_handles_of_the_same_goal_are_equal(server: Told) -> None:
    one, other = handle_of("/client-1", server), handle_of("/client-2", server)
    assert one == handle_of("/client-1", server)
    assert one != other
    assert one != "/client-1"
    assert len({one, other, handle_of("/client-1", server)}) == 2


def test_handle_without_goal_does_nothing(errors: list[str]) -> None:
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
