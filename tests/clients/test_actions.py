"""Actions by operation, as ROS 2 has them."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("actions")


CANCELED = 'GoalError: Action was canceled: {"sequence":[-1]}'


def test_an_action_by_operation_tells_its_progress_and_its_result(seen: Any) -> None:
    assert seen == {
        "feedback": [{"sequence": [0, 1, 1]}, {"sequence": [0, 1, 1, 2]}],
        "result": {"sequence": [0, 1, 1, 2]},
    }


def test_an_action_by_operation_can_fail(seen: Any) -> None:
    assert seen.startswith("GoalError: Action was aborted")


def test_a_goal_by_operation_can_be_cancelled(seen: Any) -> None:
    assert seen == CANCELED


def test_all_goals_by_operation_can_be_cancelled(seen: Any) -> None:
    assert seen == [CANCELED, CANCELED]


def test_goals_by_operation_run_side_by_side(seen: Any) -> None:
    assert seen == [{"sequence": [1]}, {"sequence": [2]}]


def test_a_goal_by_operation_fails_when_its_server_leaves(seen: Any) -> None:
    assert "/operations/leaving" in seen


def test_a_goal_by_operation_fails_when_nobody_serves_it(seen: Any) -> None:
    assert "/operations/nobody" in seen


def test_an_action_by_operation_can_be_withdrawn(seen: Any) -> None:
    assert "/operations/withdrawn" in seen
