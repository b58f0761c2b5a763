"""The programs of this package that serve what ROS's tutorials do."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("tutorials")

PREEMPTED, SUCCEEDED = 2, 3


def test_the_service_of_the_tutorial_adds_two_ints(seen: Any) -> None:
    assert seen == {"sum": 3}


def test_the_action_of_the_tutorial_gives_the_series_and_can_be_cancelled(seen: Any) -> None:
    assert seen == {
        "done": {"sequence": [0, 1, 1, 2, 3, 5, 8], "status": SUCCEEDED},
        "cancelled": PREEMPTED,
    }
