"""The status and the id of a goal."""

from __future__ import annotations

import pytest

from fibws.msg import actionlib_msgs
from fibws.protocol.goals import RESULT, GoalStatus, goal_id, status_from_ros2


@pytest.mark.parametrize("status", GoalStatus)
def test_numbers_are_those_of_actionlib(status: GoalStatus) -> None:
    assert getattr(actionlib_msgs.GoalStatus, status.name) == status
    assert str(status) == status.name


def test_statuses_and_numbers_of_ros_2_correspond() -> None:
    assert [status_from_ros2(number).ros2 for number in range(7)] == list(range(7))
    assert {status.ros2 for status in GoalStatus} == set(range(7))
    assert GoalStatus.RECALLED.ros2 == GoalStatus.PREEMPTED.ros2 == 5


def test_goal_id_has_the_form_of_actionlib() -> None:
    assert goal_id("/node", 2, 1_700_000_000_500_000_000) == "/node-2-1700000000.500"


def test_type_of_a_topic_contains_the_type_of_the_action() -> None:
    assert RESULT.type_of("my_msgs/Wait") == "my_msgs/WaitActionResult"
