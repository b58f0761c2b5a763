"""Names that are made up for goals."""

from __future__ import annotations

import re

import pytest
import rospy
from actionlib import GoalIDGenerator


@pytest.fixture(autouse=True)
def now(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rospy.Time, "now", lambda: rospy.Time(5, 7))


def test_ids_are_unique() -> None:
    generator = GoalIDGenerator("/server")
    first, second = generator.generate_ID(), generator.generate_ID()
    assert first.id != second.id
    assert re.fullmatch(r"/server-\d+-5\.7", first.id)
    assert first.stamp == rospy.Time(5, 7)


def test_ids_begin_with_the_name() -> None:
    generator = GoalIDGenerator("/server")
    generator.set_name("/other")
    assert generator.generate_ID().id.startswith("/other-")
