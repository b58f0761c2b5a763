"""What ``fibws node`` and ``fibws topic`` show of ROS 1 nodes, and how they clean up."""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest
from fake_ros1_node import REFUSED, FakeRos1Node
from hub_in_thread import HubThread, Publish, Run

from fibws.client.hub_client import HubClient
from fibws.hub import Settings

CONFLICT = "publishes sensor_msgs/Image, the topic is std_msgs/Int32"


@pytest.fixture
def hub() -> Iterator[HubThread]:
    with HubThread(Settings(port=0, ros1=0, close_timeout=0.2)) as hub:
        yield hub


@pytest.fixture
def camera(hub: HubThread, publish: Publish) -> Iterator[FakeRos1Node]:
    """A node that publishes images on a topic of numbers."""
    publish("/numbers", "std_msgs/Int32")
    with FakeRos1Node("/camera", hub.master_uri) as camera:
        camera.publishes("/numbers", "sensor_msgs/Image")
        yield camera


@pytest.fixture
def gone(hub: HubThread) -> Iterator[FakeRos1Node]:
    """A node that does not answer."""
    with FakeRos1Node("/gone", hub.master_uri, REFUSED) as gone:
        gone.publishes("/status", "std_msgs/String")
        yield gone


# What is shown.


def test_addresses_of_ros1_nodes_are_uris(run: Run, camera: FakeRos1Node) -> None:
    assert f"{camera.api} \t/camera\n" in run("node", "list", "-a").output
    assert f"Address: {camera.api}\n" in run("node", "info", "/camera").output
    assert run("node", "machine").output == "127.0.0.1\n"
    assert "/camera\n" in run("node", "machine", "127.0.0.1").output


def test_conflict_is_named_at_the_node_and_at_the_topic(run: Run, camera: FakeRos1Node) -> None:
    assert f" * /numbers: {CONFLICT}\n" in run("node", "info", "/camera").output
    lines = run("topic", "info", "/numbers").output.splitlines()
    assert f" * /camera ({camera.api}) {CONFLICT}" in lines[lines.index("Conflicts: ") :]
    assert "Conflicts" not in run("topic", "info", "/rosout").output


def test_topic_list_counts_conflicts_apart(run: Run, camera: FakeRos1Node) -> None:
    camera.subscribes("/numbers", "sensor_msgs/Image")
    lines = run("topic", "list", "-v", "/numbers").output.splitlines()
    assert " * /numbers [std_msgs/Int32] 1 publisher, 1 conflict" in lines
    assert " * /numbers [std_msgs/Int32] 0 subscribers, 1 conflict" in lines
    (found,) = map(json.loads, run("topic", "list", "--json", "/numbers").output.splitlines())
    assert [each["node"] for each in found["conflicts"]] == ["/camera", "/camera"]


def test_node_that_does_not_answer_is_unreachable(run: Run, gone: FakeRos1Node) -> None:
    result = run("node", "ping", "-c", "1", "/gone")
    assert result.exit_code == 1
    assert "/gone" in result.output and gone.api in result.output
    assert "Unreachable: " in run("node", "info", "/gone").output


# Cleanup.


def test_cleanup_unregisters_only_unreachable_nodes(
    run: Run, camera: FakeRos1Node, gone: FakeRos1Node
) -> None:
    result = run("node", "cleanup", input="y\n")
    assert result.exit_code == 0, result.output
    assert "/gone: " in result.output and "Unregistering /gone\n" in result.output
    assert "/camera" not in result.output
    nodes = run("node", "list").output.splitlines()
    assert "/camera" in nodes and "/gone" not in nodes
    assert "/status" not in run("topic", "list").output
    assert run("node", "cleanup").output.startswith("Nothing to clean up: 1 ROS 1 node")


def test_cleanup_changes_nothing_without_consent(run: Run, gone: FakeRos1Node) -> None:
    assert run("node", "cleanup", input="n\n").output.endswith("aborting\n")
    closed = run("node", "cleanup", input="")
    assert closed.exit_code == 2 and "--yes" in closed.output
    assert "/gone" in run("node", "list").output


def test_cleanup_needs_no_consent_with_yes(run: Run, gone: FakeRos1Node) -> None:
    assert run("node", "cleanup", "--yes").exit_code == 0
    assert "/gone" not in run("node", "list").output


def test_node_that_answers_cannot_be_unregistered(
    run: Run, hub: HubThread, camera: FakeRos1Node
) -> None:
    run("node", "ping", "-c", "1", "/camera")
    with HubClient("caller", hub.url) as caller:
        for node in ("/camera", "/caller", "/nobody"):
            response = caller.call("/rosapi/unregister_node", {"node": node})
            assert not response["success"] and node in response["message"]
    assert "/camera" in run("node", "list").output
