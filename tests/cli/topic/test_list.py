"""``fibws topic list``; rostopic's own shape is in `test_side_by_side`."""

from __future__ import annotations

import json

import pytest
from hub_in_thread import Publish, Run

OWN = ["/client_count", "/connected_clients", "/rosout", "/rosout_agg"]


def test_topics_are_listed_by_name(run: Run, publish: Publish) -> None:
    publish("/b", "std_msgs/Int32")
    publish("/a", "std_msgs/Int32")
    result = run("topic", "list")
    assert result.exit_code == 0
    assert result.output.splitlines() == ["/a", "/b", *OWN]


def test_those_of_a_namespace_are_listed(
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


def test_the_published_and_the_subscribed_are_told_apart(run: Run, publish: Publish) -> None:
    client = publish("/said", "std_msgs/Int32")
    client.subscribe("/heard")
    client.call("/rosapi/get_time")
    assert run("topic", "list", "-p").output.splitlines() == [*OWN, "/said"]
    assert run("topic", "list", "-s").output.splitlines() == ["/heard", "/rosout"]
    both = run("topic", "list", "-p", "-s")
    assert both.exit_code == 2
    assert "only specify one of -p, -s" in both.output


def test_verbose_tells_types_and_numbers(run: Run, publish: Publish) -> None:
    client = publish("/said", "std_msgs/Int32")
    client.subscribe("/said")
    client.call("/rosapi/get_time")
    lines = run("topic", "list", "-v", "/said").output.splitlines()
    assert lines == [
        *("", "Published topics:", " * /said [std_msgs/Int32] 1 publisher"),
        *("", "Subscribed topics:", " * /said [std_msgs/Int32] 1 subscriber", ""),
    ]


def test_json_is_an_object_a_line(run: Run, publish: Publish) -> None:
    client = publish("/said", "std_msgs/Int32")
    assert [
        json.loads(line) for line in run("topic", "list", "--json", "/said").output.split()
    ] == [
        {"name": "/said", "type": "std_msgs/Int32", "publishers": [client.node], "subscribers": []}
    ]
