"""A client's handle of a goal."""

from __future__ import annotations

from typing import Any

import pytest
import rospy
from actionlib import ClientGoalHandle, CommState, CommStateMachine, GoalID, GoalStatus
from actionlib_tutorials.msg import (
    FibonacciActionFeedback,
    FibonacciActionGoal,
    FibonacciActionResult,
    FibonacciFeedback,
    FibonacciResult,
)


class Followed:
    """A goal, and all that was heard of it."""

    def __init__(self, name: str = "/client-1") -> None:
        self.states: list[str] = []
        self.feedback: list[Any] = []
        self.canceled: list[Any] = []
        self.machine = CommStateMachine(
            FibonacciActionGoal(goal_id=GoalID(id=name)),
            lambda handle: self.states.append(CommState.to_string(handle.get_comm_state())),
            lambda handle, feedback: self.feedback.append(feedback),
            self.canceled.append,
        )
        self.handle = ClientGoalHandle(self.machine)

    def hear(self, status: int, text: str = "") -> None:
        self.machine.update_status(GoalStatus(status=status, text=text))

    def end(self, status: int, result: int) -> None:
        message = FibonacciActionResult(
            status=GoalStatus(status=status), result=FibonacciResult([result])
        )
        self.machine.update_result(message)


@pytest.fixture(autouse=True)
def errors(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    found: list[str] = []
    monkeypatch.setattr(rospy, "logerr", found.append)
    monkeypatch.setattr(rospy, "logwarn", found.append)
    monkeypatch.setattr(rospy, "logdebug", lambda *args: None)
    return found


@pytest.fixture
def goal() -> Followed:
    return Followed()


def test_handle_follows_the_goal_to_its_end(goal: Followed, errors: list[str]) -> None:
    goal.hear(GoalStatus.PENDING)
    goal.hear(GoalStatus.ACTIVE, "begun")
    assert goal.handle.get_goal_status_text() == "begun"
    goal.machine.update_feedback(FibonacciActionFeedback(feedback=FibonacciFeedback([2])))
    assert goal.handle.get_result() is None
    goal.end(GoalStatus.SUCCEEDED, 8)
    assert goal.states == ["PENDING", "ACTIVE", "WAITING_FOR_RESULT", "DONE"]
    assert goal.feedback == [FibonacciFeedback([2])]
    assert goal.handle.get_result() == FibonacciResult([8])
    assert goal.handle.get_terminal_state() == GoalStatus.SUCCEEDED
    assert errors == []


def test_updates_after_the_end_are_ignored(goal: Followed, errors: list[str]) -> None:
    goal.end(GoalStatus.SUCCEEDED, 8)
    goal.hear(GoalStatus.ACTIVE)
    goal.machine.update_feedback(FibonacciActionFeedback())
    goal.handle.cancel()
    assert goal.handle.get_comm_state() == CommState.DONE
    assert goal.handle.get_goal_status() == GoalStatus.SUCCEEDED
    assert goal.feedback == goal.canceled == []
    goal.end(GoalStatus.ABORTED, 9)
    assert goal.handle.get_result() == FibonacciResult([8])
    assert errors == ["Got a result when we were already in the DONE state"]


def test_goal_is_canceled(goal: Followed) -> None:
    goal.hear(GoalStatus.ACTIVE)
    goal.handle.cancel()
    assert goal.canceled == [GoalID(id="/client-1")]
    goal.hear(GoalStatus.PREEMPTING)
    goal.end(GoalStatus.PREEMPTED, 0)
    assert goal.states == [
        "ACTIVE",
        "WAITING_FOR_CANCEL_ACK",
        "PREEMPTING",
        "WAITING_FOR_RESULT",
        "DONE",
    ]


def test_unlisted_goal_is_lost(goal: Followed) -> None:
    goal.machine.update_status(None)
    assert goal.handle.get_comm_state() == CommState.WAITING_FOR_GOAL_ACK
    goal.hear(GoalStatus.ACTIVE)
    goal.machine.update_status(None)
    assert goal.handle.get_comm_state() == CommState.DONE
    assert goal.handle.get_terminal_state() == GoalStatus.LOST
    assert goal.handle.get_result() is None


def test_unlisted_goal_that_waits_for_its_result_is_not_lost(goal: Followed) -> None:
    goal.hear(GoalStatus.SUCCEEDED)
    goal.machine.update_status(None)
    assert goal.handle.get_comm_state() == CommState.WAITING_FOR_RESULT


def test_invalid_status_is_logged(goal: Followed, errors: list[str]) -> None:
    goal.hear(GoalStatus.ACTIVE)
    goal.hear(GoalStatus.PENDING)
    goal.hear(77)
    assert errors == [
        "Invalid goal status transition from ACTIVE to PENDING",
        "Got an unknown status from the ActionServer: 77",
    ]
    assert goal.handle.get_comm_state() == CommState.ACTIVE


def test_terminal_state_before_the_end_is_logged(goal: Followed, errors: list[str]) -> None:
    assert goal.handle.get_terminal_state() == GoalStatus.LOST
    assert errors == [
        "Asking for the terminal state when we're in [WAITING_FOR_GOAL_ACK]",
        "Asking for a terminal state, but the goal status is 0",
    ]


def test_handles_of_the_same_goal_are_equal(goal: Followed) -> None:
    same, other = Followed(), Followed("/client-2")
    assert goal.handle == same.handle
    assert goal.handle != other.handle
    assert goal.handle != None  # noqa: E711
    assert len({goal.handle, same.handle, other.handle}) == 2


def test_callbacks_are_optional() -> None:
    machine = CommStateMachine(FibonacciActionGoal(), None, None, print)
    machine.update_feedback(FibonacciActionFeedback())
    machine.update_status(GoalStatus(status=GoalStatus.ACTIVE))
    assert machine.state == CommState.ACTIVE
