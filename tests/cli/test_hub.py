"""``fibws hub list`` and ``fibws hub info``."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
from hub_in_thread import HubThread, Run
from node_in_thread import nothing, peer

from fibws.cli.doctor.hubs import checks
from fibws.cli.hub import HEADS
from fibws.client import statistics
from fibws.client.graph_snapshot import GraphSnapshot
from fibws.client.hub_client import HubClient
from fibws.hub import Settings

QUICK = ("-d", "0.1")


@pytest.fixture
def robot(hub: HubThread) -> Iterator[HubThread]:
    """A hub that is joined to the hub of the test, with a node."""
    settings = Settings(port=0, hub_name="robot7", join=(hub.url,), join_prefix="/robot7")
    with (
        HubThread(settings) as robot,
        peer(robot.url, "camera", nothing),
        HubClient("waiting", hub.url) as client,
    ):
        while "/robot7/camera" not in [each["name"] for each in GraphSnapshot(client).nodes]:
            client.process(0.01)
        yield robot


def link(**others: Any) -> dict[str, Any]:
    totals = ("messages_received", "bytes_received", "messages_sent", "bytes_sent")
    texts = {"id": "a", "kind": "join", "name": "cloud", "address": "wss://cloud", "fault": ""}
    numbers = {"clock_offset": 0.0, "dropped": 0, "lost": 0, "since": {"secs": 1, "nsecs": 0}}
    return {**texts, **numbers, **dict.fromkeys(totals, 0), **others}


def response(seconds: int, *links: dict[str, Any]) -> dict[str, Any]:
    return {"stamp": {"secs": seconds, "nsecs": 0}, "links": list(links)}


def test_list_prints_the_links(run: Run, robot: HubThread) -> None:
    first, heads, row = run("hub", "list", *QUICK).output.splitlines()
    assert first.startswith("This hub: ")
    assert heads.split() == list(HEADS)
    assert row.split()[:2] == ["robot7", "accept"]
    (found,) = [
        json.loads(line) for line in run("hub", "list", "--json", *QUICK).output.split("\n") if line
    ]
    assert found["round_trip"] > 0
    assert found["bytes_received"] > 0


def test_list_without_links_tells_how_to_join(run: Run) -> None:
    assert "--join" in run("hub", "list", *QUICK).output


def test_info_prints_a_hub_and_its_nodes(run: Run, robot: HubThread) -> None:
    output = run("hub", "info", "robot7", *QUICK).output
    assert "Hub: robot7" in output
    assert " * /robot7/camera" in output
    own = json.loads(run("hub", "info", "--json", *QUICK).output)
    assert own["distance"] == 0
    assert "/robot7/camera" not in own["nodes"]
    assert [each["name"] for each in own["links"]] == ["robot7"]


def test_unknown_hub_gets_a_suggestion(run: Run, robot: HubThread) -> None:
    result = run("hub", "info", "robto7", *QUICK)
    assert result.exit_code != 0
    assert "robot7" in str(result.output) + str(result.exception)


def test_link_that_is_down_is_listed_with_the_reason(run: Run) -> None:
    with HubThread(Settings(port=0, join=("ws://127.0.0.1:1",))) as hub:
        output = run("hub", "list", "--hub", hub.url, *QUICK).output
    assert "down: " in output


def test_node_of_another_hub_is_shown_with_it(run: Run, robot: HubThread) -> None:
    assert "Hub: robot7" in run("node", "info", "/robot7/camera").output
    assert "hub robot7" in run("node", "list", "-a").output


def test_help_has_the_options_of_running_a_hub_and_the_commands(run: Run) -> None:
    output = run("hub", "--help").output
    assert "--port" in output
    assert "--join" in output
    assert "list" in output


def test_unknown_command_is_refused(run: Run) -> None:
    result = run("hub", "lst")
    assert result.exit_code == 2
    assert "list" in result.output


def test_rates_are_those_between_two_responses() -> None:
    before = response(10, link(messages_sent=100))
    (found,) = statistics.links(before, response(12, link(messages_sent=300)))
    assert found["messages_sent_per_second"] == 100
    (new,) = statistics.links(
        before, response(12, link(messages_sent=4, since={"secs": 11, "nsecs": 0}))
    )
    assert new["messages_sent_per_second"] == 2


def test_doctor_finds_links_with_problems() -> None:
    assert list(checks(response(1), response(2))) == []
    (fine,) = checks(response(1, link()), response(2, link()))
    assert fine.verdict == "ok"
    bad = response(
        2,
        link(fault="Connection refused"),
        link(id="b", clock_offset=-3.0),
        link(id="c", dropped=2),
    )
    found = list(checks(response(1, link(), link(id="b"), link(id="c")), bad))
    assert [each.verdict for each in found] == ["warning"] * 3
    assert "Connection refused" in found[0].text
    assert "-3.0 s" in found[1].text
    assert "drops" in found[2].text
