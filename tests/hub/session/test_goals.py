"""Sending goals, hearing of them, and wanting them no more."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment

from ..fakes import FIBONACCI, FakeHub
from .pursuing import (
    finishes,
    hears_end,
    is_sent,
    is_sent_one,
    sends_goal,
    server,
    server_and_client,
    tells,
)

ABORTED = 6


def test_a_goal_goes_to_the_server_and_feedback_and_result_to_the_client() -> None:
    hub, pursuer, client = server_and_client()
    sends_goal(client, 3, id="x", feedback=True)
    assert pursuer.hears() == [
        {
            "op": "send_action_goal",
            "id": "action_goal:/fib:1",
            "action": "/fib",
            "action_type": FIBONACCI,
            "args": {"order": 3},
            "feedback": True,
        }
    ]
    assert client.hears() == []
    tells(pursuer, "action_goal:/fib:1", 0, 1)
    assert client.hears() == [
        {"op": "action_feedback", "id": "x", "action": "/fib", "values": {"sequence": [0, 1]}}
    ]
    finishes(pursuer, "action_goal:/fib:1", 0, 1, 1, 2)
    assert client.hears() == [
        {
            "op": "action_result",
            "id": "x",
            "action": "/fib",
            "status": 4,
            "result": True,
            "values": {"sequence": [0, 1, 1, 2]},
        }
    ]
    assert pursuer.hears() == []
    assert client.forgotten
    assert hub.graph.actions["/fib"].goals == {}


@pytest.mark.parametrize(("wanted", "heard"), [(True, 2), (False, 0), (None, 0)])
def test_feedback_comes_only_if_it_is_wanted(wanted: bool | None, heard: int) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, feedback=wanted)
    sent = pursuer.hears_one("send_action_goal")
    assert sent["feedback"] is True
    for number in range(2):
        tells(pursuer, sent["id"], number)
    assert len(client.hears()) == heard
    assert pursuer.hears() == []


@pytest.mark.parametrize(
    ("args", "order"),
    [(None, 0), ({}, 0), ([], 0), ([5], 5), ([5, "more"], 5), ("text", 0), (5, 0)],
)
def test_a_goal_comes_by_name_or_in_order_and_the_rest_has_its_default(
    args: object, order: int
) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, args=args)
    assert pursuer.hears_one("send_action_goal")["args"] == {"order": order}


@pytest.mark.parametrize("type_", [FIBONACCI, "example_interfaces/action/Fibonacci"])
def test_the_type_may_be_spelled_as_in_ros_1_or_2(type_: str) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, action_type=type_)
    assert pursuer.hears_one("send_action_goal")["action_type"] == FIBONACCI


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"action": "/nope"}, "Action /nope does not exist"),
        ({"action": "~fib"}, "Action /client/fib does not exist"),
        ({"action": "not legal"}, "'not legal' is not a legal name"),
        ({"action": ""}, "'' is not a legal name: it is empty"),
        (
            {"action_type": "actionlib_tutorials/Fibonacci"},
            "Action /fib is of type example_interfaces/Fibonacci, not actionlib_tutorials/Fib",
        ),
        ({"action_type": "Fibonacci"}, "Fibonacci is not a valid type string"),
        ({"args": {"order": "5"}}, "requires a int32 for field order, but got a str"),
        ({"args": {"orders": 5}}, "does not have a field orders"),
        ({"args": ["5"]}, "requires a int32 for field order, but got a str"),
        ({"args": {"order": 2**31}}, "2147483648 is not in -2147483648..2147483647"),
    ],
)
def test_a_goal_that_cannot_be_pursued_is_aborted_at_once(
    fields: dict[str, Any], text: str
) -> None:
    hub, pursuer, client = server_and_client()
    sends_goal(client, **{"id": "x", **fields})
    result = client.hears_one("action_result")
    assert (result["id"], result["action"]) == ("x", fields.get("action", "/fib"))
    assert (result["status"], result["result"]) == (ABORTED, False)
    assert text in result["values"]
    assert pursuer.hears() == []
    assert client.forgotten
    assert hub.graph.actions["/fib"].goals == {}


@pytest.mark.parametrize("id_", ["send_action_goal:/fib:1", "", "5", 5, 0, -1, 1.5, 2**70, False])
@pytest.mark.parametrize("action", ["/fib", "/nope"])
def test_feedback_and_result_carry_the_id_as_it_was_sent(id_: object, action: str) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, action=action, id=id_, feedback=True)
    for sent in is_sent(pursuer):
        tells(pursuer, sent)
        finishes(pursuer, sent)
    for heard in client.hears():
        assert (heard["id"], type(heard["id"])) == (id_, type(id_))


def test_a_goal_without_an_id_has_a_result_without_one() -> None:
    _, pursuer, client = server_and_client()
    for _ in range(2):
        sends_goal(client, feedback=True)
    for sent in is_sent(pursuer):
        tells(pursuer, sent)
        finishes(pursuer, sent)
    heard = client.hears()
    assert [each["op"] for each in heard] == ["action_feedback", "action_result"] * 2
    assert all("id" not in each for each in heard)


def test_an_id_is_free_again_when_its_goal_has_ended() -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, 3, id="x")
    sends_goal(client, 4, id="x")
    assert client.hears() == [
        {
            "op": "status",
            "id": "x",
            "level": "error",
            "msg": "send_action_goal: A goal of id x has not ended yet",
        }
    ]
    sends_goal(client, 5, id="y")
    ids = is_sent(pursuer)
    assert len(ids) == 2
    for sent in ids:
        finishes(pursuer, sent)
    assert [each["id"] for each in client.hears()] == ["x", "y"]
    sends_goal(client, 6, id="x")
    assert len(is_sent(pursuer)) == 1


def test_two_clients_may_use_one_id() -> None:
    hub, pursuer, client = server_and_client()
    other = hub.client("/other")
    for number, each in enumerate((client, other)):
        sends_goal(each, number, id="x")
    first, second = is_sent(pursuer)
    finishes(pursuer, second, 2)
    finishes(pursuer, first, 1)
    assert hears_end(client) == (4, True, {"sequence": [1]})
    assert hears_end(other) == (4, True, {"sequence": [2]})


@pytest.mark.parametrize(("advertised", "sent"), [("fib", "/fib"), ("~fib", "/server/fib")])
def test_each_knows_an_action_under_its_own_spelling(advertised: str, sent: str) -> None:
    hub = FakeHub()
    pursuer, client = server(hub, action=advertised), hub.client()
    sends_goal(client, action=sent, id="x", feedback=True)
    goal = pursuer.hears_one("send_action_goal")
    assert (goal["action"], goal["id"]) == (advertised, f"action_goal:{advertised}:1")
    tells(pursuer, goal["id"], action=advertised)
    assert client.hears_one("action_feedback")["action"] == sent
    client.says("cancel_action_goal", action=sent, id="x")
    assert pursuer.hears_one("cancel_action_goal")["action"] == advertised
    finishes(pursuer, goal["id"])
    assert client.hears_one("action_result")["action"] == sent


def test_a_client_may_serve_its_own_goals() -> None:
    client = server(FakeHub())
    sends_goal(client, id="x", feedback=True)
    sent = is_sent_one(client)
    client.says("cancel_action_goal", action="/fib", id="x")
    assert client.hears() == [{"op": "cancel_action_goal", "action": "/fib", "id": sent}]
    finishes(client, sent, status=5)
    assert hears_end(client) == (5, True, {"sequence": []})
    client.leaves()
    assert client.forgotten


def test_a_client_may_wait_for_so_many_goals_and_no_more() -> None:
    _, pursuer, client = server_and_client(max_goals=2)
    for number in range(3):
        sends_goal(client, number)
    assert hears_end(client) == (
        ABORTED,
        False,
        "One client may have 2 goals, not more (--max-goals of the hub)",
    )
    finishes(pursuer, is_sent(pursuer)[0])
    hears_end(client)
    sends_goal(client)
    assert client.hears() == []


def test_long_feedback_and_results_come_in_pieces_if_the_client_wants_it() -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, id="x", feedback=True, fragment_size=50)
    sent = is_sent_one(pursuer)
    tells(pursuer, sent, *range(50))
    finishes(pursuer, sent, *range(50))
    reassembly = Reassembly(max_size=10**6)
    fragments = client.hears()
    assert all(type(each["id"]) is str and len(each["data"]) <= 50 for each in fragments)
    texts = [reassembly.add(Fragment(**each), 0) for each in fragments]
    whole = [json.loads(text) for text in texts if text is not None]
    assert [each["op"] for each in whole] == ["action_feedback", "action_result"]
    assert [each["values"]["sequence"] for each in whole] == [[*range(50)]] * 2


def test_goals_of_an_unknown_type_are_relayed_as_they_are() -> None:
    hub = FakeHub()
    pursuer, client = hub.client(), hub.client()
    pursuer.says("advertise_action", action="/do", type="my_actions/action/Do")
    sends_goal(
        client,
        action="/do",
        action_type="my_actions/Do",
        args={"any": ["thing"]},
        feedback=True,
    )
    goal = pursuer.hears_one("send_action_goal")
    assert goal["args"] == {"any": ["thing"]}
    pursuer.says("action_feedback", action="/do", id=goal["id"], values={"half": None})
    assert client.hears_one("action_feedback")["values"] == {"half": None}
    pursuer.says("action_result", action="/do", id=goal["id"], values={"all": 1}, result=True)
    assert hears_end(client) == (4, True, {"all": 1})


# Cancelling.


def test_a_goal_that_is_cancelled_still_has_its_result() -> None:
    _, pursuer, client = server_and_client()
    for id_ in ("x", "y"):
        sends_goal(client, id=id_, feedback=True)
    first, _ = is_sent(pursuer)
    client.says("cancel_action_goal", action="/fib", id="x")
    assert pursuer.hears() == [{"op": "cancel_action_goal", "id": first, "action": "/fib"}]
    assert client.hears() == []
    tells(pursuer, first, 1)
    finishes(pursuer, first, 1, status=5)
    assert [each["op"] for each in client.hears()] == ["action_feedback", "action_result"]


@pytest.mark.parametrize("id_", ["unknown", 5, None, "action_goal:/fib:1", "ended", "others'"])
def test_only_a_clients_own_goals_can_be_cancelled_by_their_ids(id_: object) -> None:
    hub, pursuer, client = server_and_client()
    other = hub.client("/other")
    sends_goal(other, id="others'")
    sends_goal(client, id="x")
    sends_goal(client, id="ended")
    finishes(pursuer, is_sent(pursuer)[2])
    hears_end(client)
    client.says("set_level", level="info")
    client.says("cancel_action_goal", action="/fib", id=id_)
    assert client.hears_statuses("info") == ["cancel_action_goal: no goal of /fib has this id"]
    assert pursuer.hears() == other.hears() == []


@pytest.mark.parametrize("times", [2, 3])
def test_a_goal_may_be_cancelled_more_than_once(times: int) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, id="x")
    sent = is_sent_one(pursuer)
    for _ in range(times):
        client.says("cancel_action_goal", action="/fib", id="x")
    assert pursuer.hears_one("cancel_action_goal")["id"] == sent
    finishes(pursuer, sent, status=5)
    assert hears_end(client) == (5, True, {"sequence": []})


def test_a_goal_that_is_none_has_a_result_all_the_same() -> None:
    """Its client waits by the id, whatever was wrong."""
    client = FakeHub().client()
    client.says("send_action_goal", action="/fib", action_type=5, id="x")
    status, result = client.hears()
    assert status["op"] == "status"
    assert (result["op"], result["id"], result["status"]) == ("action_result", "x", 6)
    assert "action_type" in result["values"]
    assert client.forgotten
