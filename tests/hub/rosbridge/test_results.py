"""Feedback and results of goals."""

from __future__ import annotations

from typing import Any

import pytest

from .action_clients import (
    received_goal,
    received_goals,
    received_result,
    send_goal,
    send_result,
    server,
    server_and_client,
)


@pytest.mark.parametrize(
    ("fields", "end"),
    [
        ({"result": True, "status": 4}, (4, True, {"sequence": []})),
        ({"result": True}, (4, True, {"sequence": []})),
        ({"result": True, "status": 0}, (4, True, {"sequence": []})),
        ({"result": True, "status": None}, (4, True, {"sequence": []})),
        ({"result": True, "status": 5}, (5, True, {"sequence": []})),
        ({"result": True, "status": 6}, (6, True, {"sequence": []})),
        ({"result": True, "values": {"sequence": [1]}}, (4, True, {"sequence": [1]})),
        ({"result": True, "values": None}, (4, True, {"sequence": []})),
        ({"result": False}, (6, False, "the goal failed")),
        ({"result": False, "status": 5}, (5, False, "the goal failed")),
        ({"result": False, "values": "out of paper"}, (6, False, "out of paper")),
        ({"result": False, "values": ""}, (6, False, "the goal failed")),
        ({"result": False, "values": 5, "status": 6}, (6, False, "the goal failed")),
    ],
)
def test_goal_ends_with_the_servers_status(
    fields: dict[str, Any], end: tuple[int, bool, object]
) -> None:
    _, action_server, client = server_and_client()
    send_goal(client)
    action_server.send("action_result", action="/fib", id=received_goal(action_server), **fields)
    assert received_result(client) == end
    assert action_server.receive() == []
    assert client.forgotten


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ("text", "Expected a JSON object for type example_interfaces/Fibonacci"),
        ([1], "Expected a JSON object for type example_interfaces/Fibonacci"),
        ({"sequence": 1}, "for field sequence, but got an int"),
        ({"sequence": [1, "2"]}, "field sequence[1], but got a str"),
        ({"sequences": [1]}, "does not have a field sequences"),
    ],
)
def test_invalid_feedback_is_refused_and_an_invalid_result_ends_the_goal(
    values: object, fault: str
) -> None:
    hub, action_server, client = server_and_client()
    send_goal(client, feedback=True)
    sent = received_goal(action_server)
    action_server.send("action_feedback", action="/fib", id=sent, values=values)
    [refusal] = action_server.receive_statuses()
    assert refusal.startswith("action_feedback: ")
    assert fault in refusal
    assert client.receive() == []
    action_server.send("action_result", action="/fib", id=sent, values=values, result=True)
    [refusal] = action_server.receive_statuses()
    status, ok, text = received_result(client)
    assert (status, ok) == (6, False)
    assert fault in text
    assert refusal == f"action_result: {text}"
    assert client.forgotten
    assert not (action_server.kept["goals to execute"] or hub.graph.actions["/fib"].goals)


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({}, "Expected a result field but none was found."),
        ({"result": "yes"}, 'Expected field result to be one of bool. Invalid value: "yes"'),
        ({"result": True, "status": 7}, "Expected field status to be one of a number <= 6."),
        ({"result": True, "status": -1}, "Expected field status to be one of a number >= 0."),
        ({"result": True, "status": "4"}, "Expected field status to be one of int. Invalid value"),
        ({"result": True, "action": None}, "Expected a action field but none was found."),
    ],
)
def test_malformed_result_aborts_the_goal(fields: dict[str, Any], fault: str) -> None:
    _, action_server, client = server_and_client()
    for id_ in "ab":
        send_goal(client, id=id_)
    sent, other = received_goals(action_server)
    action_server.send("action_result", **{"action": "/fib", "id": sent, **fields})
    [refusal] = action_server.receive_statuses()
    assert refusal.startswith(f"action_result: {fault}")
    status, ok, text = received_result(client)
    assert (status, ok) == (6, False)
    assert text.startswith(fault)
    send_result(action_server, sent)
    assert client.receive() == []
    send_result(action_server, other)
    assert client.receive_one("action_result")["id"] == "b"


@pytest.mark.parametrize(
    "fields",
    [{"id": "x"}, {"id": None}, {"id": []}, {"id": 5}, {"id": "x", "status": 7}],
    ids=str,
)
def test_malformed_result_of_an_unknown_goal_changes_nothing(fields: dict[str, Any]) -> None:
    _, action_server, client = server_and_client()
    send_goal(client)
    sent = received_goal(action_server)
    action_server.send("action_result", action="/fib", **fields)
    assert len(action_server.receive_statuses()) == 1
    assert client.receive() == []
    send_result(action_server, sent)
    assert received_result(client) == (4, True, {"sequence": []})


@pytest.mark.parametrize("op", ["action_feedback", "action_result"])
@pytest.mark.parametrize("id_", ["action_goal:/fib:99", "x", 1, "", None, "ended", "another's"])
def test_feedback_and_results_of_unknown_goals_change_nothing(op: str, id_: object) -> None:
    hub, action_server, client = server_and_client()
    other = server(hub, "/other", "/other")
    send_goal(client, id="x", feedback=True)
    send_goal(client, id="y", feedback=True)
    send_goal(client, id="z", feedback=True, action="/other")
    open_, ended = received_goals(action_server)
    send_result(action_server, ended)
    received_result(client)
    known = {"ended": ended, "another's": received_goals(other)[0]}
    action_server.send("set_level", level="info")
    goal_id = known.get(id_, id_) if isinstance(id_, str) else id_
    action_server.send(op, action="/fib", id=goal_id, values={}, result=True)
    assert action_server.receive_statuses("info") == [f"{op}: no goal of /fib has this id"]
    assert client.receive() == other.receive() == []
    send_result(action_server, open_)
    assert client.receive_one("action_result")["id"] == "x"
