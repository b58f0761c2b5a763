"""``fibws client``."""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest
from hub_in_thread import HubThread, Run
from node_in_thread import Peer, nothing, peer

from fibws.cli.client import HEADS
from fibws.cli.client import info as info_command
from fibws.cli.completers import nodes
from fibws.client import statistics
from fibws.client.hub_client import HubClient

QUICK = ("-d", "0.1")


@pytest.fixture
def talker(hub: HubThread) -> Iterator[Peer]:
    with peer(hub.url, "talker", nothing) as talker:
        yield talker


def entry(node: str = "/a", since: int = 1, **others: int) -> dict[str, object]:
    totals = ("messages_received", "bytes_received", "messages_sent", "bytes_sent")
    return {"node": node, "since": {"secs": since, "nsecs": 0}, **dict.fromkeys(totals, 0)} | others


def response(seconds: int, *clients: dict[str, object]) -> dict[str, object]:
    return {"stamp": {"secs": seconds, "nsecs": 0}, "clients": list(clients)}


def test_list_prints_a_table_of_the_others(run: Run, client: HubClient, talker: Peer) -> None:
    heads, *rows = run("client", "list", *QUICK).output.splitlines()
    assert heads.split() == list(HEADS)
    assert [row.split()[0] for row in rows] == sorted([client.node, "/talker"])
    row = rows[-1].split()
    assert (row[1], row[2].partition(":")[0], row[3]) == ("-", "127.0.0.1", "fibws.v1")


def test_list_prints_objects(run: Run, client: HubClient) -> None:
    client.call("/rosapi/get_time")
    found = [json.loads(line) for line in run("client", "list", "--json", *QUICK).output.split()]
    (mine,) = [each for each in found if each["node"] == client.node]
    assert mine["messages_received"] > 0
    assert mine["bytes_received"] > mine["messages_received"]
    assert mine["limited"] == mine["dropped"] == 0
    assert mine["messages_received_per_second"] >= 0


def test_info_prints_all_about_a_client(run: Run, client: HubClient, talker: Peer) -> None:
    output = run("client", "info", "talker", *QUICK).output
    assert "Node: /talker" in output
    assert "Protocol: fibws.v1" in output
    assert "/rosout" in output
    details = json.loads(run("client", "info", "/talker", "--json", *QUICK).output)
    assert [each["topic"] for each in details["published"]] == ["/rosout"]
    assert details["node"] == "/talker"
    assert details["advertisements"] >= 1
    assert "/talker/get_loggers" in details["services"]


def test_unknown_client_is_an_error(run: Run, client: HubClient, talker: Peer) -> None:
    result = run("client", "info", "/talke")
    assert result.exit_code == 1
    assert "/talke; did you mean /talker?" in result.output


def test_nodes_are_completed() -> None:
    (argument,) = [each for each in info_command.params if each.name == "node"]
    assert argument._custom_shell_complete is nodes


def test_rates_are_differences_by_the_hubs_clock() -> None:
    before = response(10, entry(messages_received=5, bytes_sent=100))
    now = response(12, entry("/b", bytes_received=8), entry(messages_received=25, bytes_sent=200))
    first, second = statistics.clients(before, now)
    assert (first["node"], second["node"]) == ("/a", "/b")
    assert first["messages_received_per_second"] == 10
    assert first["bytes_sent_per_second"] == 50
    assert second["bytes_received_per_second"] == 4


def test_client_that_has_reconnected_counts_from_0() -> None:
    before = response(10, entry(messages_received=500))
    (found,) = statistics.clients(before, response(11, entry(since=10, messages_received=7)))
    assert found["messages_received_per_second"] == 7


def test_same_response_twice_has_no_rates() -> None:
    now = response(10, entry(messages_received=500))
    assert statistics.clients(now, now)[0]["messages_received_per_second"] == 0
