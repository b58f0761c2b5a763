"""The example servers with the services and actions of the ROS tutorials."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("tutorials")

PREEMPTED, SUCCEEDED = 2, 3


def test_tutorial_service_adds_two_ints(seen: Any) -> None:
    assert seen == {"sum": 3}


def test_tutorial_action_returns_the_sequence_and_can_be_cancelled(seen: Any) -> None:
    assert seen == {
        "done": {"sequence": [0, 1, 1, 2, 3, 5, 8], "status": SUCCEEDED},
        "cancelled": PREEMPTED,
    }
