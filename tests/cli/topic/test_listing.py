"""``fibws topic list``, ``info``, ``type``, ``find``; compared with ROS in `test_side_by_side`."""

from __future__ import annotations

import json
import re

import pytest
from hub_in_thread import Publish, Run

OWN = ["/client_count", "/connected_clients", "/rosout", "/rosout_agg"]


def test_topics_are_listed_by_name(run: Run, publish: Publish) -> None:
    publish("/b", "std_msgs/Int32")
    publish("/a", "std_msgs/Int32")
    result = run("topic", "list")
    assert result.exit_code == 0
    assert result.output.splitlines() == ["/a", "/b", *OWN]


def test_topics_of_a_namespace_are_listed(
    run: Run, publish: Publish, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("/arm", "/arm/joints", "/army"):
        publish(name, "std_msgs/Int32")
    assert run("topic", "list", "/arm").output.splitlines() == ["/arm", "/arm/joints"]
    assert run("topic", "list", "arm/").output.splitlines() == ["/arm", "/arm/joints"]
    assert set(run("topic", "list", "/").output.splitlines()) >= {"/army", *OWN}
    assert run("topic", "list", "a b").exit_code == 1
    monkeypatch.setenv("ROS_NAMESPACE", "/arm")
    assert run("topic", "list", "joints").output.splitlines() == ["/arm/joints"]


def test_published_and_subscribed_topics_are_listed_separately(run: Run, publish: Publish) -> None:
    client = publish("/out", "std_msgs/Int32")
    client.subscribe("/in")
    client.call("/rosapi/get_time")
    assert run("topic", "list", "-p").output.splitlines() == sorted(["/out", *OWN])
    assert run("topic", "list", "-s").output.splitlines() == ["/in", "/rosout"]
    both = run("topic", "list", "-p", "-s")
    assert both.exit_code == 2
    assert "only specify one of -p, -s" in both.output


def test_verbose_lists_types_and_numbers(run: Run, publish: Publish) -> None:
    client = publish("/out", "std_msgs/Int32")
    client.subscribe("/out")
    client.call("/rosapi/get_time")
    lines = run("topic", "list", "-v", "/out").output.splitlines()
    assert lines == [
        *("", "Published topics:", " * /out [std_msgs/Int32] 1 publisher"),
        *("", "Subscribed topics:", " * /out [std_msgs/Int32] 1 subscriber", ""),
    ]


def test_list_prints_a_json_object_per_line(run: Run, publish: Publish) -> None:
    client = publish("/out", "std_msgs/Int32")
    assert [json.loads(line) for line in run("topic", "list", "--json", "/out").output.split()] == [
        {
            "name": "/out",
            "type": "std_msgs/Int32",
            "publishers": [client.node],
            "subscribers": [],
            "conflicts": [],
        }
    ]


def test_topic_has_a_type_and_nodes_at_both_ends(run: Run, publish: Publish) -> None:
    client = publish("/chatter", "std_msgs/String")
    client.subscribe("/chatter")
    client.call("/rosapi/get_time")
    result = run("topic", "info", "chatter")
    assert result.exit_code == 0
    node = rf" \* {client.node} \(127\.0\.0\.1:\d+\)\n\n"
    assert re.fullmatch(
        f"Type: std_msgs/String\n\nPublishers: \n{node}Subscribers: \n{node}\n", result.output
    )


def test_no_subscribers_are_none(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String")
    assert "Subscribers: None\n" in run("topic", "info", "/chatter").output


def test_nodes_of_the_hub_have_its_address(run: Run) -> None:
    assert re.search(r" \* /rosout \(127\.0\.0\.1:\d+\)", run("topic", "info", "/rosout").output)


def test_info_as_json(run: Run, publish: Publish) -> None:
    client = publish("/chatter", "std_msgs/String")
    found = json.loads(run("topic", "info", "--json", "/chatter").output)
    assert found.pop("publishers")[0]["node"] == client.node
    assert found == {
        "name": "/chatter",
        "type": "std_msgs/String",
        "subscribers": [],
        "conflicts": [],
    }


def test_unknown_topic_is_an_error_with_a_suggestion(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String")
    result = run("topic", "info", "/chater")
    assert result.exit_code == 1
    assert "/chater; did you mean /chatter?" in result.stderr


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("/pose", "geometry_msgs/PoseStamped"),
        ("pose/", "geometry_msgs/PoseStamped"),
        ("/pose/header", "geometry_msgs/PoseStamped header std_msgs/Header"),
        ("/pose/pose/position/x", "geometry_msgs/PoseStamped pose/position/x float64"),
    ],
)
def test_topic_and_its_fields_have_types(run: Run, publish: Publish, name: str, line: str) -> None:
    publish("/pose", "geometry_msgs/PoseStamped")
    result = run("topic", "type", name)
    assert (result.exit_code, result.output) == (0, f"{line}\n")


def test_type_as_json(run: Run, publish: Publish) -> None:
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


def test_topics_of_a_type_are_found(run: Run, publish: Publish) -> None:
    publish("/b", "std_msgs/String")
    publish("/a", "std_msgs/String")
    assert run("topic", "find", "std_msgs/String").output == "/a\n/b\n"
    assert run("topic", "find", "std_msgs/msg/String").output == "/a\n/b\n"
    assert run("topic", "find", "--json", "std_msgs/String").output == '"/a"\n"/b"\n'


def test_type_may_have_no_topics(run: Run) -> None:
    result = run("topic", "find", "std_msgs/String")
    assert (result.exit_code, result.output) == (0, "")


def test_type_without_a_package_is_found_in_all_packages(run: Run, publish: Publish) -> None:
    publish("/goal", "geometry_msgs/Pose")
    publish("/turtle", "turtlesim/Pose")
    publish("/posture", "my_msgs/BodyPose")
    assert run("topic", "find", "Pose").output == "/goal\n/turtle\n"
    assert run("topic", "find", "BodyPose").output == "/posture\n"
    assert run("topic", "find", "Imu").output == ""


def test_unknown_type_without_a_package_is_an_error(run: Run) -> None:
    result = run("topic", "find", "Strng")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "'Strng'; did you mean std_msgs/String?" in result.stderr
