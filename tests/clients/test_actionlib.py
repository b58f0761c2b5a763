"""Actions over topics, with each client."""

from __future__ import annotations

from typing import Any

import pytest

from .casts import playing

pytestmark = playing("actionlib")


PREEMPTED, SUCCEEDED = 2, 3


@pytest.mark.long
def test_action_sends_feedback_and_a_result(seen: Any) -> None:
    assert seen == {
        "feedback": [{"sequence": [0, 1, 1, 2, 3][:length]} for length in (3, 4, 5)],
        "status": SUCCEEDED,
        "result": {"sequence": [0, 1, 1, 2, 3]},
    }


@pytest.mark.long
def test_goal_can_be_cancelled(seen: Any) -> None:
    assert seen == {
        "feedback": [{"sequence": [0, 1]}],
        "status": PREEMPTED,
        "result": {"sequence": []},
    }


def test_all_goals_can_be_cancelled(seen: Any) -> None:
    assert seen == {
        "feedback": [{"sequence": [0, 1]}],
        "status": PREEMPTED,
        "result": {"sequence": []},
    }


def test_newer_goal_replaces_the_older_one(seen: Any) -> None:
    assert seen == {
        "older": {
            "feedback": [{"sequence": [1]}],
            "status": PREEMPTED,
            "result": {"sequence": []},
        },
        "newer": {
            "feedback": [{"sequence": [2]}],
            "status": SUCCEEDED,
            "result": {"sequence": [2]},
        },
    }


def test_action_servers_are_listed(seen: Any) -> None:
    assert seen is True
