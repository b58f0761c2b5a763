"""Serving actions."""

from __future__ import annotations

from typing import Any

import pytest

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

CANCEL_GOAL = "/fib/_action/cancel_goal"


def test_a_served_action_is_in_the_graph_with_its_type_and_its_node() -> None:
    hub = FakeHub()
    server(hub, "/server", "~fib")
    action = hub.graph.actions["/server/fib"]
    assert (action.name, action.type.name, action.node) == ("/server/fib", FIBONACCI, "/server")


def test_what_a_client_serves_is_acknowledged_at_level_info() -> None:
    client = FakeHub().client("/server")
    client.says("set_level", level="info")
    client.says("advertise_action", action="fib", type="example_interfaces/action/Fibonacci", id=5)
    assert client.hears() == [
        {"op": "status", "id": 5, "level": "info", "msg": f"/server serves /fib ({FIBONACCI})"}
    ]


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({"type": "Fibonacci"}, "Fibonacci is not a valid type string"),
        (
            {"type": "example_interfaces/Fibonaci"},
            "Unable to import action class Fibonaci from package example_interfaces. "
            "Caused by: no such action in example_interfaces; "
            "did you mean example_interfaces/Fibonacci?",
        ),
        ({"type": None}, "Expected a type field but none was found."),
        ({"action": None}, "Expected a action field but none was found."),
        ({"action": "a b"}, "'a b' is not a legal name"),
        ({"definition": "int33 x\n---\n---\n", "type": "my_actions/Do"}, "int33"),
    ],
)
def test_an_action_that_cannot_be_is_refused_and_leaves_nothing_behind(
    fields: dict[str, Any], fault: str
) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("advertise_action", **{"action": "/fib", "type": FIBONACCI, **fields})
    [status] = client.hears_statuses()
    assert status.startswith("advertise_action: ")
    assert fault in status
    assert not (hub.graph.actions or hub.graph.services)
    assert client.forgotten


def test_strict_types_refuse_an_unknown_package() -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.says("advertise_action", action="/do", type="my_actions/Do")
    assert client.hears_statuses() == [
        "advertise_action: Unable to load the manifest for package my_actions. "
        "Caused by: no folder of definitions holds it"
    ]
    assert hub.empty is False
    assert hub.graph.actions == {}


def test_who_serves_an_action_of_an_unknown_package_is_warned() -> None:
    client = FakeHub().client()
    client.says("set_level", level="warning")
    client.says("advertise_action", action="/do", type="my_actions/Do", id=1)
    [status] = client.hears()
    assert (status["id"], status["level"]) == (1, "warning")
    assert "my_actions/Do are not checked" in status["msg"]


def test_a_server_may_bring_the_definition() -> None:
    hub = FakeHub(strict_types=True)
    pursuer, client = hub.client(), hub.client()
    definition = "int8 goal\n---\nint8 result\n---\nint8 feedback\n"
    pursuer.says("advertise_action", action="/do", type="my_actions/Do", definition=definition)
    sends_goal(client, action="/do", action_type="my_actions/Do", args={"goal": 5}, feedback=True)
    sent = is_sent_one(pursuer)
    pursuer.says("action_feedback", action="/do", id=sent, values={"feedback": 500})
    assert "500 is not in -128..127" in pursuer.hears_statuses()[0]
    pursuer.says("action_feedback", action="/do", id=sent)
    assert client.hears_one("action_feedback")["values"] == {"feedback": 0}
    pursuer.says("action_result", action="/do", id=sent, result=True)
    assert hears_end(client) == (4, True, {"result": 0})


# Several servers of one name, and the end.


def test_a_newer_server_takes_the_action_over() -> None:
    hub, older, client = server_and_client()
    older.says("set_level", level="warning")
    sends_goal(client, id="old", feedback=True)
    before = is_sent_one(older)
    newer = server(hub, "/newer")
    assert older.hears_statuses("warning") == ["/fib has another server now"]
    assert hub.graph.actions["/fib"].node == "/newer"
    sends_goal(client, id="new")
    after = is_sent_one(newer)
    tells(older, before, 1)
    client.says("cancel_action_goal", action="/fib", id="old")
    assert older.hears_one("cancel_action_goal")["id"] == before
    finishes(older, before, status=5)
    finishes(newer, after)
    assert [(each["op"], each["id"]) for each in client.hears()] == [
        ("action_feedback", "old"),
        ("action_result", "old"),
        ("action_result", "new"),
    ]


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_the_older_server_takes_nothing_from_the_newer(end: str) -> None:
    hub, older, client = server_and_client()
    newer = server(hub, "/newer")
    if end == "leave":
        older.leaves()
    else:
        older.says("unadvertise_action", action="/fib")
    sends_goal(client)
    assert len(is_sent(newer)) == 1
    assert CANCEL_GOAL in hub.graph.services


def test_a_client_may_serve_its_action_again_under_another_spelling() -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client, id="before")
    before = is_sent_one(pursuer)
    pursuer.says("advertise_action", action="fib", type=FIBONACCI)
    sends_goal(client, id="after")
    sent = pursuer.hears_one("send_action_goal")
    assert sent["action"] == "fib"
    finishes(pursuer, before)
    finishes(pursuer, sent["id"])
    assert [each["id"] for each in client.hears()] == ["before", "after"]


@pytest.mark.parametrize("again", [False, True])
def test_goals_of_an_action_that_is_taken_back_are_aborted_at_once(again: bool) -> None:
    hub, pursuer, client = server_and_client()
    sends_goal(client, id="x")
    if again:
        pursuer.says("advertise_action", action="/fib", type=FIBONACCI)
    sent = is_sent_one(pursuer)
    pursuer.says("unadvertise_action", action="fib")
    assert hears_end(client) == (6, False, "Action /fib was unadvertised")
    assert not (hub.graph.actions or hub.graph.services)
    sends_goal(client)
    assert hears_end(client) == (6, False, "Action /fib does not exist")
    finishes(pursuer, sent)
    assert client.hears() == pursuer.hears() == []


@pytest.mark.parametrize("action", ["/nope", "nope"])
def test_what_was_never_served_may_be_taken_back(action: str) -> None:
    hub, pursuer, client = server_and_client()
    pursuer.says("unadvertise_action", action=action)
    client.says("unadvertise_action", action="/fib")
    assert pursuer.hears() == client.hears() == []
    assert list(hub.graph.actions) == ["/fib"]


@pytest.mark.parametrize("replaced", [False, True])
def test_goals_of_a_server_that_is_lost_are_aborted_at_once(replaced: bool) -> None:
    hub, pursuer, client = server_and_client()
    for id_ in "ab":
        sends_goal(client, id=id_)
    if replaced:
        hub.client("/server")
    else:
        pursuer.leaves()
    assert [(each["id"], each["status"], each["result"]) for each in client.hears()] == [
        (id_, 6, False) for id_ in "ab"
    ]
    assert client.forgotten
    assert not (hub.graph.actions or hub.graph.services)


def test_a_client_that_leaves_cancels_its_goals_and_needs_no_result() -> None:
    hub, pursuer, client = server_and_client()
    other = hub.client()
    sends_goal(client, id="x", feedback=True)
    sends_goal(other, id="x")
    [sent, others] = is_sent(pursuer)
    client.leaves()
    assert pursuer.hears() == [{"op": "cancel_action_goal", "id": sent, "action": "/fib"}]
    tells(pursuer, sent)
    finishes(pursuer, sent, status=5)
    assert pursuer.hears() == client.hears() == []
    finishes(pursuer, others)
    assert hears_end(other) == (4, True, {"sequence": []})


# How much one client may have.


def test_a_client_may_serve_so_many_actions_and_no_more() -> None:
    hub = FakeHub(max_advertisements=2)
    client = hub.client()
    for action in ("/a", "/b", "/c", "a", "/b"):
        client.says("advertise_action", action=action, type=FIBONACCI)
    assert client.hears_statuses() == [
        "advertise_action: One client may have 2 advertisements, not more "
        "(--max-advertisements of the hub)"
    ]
    assert sorted(hub.graph.actions) == ["/a", "/b"]


def test_a_server_that_does_not_read_is_sent_no_more_than_it_may_be() -> None:
    hub, pursuer, client = server_and_client(max_queued_bytes=2000)
    pursuer.outbox.pause()
    for id_ in range(50):
        sends_goal(client, id=id_)
    refused = [each["values"] for each in client.hears()]
    assert 0 < len(refused) < 50
    assert set(refused) == {"Action /fib is unavailable: /server reads too slowly"}
    assert not pursuer.outbox.overfull
    assert len(hub.graph.actions["/fib"].goals) == 50 - len(refused)


def test_a_server_that_does_not_read_is_not_closed_for_what_others_cancel() -> None:
    _, pursuer, client = server_and_client(max_queued_bytes=2000)
    sends_goal(client, id="x")
    is_sent(pursuer)
    pursuer.outbox.pause()
    for _ in range(100):
        client.says("cancel_action_goal", action="/fib", id="x")
    assert not pursuer.outbox.overfull


def test_a_client_that_does_not_read_is_not_closed_for_feedback() -> None:
    _, pursuer, client = server_and_client(max_queued_bytes=2000)
    sends_goal(client, id="x", feedback=True)
    sent = is_sent_one(pursuer)
    client.outbox.pause()
    for number in range(100):
        tells(pursuer, sent, number)
    finishes(pursuer, sent)
    assert not client.outbox.overfull
    client.outbox.resume()
    assert client.hears()[-1]["op"] == "action_result"
