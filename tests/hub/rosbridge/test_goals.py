"""Sending goals, hearing of them, and wanting them no more."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment

from ..fakes import FIBONACCI, FakeHub
from .action_clients import (
    received_goal,
    received_goals,
    received_result,
    send_feedback,
    send_goal,
    send_result,
    server,
    server_and_client,
)

ABORTED = 6


def test_goal_goes_to_the_server_and_feedback_and_result_to_the_client() -> None:
    hub, action_server, client = server_and_client()
    send_goal(client, 3, id="x", feedback=True)
    assert action_server.receive() == [
        {
            "op": "send_action_goal",
            "id": "action_goal:/fib:1",
            "action": "/fib",
            "action_type": FIBONACCI,
            "args": {"order": 3},
            "feedback": True,
        }
    ]
    assert client.receive() == []
    send_feedback(action_server, "action_goal:/fib:1", 0, 1)
    assert client.receive() == [
        {"op": "action_feedback", "id": "x", "action": "/fib", "values": {"sequence": [0, 1]}}
    ]
    send_result(action_server, "action_goal:/fib:1", 0, 1, 1, 2)
    assert client.receive() == [
        {
            "op": "action_result",
            "id": "x",
            "action": "/fib",
            "status": 4,
            "result": True,
            "values": {"sequence": [0, 1, 1, 2]},
        }
    ]
    assert action_server.receive() == []
    assert client.forgotten
    assert hub.graph.actions["/fib"].goals == {}


@pytest.mark.parametrize(("wanted", "received"), [(True, 2), (False, 0), (None, 0)])
def test_feedback_is_sent_only_if_requested(wanted: bool | None, received: int) -> None:
    _, action_server, client = server_and_client()
    send_goal(client, feedback=wanted)
    sent = action_server.receive_one("send_action_goal")
    assert sent["feedback"] is True
    for number in range(2):
        send_feedback(action_server, sent["id"], number)
    assert len(client.receive()) == received
    assert action_server.receive() == []


@pytest.mark.parametrize(
    ("args", "order"),
    [(None, 0), ({}, 0), ([], 0), ([5], 5), ([5, "more"], 5), ("text", 0), (5, 0)],
)
def test_goal_is_an_object_or_a_list_with_defaults_for_the_rest(args: object, order: int) -> None:
    _, action_server, client = server_and_client()
    send_goal(client, args=args)
    assert action_server.receive_one("send_action_goal")["args"] == {"order": order}


@pytest.mark.parametrize(
    "type_",
    [FIBONACCI, "example_interfaces/action/Fibonacci", "actionlib_tutorials/action/Fibonacci"],
)
def test_type_may_be_spelled_as_in_ros_1_or_2_and_be_another_one_of_equal_fields(
    type_: str,
) -> None:
    _, action_server, client = server_and_client()
    send_goal(client, action_type=type_)
    assert action_server.receive_one("send_action_goal")["action_type"] == FIBONACCI


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"action": "/nope"}, "Action /nope does not exist"),
        ({"action": "~fib"}, "Action /client/fib does not exist"),
        ({"action": "not legal"}, "'not legal' is not a legal name"),
        ({"action": ""}, "'' is not a legal name: it is empty"),
        (
            {"action_type": "action_tutorials_interfaces/Fibonacci"},
            "Action /fib is of type example_interfaces/Fibonacci, not action_tutorials_interfaces",
        ),
        (
            {"action_type": "unknown_actions/Fibonacci"},
            "Action /fib is of type example_interfaces/Fibonacci, not unknown_actions/Fibonacci",
        ),
        ({"action_type": "Fibonacci"}, "Fibonacci is not a valid type string"),
        ({"args": {"order": "5"}}, "requires an int32 for field order, but got a str"),
        ({"args": {"orders": 5}}, "does not have a field orders"),
        ({"args": ["5"]}, "requires an int32 for field order, but got a str"),
        ({"args": {"order": 2**31}}, "2147483648 is not in -2147483648..2147483647"),
    ],
)
def test_goal_that_cannot_be_sent_is_aborted_at_once(fields: dict[str, Any], text: str) -> None:
    hub, action_server, client = server_and_client()
    send_goal(client, **{"id": "x", **fields})
    result = client.receive_one("action_result")
    assert (result["id"], result["action"]) == ("x", fields.get("action", "/fib"))
    assert (result["status"], result["result"]) == (ABORTED, False)
    assert text in result["values"]
    assert action_server.receive() == []
    assert client.forgotten
    assert hub.graph.actions["/fib"].goals == {}


@pytest.mark.parametrize("id_", ["send_action_goal:/fib:1", "", "5", 5, 0, -1, 1.5, 2**70, False])
@pytest.mark.parametrize("action", ["/fib", "/nope"])
def test_feedback_and_result_carry_the_id_as_it_was_sent(id_: object, action: str) -> None:
    _, action_server, client = server_and_client()
    send_goal(client, action=action, id=id_, feedback=True)
    for sent in received_goals(action_server):
        send_feedback(action_server, sent)
        send_result(action_server, sent)
    for received in client.receive():
        assert (received["id"], type(received["id"])) == (id_, type(id_))


def test_goal_without_an_id_has_a_result_without_one() -> None:
    _, action_server, client = server_and_client()
    for _ in range(2):
        send_goal(client, feedback=True)
    for sent in received_goals(action_server):
        send_feedback(action_server, sent)
        send_result(action_server, sent)
    received = client.receive()
    assert [each["op"] for each in received] == ["action_feedback", "action_result"] * 2
    assert all("id" not in each for each in received)


def test_id_is_free_again_when_its_goal_has_ended() -> None:
    _, action_server, client = server_and_client()
    send_goal(client, 3, id="x")
    send_goal(client, 4, id="x")
    assert client.receive() == [
        {
            "op": "status",
            "id": "x",
            "level": "error",
            "msg": "send_action_goal: A goal of id x has not ended yet",
        }
    ]
    send_goal(client, 5, id="y")
    ids = received_goals(action_server)
    assert len(ids) == 2
    for sent in ids:
        send_result(action_server, sent)
    assert [each["id"] for each in client.receive()] == ["x", "y"]
    send_goal(client, 6, id="x")
    assert len(received_goals(action_server)) == 1


def test_two_clients_may_use_one_id() -> None:
    hub, action_server, client = server_and_client()
    other = hub.client("/other")
    for number, each in enumerate((client, other)):
        send_goal(each, number, id="x")
    first, second = received_goals(action_server)
    send_result(action_server, second, 2)
    send_result(action_server, first, 1)
    assert received_result(client) == (4, True, {"sequence": [1]})
    assert received_result(other) == (4, True, {"sequence": [2]})


@pytest.mark.parametrize(("advertised", "sent"), [("fib", "/fib"), ("~fib", "/server/fib")])
def test_each_client_keeps_its_spelling_of_an_action(advertised: str, sent: str) -> None:
    hub = FakeHub()
    action_server, client = server(hub, action=advertised), hub.client()
    send_goal(client, action=sent, id="x", feedback=True)
    goal = action_server.receive_one("send_action_goal")
    assert (goal["action"], goal["id"]) == (advertised, f"action_goal:{advertised}:1")
    send_feedback(action_server, goal["id"], action=advertised)
    assert client.receive_one("action_feedback")["action"] == sent
    client.send("cancel_action_goal", action=sent, id="x")
    assert action_server.receive_one("cancel_action_goal")["action"] == advertised
    send_result(action_server, goal["id"])
    assert client.receive_one("action_result")["action"] == sent


def test_client_may_serve_its_own_goals() -> None:
    client = server(FakeHub())
    send_goal(client, id="x", feedback=True)
    sent = received_goal(client)
    client.send("cancel_action_goal", action="/fib", id="x")
    assert client.receive() == [{"op": "cancel_action_goal", "action": "/fib", "id": sent}]
    send_result(client, sent, status=5)
    assert received_result(client) == (5, True, {"sequence": []})
    client.disconnect()
    assert client.forgotten


def test_number_of_goals_of_a_client_is_limited() -> None:
    _, action_server, client = server_and_client(max_goals=2)
    for number in range(3):
        send_goal(client, number)
    status, ok, text = received_result(client)
    assert (status, ok) == (ABORTED, False)
    assert "limit 2" in text
    assert "--max-goals" in text
    send_result(action_server, received_goals(action_server)[0])
    received_result(client)
    send_goal(client)
    assert client.receive() == []


def test_long_feedback_and_results_are_fragmented_on_request() -> None:
    _, action_server, client = server_and_client()
    send_goal(client, id="x", feedback=True, fragment_size=50)
    sent = received_goal(action_server)
    send_feedback(action_server, sent, *range(50))
    send_result(action_server, sent, *range(50))
    reassembly = Reassembly(max_size=10**6)
    fragments = client.receive()
    assert all(type(each["id"]) is str and len(each["data"]) <= 50 for each in fragments)
    texts = [reassembly.add(Fragment(**each), 0) for each in fragments]
    whole = [json.loads(text) for text in texts if text is not None]
    assert [each["op"] for each in whole] == ["action_feedback", "action_result"]
    assert [each["values"]["sequence"] for each in whole] == [[*range(50)]] * 2


def test_goals_of_an_unknown_type_are_relayed_unchecked() -> None:
    hub = FakeHub()
    action_server, client = hub.client(), hub.client()
    action_server.send("advertise_action", action="/do", type="my_actions/action/Do")
    send_goal(
        client,
        action="/do",
        action_type="my_actions/Do",
        args={"any": ["thing"]},
        feedback=True,
    )
    goal = action_server.receive_one("send_action_goal")
    assert goal["args"] == {"any": ["thing"]}
    action_server.send("action_feedback", action="/do", id=goal["id"], values={"half": None})
    assert client.receive_one("action_feedback")["values"] == {"half": None}
    action_server.send("action_result", action="/do", id=goal["id"], values={"all": 1}, result=True)
    assert received_result(client) == (4, True, {"all": 1})


# Cancelling.


def test_cancelled_goal_still_gets_its_result() -> None:
    _, action_server, client = server_and_client()
    for id_ in ("x", "y"):
        send_goal(client, id=id_, feedback=True)
    first, _ = received_goals(action_server)
    client.send("cancel_action_goal", action="/fib", id="x")
    assert action_server.receive() == [{"op": "cancel_action_goal", "id": first, "action": "/fib"}]
    assert client.receive() == []
    send_feedback(action_server, first, 1)
    send_result(action_server, first, 1, status=5)
    assert [each["op"] for each in client.receive()] == ["action_feedback", "action_result"]


def test_goal_that_has_just_ended_can_be_cancelled_without_an_error() -> None:
    """The client may not have its result yet."""
    _, action_server, client = server_and_client()
    send_goal(client, id="x")
    send_result(action_server, received_goal(action_server))
    send_goal(client, id="refused", action="/none")
    client.receive()
    for id_ in ("x", "refused"):
        client.send("cancel_action_goal", action="/fib", id=id_)
    assert client.receive() == action_server.receive() == []


@pytest.mark.parametrize("id_", ["unknown", 5, None, "action_goal:/fib:1", "others'"])
def test_client_can_cancel_only_its_own_goals(id_: object) -> None:
    hub, action_server, client = server_and_client()
    other = hub.client("/other")
    send_goal(other, id="others'")
    send_goal(client, id="x")
    received_goals(action_server)
    client.send("cancel_action_goal", action="/fib", id=id_)
    assert client.receive_statuses() == ["cancel_action_goal: no goal of /fib has this id"]
    assert action_server.receive() == other.receive() == []


@pytest.mark.parametrize("times", [2, 3])
def test_goal_may_be_cancelled_more_than_once(times: int) -> None:
    _, action_server, client = server_and_client()
    send_goal(client, id="x")
    sent = received_goal(action_server)
    for _ in range(times):
        client.send("cancel_action_goal", action="/fib", id="x")
    assert action_server.receive_one("cancel_action_goal")["id"] == sent
    send_result(action_server, sent, status=5)
    assert received_result(client) == (5, True, {"sequence": []})


def test_malformed_goal_gets_a_result() -> None:
    """The client waits for a result with its id, whatever the error."""
    client = FakeHub().client()
    client.send("send_action_goal", action="/fib", action_type=5, id="x")
    status, result = client.receive()
    assert status["op"] == "status"
    assert (result["op"], result["id"], result["status"]) == ("action_result", "x", 6)
    assert "action_type" in result["values"]
    assert client.forgotten
