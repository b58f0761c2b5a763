"""What a node's actions have in common."""

from __future__ import annotations

from fibws.node.actions.actions import Actions


def test_goals_have_names_of_their_own_whatever_the_time(actions: Actions) -> None:
    assert [actions.goal_id() for _ in range(2)] == [
        "/node-1-1700000000.500",
        "/node-2-1700000000.500",
    ]
