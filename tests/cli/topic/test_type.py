"""``fibws topic type``."""

from __future__ import annotations

import json

import pytest
from hub_in_thread import Publish, Run


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("/pose", "geometry_msgs/PoseStamped"),
        ("pose/", "geometry_msgs/PoseStamped"),
        ("/pose/header", "geometry_msgs/PoseStamped header std_msgs/Header"),
        ("/pose/pose/position/x", "geometry_msgs/PoseStamped pose/position/x float64"),
    ],
)
def test_a_topic_and_its_fields_have_types(
    run: Run, publish: Publish, name: str, line: str
) -> None:
    publish("/pose", "geometry_msgs/PoseStamped")
    result = run("topic", "type", name)
    assert (result.exit_code, result.output) == (0, f"{line}\n")


def test_json_has_the_parts(run: Run, publish: Publish) -> None:
    publish("/path", "nav_msgs/Path")
    assert json.loads(run("topic", "type", "--json", "/path/poses").output) == {
        "topic": "/path",
        "type": "nav_msgs/Path",
        "field": "poses",
        "field_type": "geometry_msgs/PoseStamped[]",
    }


def test_unknown_topics_and_fields_are_errors(run: Run, publish: Publish) -> None:
    publish("/pose", "geometry_msgs/PoseStamped")
    topic, field = run("topic", "type", "/posse"), run("topic", "type", "/pose/x")
    assert topic.exit_code == field.exit_code == 1
    assert "[/posse]; did you mean /pose?" in topic.stderr
    assert "x in geometry_msgs/PoseStamped" in field.stderr
