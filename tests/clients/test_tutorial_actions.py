"""The action of ROS 2's tutorial, by operation."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("tutorial_actions")


def test_tutorial_action_returns_the_sequence_by_operation(seen: Any) -> None:
    assert seen == {"sequence": [0, 1, 1, 2, 3, 5], "feedback": [3, 4, 5, 6]}
