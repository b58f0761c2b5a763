"""The states of a goal for its client."""

from __future__ import annotations

import pytest
from actionlib import CommState, GoalStatus, SimpleGoalState, TerminalState
from actionlib.comm_state import following

STATES = [number for number in range(CommState.LOST)]
STATUSES = [number for number in range(GoalStatus.LOST)]


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("status", STATUSES)
def test_each_status_has_a_route_in_each_state(state: int, status: int) -> None:
    route = following(state, status)
    assert route is None or set(route) <= set(STATES) - {CommState.WAITING_FOR_GOAL_ACK}


def test_missed_states_are_passed_through() -> None:
    assert following(CommState.WAITING_FOR_GOAL_ACK, GoalStatus.SUCCEEDED) == (
        CommState.ACTIVE,
        CommState.WAITING_FOR_RESULT,
    )
    assert following(CommState.WAITING_FOR_CANCEL_ACK, GoalStatus.PREEMPTED) == (
        CommState.PREEMPTING,
        CommState.WAITING_FOR_RESULT,
    )


def test_unchanged_status_keeps_the_state() -> None:
    assert following(CommState.ACTIVE, GoalStatus.ACTIVE) == ()
    assert following(CommState.DONE, GoalStatus.SUCCEEDED) == ()


def test_goal_does_not_go_back() -> None:
    assert following(CommState.ACTIVE, GoalStatus.PENDING) is None
    assert following(CommState.DONE, GoalStatus.ACTIVE) is None


def test_unknown_status_is_an_error() -> None:
    with pytest.raises(KeyError):
        following(CommState.ACTIVE, GoalStatus.LOST)


def test_states_have_names() -> None:
    assert CommState.to_string(CommState.RECALLING) == "RECALLING"
    assert TerminalState.to_string(TerminalState.LOST) == "LOST"
    assert SimpleGoalState.to_string(SimpleGoalState.DONE) == "DONE"
    assert GoalStatus.to_string(GoalStatus.PENDING) == "PENDING"
    assert CommState.to_string(17) == "NO_SUCH_STATE_17"
