"""Features of actionlib that roslib in JavaScript has and roslibpy lacks."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("actionlib_js")


ABORTED = 4


def test_action_can_abort(seen: Any) -> None:
    assert seen == {"feedback": [], "status": ABORTED, "result": {"sequence": [0]}}


def test_goals_of_others_can_be_followed(seen: Any) -> None:
    assert seen == [
        {"goal": {"order": 7}},
        {"feedback": {"sequence": [0]}},
        {"result": {"sequence": [7]}},
    ]
