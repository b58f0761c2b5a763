"""Conditions in a manifest of format 3."""

from __future__ import annotations

import pytest

from fibws.ros1.workspace.condition import holds

VARIABLES = {"ROS_VERSION": "1", "ROS_DISTRO": "noetic"}


@pytest.mark.parametrize(
    ("condition", "met"),
    [
        ("$ROS_VERSION == 1", True),
        ("$ROS_VERSION == 2", False),
        ("$ROS_DISTRO != 'kinetic'", True),
        ('$ROS_DISTRO == "noetic" and $ROS_VERSION == 2', False),
        ("$ROS_VERSION == 2 or $ROS_DISTRO == noetic", True),
        ("$ROS_VERSION == 2 or $ROS_VERSION == 3 and 1 == 1", False),
        ("($ROS_VERSION == 2 or $ROS_VERSION == 1) and $ROS_DISTRO == noetic", True),
        ("$ROS_DISTRO > melodic", True),
        ("$ROS_DISTRO <= melodic", False),
        ("$UNKNOWN == ''", True),
    ],
)
def test_a_condition_compares_texts(condition: str, met: bool) -> None:
    assert holds(condition, VARIABLES) is met


@pytest.mark.parametrize(
    "text", ["", "$A", "$A ==", "== 1", "($A == 1", "$A == 1 and", "a b", "a == b c"]
)
def test_what_is_no_condition_is_said(text: str) -> None:
    with pytest.raises(ValueError, match="is no condition, as in"):
        holds(text, VARIABLES)


def test_the_environment_is_asked_by_default(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_VERSION", raising=False)
    assert holds("$ROS_VERSION == 1")
    monkeypatch.setenv("ROS_VERSION", "2")
    assert holds("$ROS_VERSION == 2")
