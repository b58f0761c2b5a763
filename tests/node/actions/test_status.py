"""The states of a goal."""

from __future__ import annotations

import pytest

from fibws.msg import actionlib_msgs
from fibws.node.actions.status import GoalStatus, Transition, following, of_ros2

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
    goes_on = any(following(status, transition) is not None for transition in Transition)
    assert status.is_final == (status in FINAL) == (not goes_on)


@pytest.mark.parametrize(
    ("transitions", "end"),
    [
        ([Transition.ACCEPT, Transition.SUCCEED], GoalStatus.SUCCEEDED),
        ([Transition.ACCEPT, Transition.ABORT], GoalStatus.ABORTED),
        ([Transition.ACCEPT, Transition.CANCEL], GoalStatus.PREEMPTED),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST], GoalStatus.PREEMPTING),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST, Transition.CANCEL], GoalStatus.PREEMPTED),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST, Transition.SUCCEED], GoalStatus.SUCCEEDED),
        ([Transition.ACCEPT, Transition.CANCEL_REQUEST, Transition.ABORT], GoalStatus.ABORTED),
        ([Transition.REJECT], GoalStatus.REJECTED),
        ([Transition.CANCEL], GoalStatus.RECALLED),
        ([Transition.CANCEL_REQUEST], GoalStatus.RECALLING),
        ([Transition.CANCEL_REQUEST, Transition.CANCEL], GoalStatus.RECALLED),
        ([Transition.CANCEL_REQUEST, Transition.REJECT], GoalStatus.REJECTED),
        ([Transition.CANCEL_REQUEST, Transition.ACCEPT], GoalStatus.PREEMPTING),
    ],
)
def test_a_goal_goes_through_actionlibs_states(
    transitions: list[Transition], end: GoalStatus
) -> None:
    status: GoalStatus | None = GoalStatus.PENDING
    for transition in transitions:
        assert status is not None
        status = following(status, transition)
    assert status is end


@pytest.mark.parametrize(
    ("status", "transition"),
    [
        (GoalStatus.PENDING, Transition.SUCCEED),
        (GoalStatus.PENDING, Transition.ABORT),
        (GoalStatus.ACTIVE, Transition.REJECT),
        (GoalStatus.ACTIVE, Transition.ACCEPT),
        (GoalStatus.PREEMPTING, Transition.CANCEL_REQUEST),
    ],
)
def test_what_cannot_happen_changes_nothing(status: GoalStatus, transition: Transition) -> None:
    assert following(status, transition) is None


def test_ros_2_has_a_number_for_each_and_each_of_its_numbers_a_status() -> None:
    assert [of_ros2(number).ros2 for number in range(7)] == list(range(7))
    assert {status.ros2 for status in GoalStatus} == set(range(7))
    assert GoalStatus.RECALLED.ros2 == GoalStatus.PREEMPTED.ros2 == 5
