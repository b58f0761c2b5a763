"""Checks of the hub as the master of ROS 1 nodes."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

import pytest
from fake_ros1_node import REFUSED, FakeRos1Node
from hub_in_thread import HubThread

from fibws.cli import doctor
from fibws.cli.doctor import graph, ros1
from fibws.cli.doctor.finding import Finding
from fibws.client.hub_client import HubClient
from fibws.hub import Settings

ROS1 = ("master", "ros1 nodes")
REMOTE = "ws://192.0.2.1:9090"
"""A hub on another machine."""


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "INTERVAL", 0.0)
    for name in ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def hub() -> Iterator[HubThread]:
    with HubThread(Settings(port=0, ros1=0, close_timeout=0.2)) as hub:
        yield hub


def found(hub: HubThread) -> dict[str, list[Finding]]:
    """Return the doctor's findings about ROS 1 by their checks."""
    by_check: dict[str, list[Finding]] = {}
    for finding in doctor.findings(hub.url):
        if finding.check in ROS1:
            by_check.setdefault(finding.check, []).append(finding)
    return by_check


def node(api: str, fault: str = "") -> dict[str, Any]:
    return {"name": "/camera", "api": api, "fault": fault}


def reached(*nodes: dict[str, Any], is_hub_here: bool = True) -> list[Finding]:
    return list(ros1.reachability(list(nodes), is_hub_here=is_hub_here))


# The master.


def test_master_of_the_hub_is_recognized(hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", hub.master_uri)
    ((finding,),) = found(hub).values()
    assert (finding.check, finding.verdict) == ("master", "ok")
    assert hub.master_uri in finding.text


def test_shell_of_another_master_is_told_the_uri_of_the_hub(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    with HubThread(Settings(port=0, ros1=0, close_timeout=0.2)) as other:
        monkeypatch.setenv("ROS_MASTER_URI", other.master_uri)
        (finding,) = found(hub)["master"]
    assert finding.verdict == "warning"
    assert "is not this hub" in finding.text and other.master_uri in finding.text
    assert f"export ROS_MASTER_URI={hub.master_uri}" in finding.advice


@pytest.mark.parametrize("uri", [REFUSED, "localhost:11311", "http://[x"])
def test_master_that_does_not_answer_is_a_warning(
    hub: HubThread, uri: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", uri)
    (finding,) = found(hub)["master"]
    assert finding.verdict == "warning" and f"ROS_MASTER_URI={uri}" in finding.text
    assert f"export ROS_MASTER_URI={hub.master_uri}" in finding.advice


def test_unset_variable_is_fine_if_the_hub_is_at_the_usual_port(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ros1, "DEFAULT", hub.master_uri)
    (finding,) = found(hub)["master"]
    assert finding.verdict == "ok"
    assert f"export ROS_MASTER_URI={hub.master_uri}" in finding.text


def test_hub_without_a_master_is_a_warning_only_if_one_is_wanted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with HubThread() as plain:
        assert found(plain) == {}
        monkeypatch.setenv("ROS_MASTER_URI", REFUSED)
        monkeypatch.setattr(ros1, "PORT", 9)
        (finding,) = found(plain)["master"]
    assert finding.verdict == "warning" and "--ros1" in finding.advice


def test_roscore_at_the_hubs_port_has_to_be_stopped(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ros1, "PORT", urlsplit(hub.master_uri).port)
    monkeypatch.setenv("ROS_MASTER_URI", hub.master_uri)
    with HubThread() as plain:
        (finding,) = found(plain)["master"]
    assert finding.verdict == "warning" and "is not this hub" in finding.text
    assert finding.advice.startswith("Stop that master")


def test_master_that_only_the_hubs_machine_reaches_needs_an_option(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(uri: str, method: str, *arguments: object) -> object:
        raise ConnectionRefusedError(uri)

    monkeypatch.setattr(ros1, "_call", refuse)
    (finding,) = ros1.master(REMOTE, "id", 11311, has_nodes=False)
    assert finding.verdict == "warning"
    assert "--ros1-allow" in finding.advice and "http://192.0.2.1:11311/" in finding.advice


# The nodes.


def test_nodes_that_answer_are_fine(hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", hub.master_uri)
    with FakeRos1Node("/camera", hub.master_uri) as camera:
        camera.publishes("/image", "std_msgs/String")
        findings = found(hub)
    assert findings.keys() == set(ROS1)
    assert {each.verdict for (each,) in findings.values()} == {"ok"}


def test_node_that_does_not_answer_is_a_warning(hub: HubThread) -> None:
    with (
        FakeRos1Node("/gone", hub.master_uri, REFUSED) as gone,
        HubClient("other", hub.url) as client,
    ):
        gone.publishes("/image", "std_msgs/String")
        assert not client.call("/rosapi/ping_node", {"node": "/gone"})["success"]
        (finding,) = found(hub)["ros1 nodes"]
    assert finding.verdict == "warning"
    assert "/gone" in finding.text and REFUSED in finding.text
    assert "node cleanup" in finding.advice and "ROS_IP" in finding.advice


def test_node_that_only_the_hub_reaches_is_wrong() -> None:
    (finding,) = reached(node(REFUSED))
    assert finding.verdict == "wrong"
    assert "not this machine" in finding.text and "directly" in finding.advice


def test_host_that_does_not_resolve_is_wrong() -> None:
    first, second = node("http://robot.invalid:1/"), node("http://robot.invalid:2/")
    (finding,) = reached(first, {**second, "name": "/lidar", "fault": "unknown host"})
    assert finding.verdict == "wrong"
    assert all(word in finding.text for word in ("robot.invalid", "/camera", "/lidar"))
    assert "/etc/hosts" in finding.advice and "ROS_HOSTNAME" in finding.advice


def test_loopback_address_of_a_node_on_another_machine_is_wrong() -> None:
    (finding,) = reached(node("http://localhost:1/"), is_hub_here=False)
    assert finding.verdict == "wrong" and "http://localhost:1/" in finding.text
    assert "ROS_IP" in finding.advice


def test_port_that_speaks_something_else_is_no_node(hub: HubThread) -> None:
    (finding,) = reached(node(hub.url.replace("ws", "http", 1)))
    assert finding.verdict == "wrong" and "unexpected answer" in finding.text


def test_port_that_never_answers_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ros1, "PATIENCE", 0.05)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        (finding,) = reached(node(f"http://127.0.0.1:{silent.getsockname()[1]}/"))
    assert finding.verdict == "wrong" and "timed out" in finding.text


# Conflicts.


def test_conflict_of_types_is_a_warning(hub: HubThread) -> None:
    with (
        HubClient("other", hub.url) as client,
        FakeRos1Node("/camera", hub.master_uri) as camera,
    ):
        client.send({"op": "advertise", "topic": "/numbers", "type": "std_msgs/Int32"})
        client.call("/rosapi/get_time")
        camera.publishes("/numbers", "sensor_msgs/Image")
        (finding,) = [each for each in doctor.findings(hub.url) if each.check == "conflicts"]
    assert finding.verdict == "warning"
    for word in ("/camera", "/numbers", "sensor_msgs/Image", "std_msgs/Int32"):
        assert word in finding.text
    assert "/numbers:=" in finding.advice


def test_missing_right_of_ros1_nodes_is_a_warning() -> None:
    conflict = {"node": "/camera", "type": "a/B", "publishes": True, "fault": "not allowed"}
    (finding,) = graph.conflicts([{"name": "/image", "type": "a/B", "conflicts": [conflict]}])
    assert finding.verdict == "warning" and "not allowed" in finding.text
    assert "[ros1]" in finding.advice


def test_other_definition_of_a_type_is_a_warning(hub: HubThread) -> None:
    with HubClient("first", hub.url) as first, HubClient("second", hub.url) as second:
        for client, definition in ((first, "int8 x"), (second, "int16 x")):
            operation = {"op": "advertise", "topic": "/a", "type": "my_msgs/Thing"}
            client.send({**operation, "definition": definition})
            client.call("/rosapi/get_time")
        (finding,) = [each for each in doctor.findings(hub.url) if each.check == "conflicts"]
    assert finding.verdict == "warning" and "with other fields" in finding.text
    assert "package my_msgs" in finding.advice
