"""What servers tell of goals, and how goals end."""

from __future__ import annotations

from typing import Any

import pytest

from .pursuing import (
    finishes,
    hears_end,
    is_sent,
    is_sent_one,
    sends_goal,
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
def test_a_goal_ends_as_its_server_says(
    fields: dict[str, Any], end: tuple[int, bool, object]
) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client)
    pursuer.says("action_result", action="/fib", id=is_sent_one(pursuer), **fields)
    assert hears_end(client) == end
    assert pursuer.hears() == []
    assert client.forgotten


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ("text", "Expected a JSON object for type example_interfaces/Fibonacci"),
        ([1], "Expected a JSON object for type example_interfaces/Fibonacci"),
        ({"sequence": 1}, "for field sequence, but got a int"),
        ({"sequence": [1, "2"]}, "field sequence[1], but got a str"),
        ({"sequences": [1]}, "does not have a field sequences"),
    ],
)
def test_feedback_that_does_not_fit_is_refused_and_a_result_ends_the_goal(
    values: object, fault: str
) -> None:
    hub, pursuer, client = server_and_client()
    sends_goal(client, feedback=True)
    sent = is_sent_one(pursuer)
    pursuer.says("action_feedback", action="/fib", id=sent, values=values)
    [told] = pursuer.hears_statuses()
    assert told.startswith("action_feedback: ")
    assert fault in told
    assert client.hears() == []
    pursuer.says("action_result", action="/fib", id=sent, values=values, result=True)
    [told] = pursuer.hears_statuses()
    status, ok, text = hears_end(client)
    assert (status, ok) == (6, False)
    assert fault in text
    assert told == f"action_result: {text}"
    assert client.forgotten
    assert not (pursuer.kept["goals to pursue"] or hub.graph.actions["/fib"].goals)


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({}, "Expected a result field but none was found."),
        ({"result": "yes"}, 'Expected field result to be one of bool. Invalid value: "yes"'),
        ({"result": True, "status": 7}, "Expected field status to be one of an int from 0 to 6."),
        ({"result": True, "status": -1}, "Expected field status to be one of an int from 0 to 6."),
        ({"result": True, "status": "4"}, "Expected field status to be one of int. Invalid value"),
        ({"result": True, "action": None}, "Expected a action field but none was found."),
    ],
)
def test_a_result_that_is_none_aborts_the_goal(fields: dict[str, Any], fault: str) -> None:
    _, pursuer, client = server_and_client()
    for id_ in "ab":
        sends_goal(client, id=id_)
    sent, other = is_sent(pursuer)
    pursuer.says("action_result", **{"action": "/fib", "id": sent, **fields})
    [told] = pursuer.hears_statuses()
    assert told.startswith(f"action_result: {fault}")
    status, ok, text = hears_end(client)
    assert (status, ok) == (6, False)
    assert text.startswith(fault)
    finishes(pursuer, sent)
    assert client.hears() == []
    finishes(pursuer, other)
    assert client.hears_one("action_result")["id"] == "b"


@pytest.mark.parametrize(
    "fields",
    [{"id": "x"}, {"id": None}, {"id": []}, {"id": 5}, {"id": "x", "status": 7}],
    ids=str,
)
def test_what_is_no_result_of_any_goal_leaves_all_as_they_were(fields: dict[str, Any]) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client)
    sent = is_sent_one(pursuer)
    pursuer.says("action_result", action="/fib", **fields)
    assert len(pursuer.hears_statuses()) == 1
    assert client.hears() == []
    finishes(pursuer, sent)
    assert hears_end(client) == (4, True, {"sequence": []})


@pytest.mark.parametrize("op", ["action_feedback", "action_result"])
@pytest.mark.parametrize("id_", ["action_goal:/fib:99", "x", 1, "", None, "ended", "another's"])
def test_what_is_said_of_no_goal_changes_nothing(op: str, id_: object) -> None:
    hub, pursuer, client = server_and_client()
    other = server(hub, "/other", "/other")
    sends_goal(client, id="x", feedback=True)
    sends_goal(client, id="y", feedback=True)
    sends_goal(client, id="z", feedback=True, action="/other")
    open_, ended = is_sent(pursuer)
    finishes(pursuer, ended)
    hears_end(client)
    known = {"ended": ended, "another's": is_sent(other)[0]}
    pursuer.says("set_level", level="info")
    told = known.get(id_, id_) if isinstance(id_, str) else id_
    pursuer.says(op, action="/fib", id=told, values={}, result=True)
    assert pursuer.hears_statuses("info") == [f"{op}: no goal of /fib has this id"]
    assert client.hears() == other.hears() == []
    finishes(pursuer, open_)
    assert client.hears_one("action_result")["id"] == "x"
