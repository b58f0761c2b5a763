"""``fibws action``."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from hub_in_thread import HubThread, Run
from node_in_thread import ACTION_TOPICS, Peer, peer
from running_programs import Start

import fibws
from fibws.action import actionlib_tutorials, example_interfaces
from fibws.cli import action
from fibws.client.hub_client import HubClient
from fibws.msg.actionlib_tutorials import FibonacciResult as Ros1Result
from fibws.msg.example_interfaces import FibonacciResult as Ros2Result

from .terminal import Terminal

ROS1, ROS2 = "actionlib_tutorials/Fibonacci", "example_interfaces/Fibonacci"


async def serve(node: fibws.Node) -> None:
    """Serve /ros1/count over topics, /ros2/count over operations, and /both over both.

    A goal of order 0 is executed until it is canceled, one of a negative order is aborted.
    """

    async def count(goal: Any, result: Any) -> Any:
        sequence = [0, 1]
        if goal.request.order < 0:
            return goal.aborted(text="a negative order")
        if goal.request.order == 0:
            await goal.publish_feedback({"sequence": sequence})
            await goal.cancellation()
            return goal.canceled()
        while len(sequence) < goal.request.order:
            sequence.append(sequence[-1] + sequence[-2])
            await goal.publish_feedback({"sequence": sequence})
        return result(sequence)

    async def ros1(goal: Any) -> Ros1Result:
        reached: Ros1Result = await count(goal, Ros1Result)
        return reached

    async def ros2(goal: Any) -> Ros2Result:
        reached: Ros2Result = await count(goal, Ros2Result)
        return reached

    for name in ("/ros1/count", "/both"):
        await node.action_server(name, actionlib_tutorials.Fibonacci, ros1)
    for name in ("/ros2/count", "/both"):
        await node.action_server(name, example_interfaces.Fibonacci, ros2, over="operations")


@pytest.fixture
def server(hub: HubThread) -> Iterator[Peer]:
    with peer(hub.url, "counter", serve) as server:
        yield server


needs_server = pytest.mark.usefixtures("server")
both_ways = pytest.mark.parametrize("name", ["/ros1/count", "/ros2/count"])


# list, info, type, show


@needs_server
def test_list_names_each_action_once(run: Run) -> None:
    assert run("action", "list").output == "/both\n/ros1/count\n/ros2/count\n"
    assert run("action", "list", "/ros1").output == "/ros1/count\n"
    assert run("action", "list", "-t").output.splitlines() == [
        f"/both [{ROS2}]",
        f"/both [{ROS1}]",
        f"/ros1/count [{ROS1}]",
        f"/ros2/count [{ROS2}]",
    ]
    assert json.loads(run("action", "list", "--json", "/ros2").output) == {
        "name": "/ros2/count",
        "type": ROS2,
        "node": "/counter",
        "over_topics": False,
    }


@needs_server
def test_info_prints_the_type_and_the_nodes(run: Run, client: HubClient) -> None:
    client.send({"op": "advertise", "topic": "/ros1/count/goal", "type": ACTION_TOPICS["goal"]})
    client.call("/rosapi/get_time")
    address = {each["name"]: each["address"] for each in client.call("/rosapi/graph")["nodes"]}
    # The tool's own client is another one.
    clients = json.loads(run("action", "info", "--json", "/ros1/count").output)["clients"]
    assert clients == [client.node]
    lines = run("action", "info", "/ros1/count").output.splitlines()
    assert lines[:4] == [f"Type: {ROS1}", "Over: topics", "", "Clients: "]
    assert lines[4].startswith(f" * {client.node} (127.0.0.1:")
    assert lines[5:] == ["", "Servers: ", f" * /counter ({address['/counter']})", ""]
    assert run("action", "info", "/ros2/count").output.splitlines() == [
        f"Type: {ROS2}",
        "Over: operations",
        "",
        "Servers: ",
        f" * /counter ({address['/counter']})",
        "",
    ]


@needs_server
def test_type_prints_all_types(run: Run) -> None:
    assert run("action", "type", "/ros1/count").output == f"{ROS1}\n"
    assert run("action", "type", "/both").output == f"{ROS2}\n{ROS1}\n"
    result = run("action", "type", "/ros/count")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "Unknown action /ros/count; did you mean /ros" in result.stderr


def test_show_prints_the_three_parts(run: Run) -> None:
    assert run("action", "show", ROS1).output.splitlines() == [
        "int32 order",
        "---",
        "int32[] sequence",
        "---",
        "int32[] sequence",
        "",
    ]


# send


@needs_server
@both_ways
@pytest.mark.parametrize("words", [["4"], ["{order: 4}"]])
def test_send_prints_the_result(run: Run, name: str, words: list[str]) -> None:
    result = run("action", "send", name, *words)
    assert (result.exit_code, result.stdout) == (0, "sequence: [0, 1, 1, 2]\n")
    assert result.stderr.splitlines()[-2:] == ["ACTIVE", "SUCCEEDED"]


@needs_server
@both_ways
def test_send_prints_feedback_if_asked(run: Run, name: str) -> None:
    assert run("action", "send", "-f", name, "4").stdout.splitlines() == [
        "sequence: [0, 1, 1]",
        "---",
        "sequence: [0, 1, 1, 2]",
        "---",
        "sequence: [0, 1, 1, 2]",
    ]


@needs_server
@both_ways
def test_send_prints_json(run: Run, name: str) -> None:
    lines = run("action", "send", "-f", "--json", name, "3").stdout.splitlines()
    assert [json.loads(line) for line in lines] == [
        {"feedback": {"sequence": [0, 1, 1]}},
        {"status": "SUCCEEDED", "text": "", "result": {"sequence": [0, 1, 1]}},
    ]


@needs_server
@both_ways
def test_aborted_goal_is_an_error(run: Run, name: str) -> None:
    result = run("action", "send", name, "-1")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-2:] == [
        "ABORTED",
        f"Error: {name}: ABORTED: a negative order",
    ]


@needs_server
@both_ways
async def test_ctrl_c_cancels_the_goal(hub: HubThread, start: Start, name: str) -> None:
    tool = await start("fibws", "action", "send", "-f", "--hub", hub.url, name, "0")
    assert await tool.line() == "sequence: [0, 1]\n"
    tool.send(signal.SIGINT)
    code, _, err = await tool.end()
    assert code == 130
    lines = err.splitlines()
    assert lines.index("canceling the goal") < lines.index("PREEMPTED")


@needs_server
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pty")
def test_output_after_ctrl_c_begins_a_line_on_a_terminal(hub: HubThread) -> None:
    words = ("fibws", "action", "send", "-f", "--hub", hub.url, "/ros1/count", "0")
    tool = Terminal(sys.executable, "-m", *words)
    try:
        tool.wait_for("---")
        tool.process.send_signal(signal.SIGINT)
        tool.wait_for("\n\r\ncanceling the goal")
        assert tool.ended() == 130
    finally:
        tool.close()


@needs_server
def test_type_chooses_between_topics_and_operations(run: Run, client: HubClient) -> None:
    client.send({"op": "subscribe", "topic": "/both/goal", "type": ACTION_TOPICS["goal"]})
    client.call("/rosapi/get_time")
    assert run("action", "send", "/both", ROS2.replace("/", "/action/"), "3").exit_code == 0
    assert client.receive(0) is None
    assert run("action", "send", "/both", ROS1, "3").exit_code == 0
    assert next(client.messages("/both/goal"))["goal"] == {"order": 3}
    assert run("action", "send", "/both", "4").exit_code == 0
    assert next(client.messages("/both/goal"))["goal"] == {"order": 4}


@needs_server
@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        ([ROS2, "3"], 2, "expected order"),
        ([], 2, "expected order"),
        (["{ordr: 3}"], 2, "did you mean order?"),
        (["x"], 1, "requires an int32 for field goal.order"),
    ],
)
def test_wrong_goal_is_an_error(run: Run, words: list[str], code: int, text: str) -> None:
    result = run("action", "send", "/ros1/count", *words)
    assert (result.exit_code, result.stdout) == (code, "")
    assert text in result.stderr


def test_text_like_a_type_is_a_value(run: Run, client: HubClient) -> None:
    type_ = "custom_msgs/Say"
    client.send(
        {
            "op": "advertise_action",
            "action": "/say",
            "type": type_,
            "definition": "string words\n---\n---\n",
        }
    )
    client.call("/rosapi/get_time")
    with ThreadPoolExecutor() as threads:
        for words in (["a/b"], [type_, "a/b"], ["a/action/b"]):
            sent = threads.submit(run, "action", "send", "/say", *words)
            goal = next(found for found in iter(client.receive, None) if "action" in found)
            assert goal["args"] == {"words": words[-1]}
            reply = {"op": "action_result", "action": "/say", "id": goal["id"], "status": 4}
            client.send({**reply, "result": True, "values": {}})
            assert sent.result(20).exit_code == 0


@needs_server
def test_goal_that_the_hub_refuses_is_an_error(run: Run) -> None:
    result = run("action", "send", "/ros2/count", "x")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "requires an int32 for field order" in result.stderr


def test_unknown_action_is_an_error(run: Run) -> None:
    result = run("action", "send", "/count", "3")
    assert result.exit_code == 1 and "/count" in result.stderr


def test_send_can_wait_for_the_server(run: Run, hub: HubThread, client: HubClient) -> None:
    with ThreadPoolExecutor() as threads:
        result = threads.submit(run, "action", "send", "--wait", "/ros2/count", "3")
        while not any("fibws_action" in name for name in client.call("/rosapi/nodes")["nodes"]):
            assert not result.done()
        with peer(hub.url, "counter", serve):
            assert result.result(20).stdout == "sequence: [0, 1, 1]\n"


def test_goal_of_an_undefined_type_is_an_object(run: Run, client: HubClient) -> None:
    client.send({"op": "advertise_action", "action": "/odd", "type": "odd_msgs/Odd"})
    client.call("/rosapi/get_time")
    with ThreadPoolExecutor() as threads:
        sent = threads.submit(run, "action", "send", "-f", "/odd", "{x: 1}")
        goal = next(found for found in iter(client.receive, None) if "action" in found)
        assert goal["args"] == {"x": 1}
        reply = {"action": "/odd", "id": goal["id"]}
        client.send({"op": "action_feedback", **reply, "values": {"y": 2}})
        client.send({"op": "action_result", **reply, "status": 4, "result": True, "values": {}})
        assert sent.result(20).stdout == "y: 2\n---\n\n"


def test_action_without_type_and_nodes(run: Run, client: HubClient) -> None:
    for topic in ACTION_TOPICS:
        client.send({"op": "subscribe", "topic": f"/bare/{topic}"})
    client.call("/rosapi/get_time")
    assert run("action", "list", "-t").output == "/bare [unknown type]\n"
    assert run("action", "info", "/bare").output == (
        "Type: unknown type\nOver: topics\n\nClients: None\n\nServers: None\n\n"
    )
    result = run("action", "send", "/bare", "3")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "/bare" in result.stderr and "TYPE" in result.stderr


def test_send_ends_if_the_server_ignores_the_cancel(
    run: Run, hub: HubThread, client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(action, "CANCEL_PATIENCE", 0.05)
    client.send({"op": "advertise_action", "action": "/deaf", "type": ROS2})
    client.call("/rosapi/get_time")
    followed: list[float | None] = []
    follow = action._follow

    def interrupted(goal: Any, printer: Any, timeout: float | None = None) -> Any:
        followed.append(timeout)
        if timeout is None:
            raise KeyboardInterrupt
        return follow(goal, printer, timeout)

    monkeypatch.setattr(action, "_follow", interrupted)
    result = run("action", "send", "/deaf", "3")
    assert result.exit_code == 130
    assert followed == [None, 0.05]
    operations = [client.receive(5) for _ in range(2)]
    assert [operation and operation["op"] for operation in operations] == [
        "send_action_goal",
        "cancel_action_goal",
    ]
