"""``fibws topic info``; rostopic's own shape is in `test_side_by_side`."""

from __future__ import annotations

import json
import re

from hub_in_thread import Publish, Run


def test_a_topic_has_a_type_and_nodes_at_both_ends(run: Run, publish: Publish) -> None:
    client = publish("/chatter", "std_msgs/String")
    client.subscribe("/chatter")
    client.call("/rosapi/get_time")
    result = run("topic", "info", "chatter")
    assert result.exit_code == 0
    node = rf" \* {client.node} \(127\.0\.0\.1:\d+\)\n\n"
    assert re.fullmatch(
        f"Type: std_msgs/String\n\nPublishers: \n{node}Subscribers: \n{node}\n", result.output
    )


def test_nobody_is_none(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String")
    assert "Subscribers: None\n" in run("topic", "info", "/chatter").output


def test_the_hubs_own_nodes_are_where_the_hub_is(run: Run) -> None:
    assert re.search(r" \* /rosout \(127\.0\.0\.1:\d+\)", run("topic", "info", "/rosout").output)


def test_json_has_the_same(run: Run, publish: Publish) -> None:
    client = publish("/chatter", "std_msgs/String")
    found = json.loads(run("topic", "info", "--json", "/chatter").output)
    assert found.pop("publishers")[0]["node"] == client.node
    assert found == {"name": "/chatter", "type": "std_msgs/String", "subscribers": []}


def test_an_unknown_topic_is_an_error_with_the_nearest_name(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String")
    result = run("topic", "info", "/chater")
    assert result.exit_code == 1
    assert result.stderr == "Error: Unknown topic /chater; did you mean /chatter?\n"
