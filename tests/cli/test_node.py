"""``fibws node``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import pytest
from hub_in_thread import HubThread, Run
from node_in_thread import Peer, nothing, peer

from fibws.cli import node
from fibws.client.hub_client import HubClient
from fibws.errors import NodeKilled

OWN = ["/rosapi", "/rosbridge_websocket", "/rosout"]


@pytest.fixture
def talker(hub: HubThread) -> Iterator[Peer]:
    with peer(hub.url, "talker", nothing) as talker:
        yield talker


def connected(client: HubClient, url: str) -> str:
    """The address of a client's own end."""
    with HubClient("other", url) as other:
        nodes = other.call("/rosapi/graph")["nodes"]
    return str(next(each["address"] for each in nodes if each["name"] == client.node))


# list


def test_list_prints_all_nodes_except_the_tool(run: Run, client: HubClient) -> None:
    assert run("node", "list").output.splitlines() == sorted([*OWN, client.node])


def test_list_takes_a_namespace(run: Run, client: HubClient) -> None:
    assert run("node", "list", "/rosapi").output == "/rosapi\n"
    assert run("node", "list", "/ros").output == ""


def test_list_prints_addresses(run: Run, hub: HubThread, client: HubClient) -> None:
    address, hubs = connected(client, hub.url), f"127.0.0.1:{hub.port}"
    assert run("node", "list", "-a").output.splitlines() == [
        f"{address} \t{client.node}",
        *(f"{hubs} \t{name}" for name in OWN),
    ]
    assert run("node", "list", "-u").output.splitlines() == [address, hubs, hubs, hubs]


def test_machine_lists_addresses_or_nodes(run: Run, client: HubClient) -> None:
    assert run("node", "machine").output == "127.0.0.1\n"
    assert run("node", "machine", "127.0.0.1").output == run("node", "list").output
    result = run("node", "machine", "10.0.0.1")
    assert result.exit_code == 1
    assert "10.0.0.1" in result.output and "127.0.0.1" in result.output


def test_cleanup_leaves_nodes_of_the_hub_alone(run: Run, talker: Peer) -> None:
    result = run("node", "cleanup", "--yes")
    assert result.exit_code == 0
    assert "/talker" in run("node", "list").output


def test_list_prints_one_json_object_per_line(run: Run, hub: HubThread) -> None:
    found = [json.loads(line) for line in run("node", "list", "--json").output.splitlines()]
    assert [each["name"] for each in found] == OWN
    assert {each["address"] for each in found} == {f"127.0.0.1:{hub.port}"}
    assert all(each["own"] for each in found)


# info


def test_info_has_the_format_of_rosnode(run: Run, hub: HubThread, client: HubClient) -> None:
    client.send({"op": "advertise", "topic": "/rosout", "type": "rosgraph_msgs/Log"})
    client.send({"op": "subscribe", "topic": "/untyped"})
    client.send({"op": "subscribe", "topic": "/rosout_agg", "compression": "cbor"})
    client.send({"op": "advertise_service", "service": "/serve", "type": "std_srvs/Empty"})
    client.call("/rosapi/get_time")
    own = f"127.0.0.1:{hub.port}"
    result = run("node", "info", client.node)
    text = re.sub(r"(?m)^Since: \d{4}-\d\d-\d\d \d\d:\d\d:\d\d$", "Since: then", result.output)
    assert text.splitlines() == [
        "-" * 80,
        f"Node [{client.node}]",
        "Publications: ",
        " * /rosout [rosgraph_msgs/Log]",
        "",
        "Subscriptions: ",
        " * /rosout_agg [rosgraph_msgs/Log]",
        " * /untyped [unknown type]",
        "",
        "Services: ",
        " * /serve",
        "",
        f"Address: {connected(client, hub.url)}",
        "Since: then",
        "Connections:",
        " * topic: /rosout",
        f"    * to: /rosout ({own})",
        "    * direction: outbound",
        "    * transport: WebSocket",
        " * topic: /rosout_agg",
        f"    * to: /rosout ({own})",
        "    * direction: inbound",
        "    * transport: WebSocket (cbor)",
        "",
    ]


def test_quiet_info_with_actions(run: Run, client: HubClient) -> None:
    type_ = "example_interfaces/Fibonacci"
    client.send({"op": "advertise_action", "action": "/count", "type": type_})
    client.call("/rosapi/get_time")
    assert run("node", "info", "-q", client.node).output.splitlines() == [
        "-" * 80,
        f"Node [{client.node}]",
        "Publications: None",
        "",
        "Subscriptions: None",
        "",
        "Services: ",
        " * /count/_action/cancel_goal",
        "",
        "Actions: ",
        " * /count [example_interfaces/Fibonacci]",
        "",
    ]


def test_info_takes_several_nodes_and_prints_json(run: Run) -> None:
    result = run("node", "info", "--json", "rosapi", "/rosout")
    rosapi, rosout = map(json.loads, result.output.splitlines())
    assert rosapi["services"]["/rosapi/nodes"] == "rosapi/Nodes"
    assert rosout["publications"] == {"/rosout_agg": "rosgraph_msgs/Log"}
    assert rosout["subscriptions"] == {"/rosout": "rosgraph_msgs/Log"}
    assert rosout["actions"] == {}


def test_unknown_node_is_an_error(run: Run) -> None:
    result = run("node", "info", "rosapi", "rosoud")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr == "Error: Unknown node /rosoud; did you mean /rosout?\n"


# ping


def test_ping_prints_times_and_their_average(
    run: Run, talker: Peer, hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node, "PING_INTERVAL", 0.0)
    result = run("node", "ping", "-c", "3", "talker")
    first, *replies, average = result.output.splitlines()
    assert first == "pinging /talker with a timeout of 3.0s"
    assert len(replies) == 3
    for reply in replies:
        assert re.fullmatch(r"reply from /talker at 127.0.0.1:\d+: time=\d+\.\d\dms", reply)
    assert re.fullmatch(r"ping average: \d+\.\d\dms", average)


def test_ctrl_c_ends_ping_with_the_average(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    waits = iter([None, None])

    def process(client: HubClient, seconds: float) -> None:
        if next(waits, "end") == "end":
            raise KeyboardInterrupt

    monkeypatch.setattr(HubClient, "process", process)
    monkeypatch.setattr(node, "end_line", lambda: print("the line of ^C"))
    result = run("node", "ping", "rosapi")
    assert result.exit_code == 0
    _, *replies, interrupted, average = result.output.splitlines()
    assert len(replies) == 3
    assert interrupted == "the line of ^C"
    assert average.startswith("ping average: ")


def test_ping_waits_between_pings(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    waited: list[float] = []

    def process(client: HubClient, seconds: float) -> None:
        waited.append(seconds)

    monkeypatch.setattr(HubClient, "process", process)
    assert run("node", "ping", "-c", "3", "rosapi").exit_code == 0
    assert waited == [node.PING_INTERVAL] * 2


def test_ping_without_an_answer_is_an_error(
    run: Run, client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.rosapi.rosnode.PATIENCE", 0.05)
    result = run("node", "ping", client.node)  # A client answers nothing while nobody reads it.
    assert result.exit_code == 1
    assert result.stderr == f"Error: {client.node} did not answer within 0.05 s\n"


def test_ping_all_continues_after_a_failure(
    run: Run, client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.rosapi.rosnode.PATIENCE", 0.05)
    result = run("node", "ping", "--all")
    nodes = sorted([*OWN, client.node])
    lines = result.stdout.splitlines()
    assert lines[: len(nodes) + 2] == [
        "Will ping the following nodes: ",
        *(f" * {name}" for name in nodes),
        "",
    ]
    replies = [re.match(r"reply from (\S+)", line) for line in lines[len(nodes) + 2 :]]
    assert [reply[1] for reply in replies if reply] == OWN
    assert result.exit_code == 1
    assert result.stderr.splitlines() == [
        f"Error: {client.node} did not answer within 0.05 s",
        "Error: 1 of 4 nodes did not answer",
    ]


@pytest.mark.parametrize("words", [["--all", "rosapi"], ["--all", "-c", "2"], []])
def test_ping_takes_one_node_or_all(run: Run, words: list[str]) -> None:
    assert run("node", "ping", *words).exit_code == 2


# kill


def test_kill_stops_a_node(run: Run, talker: Peer) -> None:
    result = run("node", "kill", "talker")
    assert (result.exit_code, result.output) == (0, "killing /talker\nkilled\n")
    talker.join()
    assert isinstance(talker.fault, NodeKilled)


def test_kill_all_excludes_the_hub(run: Run, hub: HubThread, talker: Peer) -> None:
    with peer(hub.url, "another", nothing) as another:
        result = run("node", "kill", "-a")
        assert result.output == "killing:\n * /another\n * /talker\nkilled\n"
        talker.join()
        another.join()
    assert run("node", "list").output.splitlines() == OWN
    assert run("node", "kill", "-a").stderr == "No nodes running\n"


def test_kill_asks_for_a_node(run: Run, talker: Peer) -> None:
    result = run("node", "kill", input="2\n1\n")
    assert result.exit_code == 0
    assert result.output.startswith("1. /talker\n\nPlease enter the number of the node you wish")
    assert result.output.endswith("killing /talker\nkilled\n")
    talker.join()


def test_kill_needs_a_node_if_input_is_closed(run: Run, talker: Peer) -> None:
    result = run("node", "kill", input="")
    assert result.exit_code == 2
    assert "--all" in result.stderr


def test_kill_does_nothing_if_a_node_is_unknown(run: Run, talker: Peer) -> None:
    result = run("node", "kill", "talker", "tolker")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "/tolker" in result.stderr and "/talker?" in result.stderr
    assert talker.name in run("node", "list").output


def test_refused_kill_is_an_error(run: Run) -> None:
    result = run("node", "kill", "/rosapi")
    assert (result.exit_code, result.stdout) == (1, "killing /rosapi\n")
    assert result.stderr.startswith("Error: Failed to kill: /rosapi is the hub's own")


def test_kill_takes_nodes_or_all(run: Run) -> None:
    assert run("node", "kill", "-a", "talker").exit_code == 2
