"""``fibws graph`` at a real hub."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner
from hub_in_thread import HubThread, Publish, Run

from fibws.cli.commands import command
from fibws.client.hub_client import HubClient


@pytest.fixture
def chatter(publish: Publish, hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> HubClient:
    """A node that publishes and subscribes to /chatter."""
    monkeypatch.delenv("COLUMNS", raising=False)
    client = publish("/chatter", "std_msgs/String", {"data": "hello"})
    client.send({"op": "subscribe", "topic": "/chatter"})
    client.call("/rosapi/get_time")
    return client


def test_publishers_topics_and_subscribers_are_drawn(run: Run, chatter: HubClient) -> None:
    result = run("graph")
    assert result.exit_code == 0, result.output
    node = chatter.node
    assert result.output.split("\n")[:3] == [
        "Topics",
        f"  {node} ───> [/chatter std_msgs/String] ───> {node}",
        "",
    ]
    assert "1 node, 1 topic, 0 services, 0 actions.\n" in result.output
    assert "/rosout" not in result.output
    assert "fibws_graph" not in result.output


def test_all_shows_hidden_names(run: Run, chatter: HubClient) -> None:
    result = run("graph", "--all")
    assert "/rosout ───" in result.output
    assert "/rosapi/graph" in result.output
    assert "fibws_graph" not in result.output


def test_only_a_namespace_is_shown(run: Run, chatter: HubClient) -> None:
    assert "/chatter" in run("graph", "chatter").output
    result = run("graph", "/elsewhere")
    assert "/elsewhere" in result.output.splitlines()[-1]
    assert "/chatter" not in result.output


def test_json_is_one_object(run: Run, chatter: HubClient) -> None:
    result = run("graph", "--json")
    assert result.output.count("\n") == 1
    shown = json.loads(result.output)
    assert shown["nodes"] == [chatter.node]
    assert [topic["name"] for topic in shown["topics"]] == ["/chatter"]


def test_dot_prints_graphviz(run: Run, chatter: HubClient) -> None:
    result = run("graph", "--dot")
    assert result.output.startswith("digraph graph_of_nodes {\n")
    assert f'"node {chatter.node}" -> "topic /chatter";' in result.output


def test_dot_and_json_exclude_each_other(run: Run) -> None:
    result = run("graph", "--dot", "--json")
    assert result.exit_code == 2
    assert "--dot and --json" in result.output


def test_empty_graph_suggests_the_demo(run: Run) -> None:
    result = run("graph")
    assert result.exit_code == 0
    assert "fibws demo" in result.output


def test_ascii_is_drawn_without_unicode(hub: HubThread, chatter: HubClient) -> None:
    result = CliRunner(charset="ascii").invoke(command, ["graph", "--hub", hub.url])
    assert result.exit_code == 0, result.output
    assert "---> [/chatter std_msgs/String] --->" in result.output


def test_invalid_namespace_is_an_error(run: Run) -> None:
    result = run("graph", "a b")
    assert result.exit_code == 1
    assert "'a b'" in result.output
