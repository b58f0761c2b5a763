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
    """A node that publishes and hears /chatter."""
    monkeypatch.delenv("COLUMNS", raising=False)
    client = publish("/chatter", "std_msgs/String", {"data": "hello"})
    client.send({"op": "subscribe", "topic": "/chatter"})
    client.call("/rosapi/get_time")
    return client


def test_it_draws_who_publishes_what_to_whom(run: Run, chatter: HubClient) -> None:
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


def test_all_shows_what_belongs_to_ros(run: Run, chatter: HubClient) -> None:
    result = run("graph", "--all")
    assert "/rosout ───" in result.output
    assert "/rosapi/graph" in result.output
    assert "fibws_graph" not in result.output


def test_a_namespace_is_all_that_is_shown(run: Run, chatter: HubClient) -> None:
    assert "/chatter" in run("graph", "chatter").output
    result = run("graph", "/elsewhere")
    assert result.output.endswith("No node is in /elsewhere.\n")
    assert "/chatter" not in result.output


def test_json_is_one_object(run: Run, chatter: HubClient) -> None:
    result = run("graph", "--json")
    assert result.output.count("\n") == 1
    told = json.loads(result.output)
    assert told["nodes"] == [chatter.node]
    assert [topic["name"] for topic in told["topics"]] == ["/chatter"]


def test_dot_is_graphviz(run: Run, chatter: HubClient) -> None:
    result = run("graph", "--dot")
    assert result.output.startswith("digraph graph_of_nodes {\n")
    assert f'"node {chatter.node}" -> "topic /chatter";' in result.output


def test_dot_and_json_are_two_things(run: Run) -> None:
    result = run("graph", "--dot", "--json")
    assert result.exit_code == 2
    assert "--dot or --json, not both" in result.output


def test_an_empty_graph_says_how_to_fill_it(run: Run) -> None:
    result = run("graph")
    assert result.exit_code == 0
    assert result.output.endswith("No node is here yet. To see some: fibws demo\n")


def test_what_cannot_show_lines_gets_ascii(hub: HubThread, chatter: HubClient) -> None:
    result = CliRunner(charset="ascii").invoke(command, ["graph", "--hub", hub.url])
    assert result.exit_code == 0, result.output
    assert "---> [/chatter std_msgs/String] --->" in result.output


def test_a_namespace_that_is_no_name_is_told(run: Run) -> None:
    result = run("graph", "a b")
    assert result.exit_code == 1
    assert result.output.startswith("Error: 'a b' is not a legal name")
