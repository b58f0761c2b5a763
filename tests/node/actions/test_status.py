"""The states of a goal."""

from __future__ import annotations

import pytest

from fibws.msg import actionlib_msgs
from fibws.node.actions.status import GoalStatus, Turn, following, of_ros2

FINAL = {
    GoalStatus.PREEMPTED,
    GoalStatus.SUCCEEDED,
    GoalStatus.ABORTED,
    GoalStatus.REJECTED,
    GoalStatus.RECALLED,
    GoalStatus.LOST,
}


@pytest.mark.parametrize("status", GoalStatus)
def test_the_numbers_are_those_of_actionlib(status: GoalStatus) -> None:
    assert getattr(actionlib_msgs.GoalStatus, status.name) == status
    assert str(status) == status.name


@pytest.mark.parametrize("status", GoalStatus)
def test_nothing_follows_a_final_status_and_something_follows_all_others(
    status: GoalStatus,
) -> None:
    goes_on = any(following(status, turn) is not None for turn in Turn)
    assert status.is_final == (status in FINAL) == (not goes_on)


@pytest.mark.parametrize(
    ("turns", "end"),
    [
        ([Turn.ACCEPT, Turn.SUCCEED], GoalStatus.SUCCEEDED),
        ([Turn.ACCEPT, Turn.ABORT], GoalStatus.ABORTED),
        ([Turn.ACCEPT, Turn.CANCEL], GoalStatus.PREEMPTED),
        ([Turn.ACCEPT, Turn.CANCEL_REQUEST], GoalStatus.PREEMPTING),
        ([Turn.ACCEPT, Turn.CANCEL_REQUEST, Turn.CANCEL], GoalStatus.PREEMPTED),
        ([Turn.ACCEPT, Turn.CANCEL_REQUEST, Turn.SUCCEED], GoalStatus.SUCCEEDED),
        ([Turn.ACCEPT, Turn.CANCEL_REQUEST, Turn.ABORT], GoalStatus.ABORTED),
        ([Turn.REJECT], GoalStatus.REJECTED),
        ([Turn.CANCEL], GoalStatus.RECALLED),
        ([Turn.CANCEL_REQUEST], GoalStatus.RECALLING),
        ([Turn.CANCEL_REQUEST, Turn.CANCEL], GoalStatus.RECALLED),
        ([Turn.CANCEL_REQUEST, Turn.REJECT], GoalStatus.REJECTED),
        ([Turn.CANCEL_REQUEST, Turn.ACCEPT], GoalStatus.PREEMPTING),
    ],
)
def test_a_goal_goes_through_actionlibs_states(turns: list[Turn], end: GoalStatus) -> None:
    status: GoalStatus | None = GoalStatus.PENDING
    for turn in turns:
        assert status is not None
        status = following(status, turn)
    assert status is end


@pytest.mark.parametrize(
    ("status", "turn"),
    [
        (GoalStatus.PENDING, Turn.SUCCEED),
        (GoalStatus.PENDING, Turn.ABORT),
        (GoalStatus.ACTIVE, Turn.REJECT),
        (GoalStatus.ACTIVE, Turn.ACCEPT),
        (GoalStatus.PREEMPTING, Turn.CANCEL_REQUEST),
    ],
)
def test_what_cannot_happen_changes_nothing(status: GoalStatus, turn: Turn) -> None:
    assert following(status, turn) is None


def test_ros_2_has_a_number_for_each_and_each_of_its_numbers_a_status() -> None:
    assert [of_ros2(number).ros2 for number in range(7)] == list(range(7))
    assert {status.ros2 for status in GoalStatus} == set(range(7))
    assert GoalStatus.RECALLED.ros2 == GoalStatus.PREEMPTED.ros2 == 5
