"""Actions by operation, as ROS 2 has them."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("actions")


CANCELED = 'GoalError: Action was canceled: {"sequence":[-1]}'


def test_action_by_operation_sends_feedback_and_a_result(seen: Any) -> None:
    assert seen == {
        "feedback": [{"sequence": [0, 1, 1]}, {"sequence": [0, 1, 1, 2]}],
        "result": {"sequence": [0, 1, 1, 2]},
    }


def test_action_by_operation_can_fail(seen: Any) -> None:
    assert seen.startswith("GoalError: Action was aborted")


def test_goal_by_operation_can_be_cancelled(seen: Any) -> None:
    assert seen == CANCELED


def test_all_goals_by_operation_can_be_cancelled(seen: Any) -> None:
    assert seen == [CANCELED, CANCELED]


def test_goals_by_operation_run_concurrently(seen: Any) -> None:
    assert seen == [{"sequence": [1]}, {"sequence": [2]}]


def test_goal_by_operation_fails_when_its_server_leaves(seen: Any) -> None:
    assert "/operations/leaving" in seen


def test_goal_by_operation_fails_without_a_server(seen: Any) -> None:
    assert "/operations/nobody" in seen


def test_action_by_operation_can_be_unadvertised(seen: Any) -> None:
    assert "/operations/withdrawn" in seen
