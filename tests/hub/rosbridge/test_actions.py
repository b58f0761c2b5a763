"""Serving actions."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest

from ..fakes import FIBONACCI, Client, FakeHub
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

CANCEL_GOAL = "/fib/_action/cancel_goal"


def test_served_action_is_in_the_graph() -> None:
    hub = FakeHub()
    server(hub, "/server", "~fib")
    action = hub.graph.actions["/server/fib"]
    assert (action.name, action.type.name, action.node) == ("/server/fib", FIBONACCI, "/server")


def test_advertise_action_is_acknowledged_at_level_info() -> None:
    client = FakeHub().client("/server")
    client.send("set_level", level="info")
    client.send("advertise_action", action="fib", type="example_interfaces/action/Fibonacci", id=5)
    assert client.receive() == [
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
def test_invalid_action_is_refused_and_leaves_nothing(fields: dict[str, Any], fault: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("advertise_action", **{"action": "/fib", "type": FIBONACCI, **fields})
    [status] = client.receive_statuses()
    assert status.startswith("advertise_action: ")
    assert fault in status
    assert not (hub.graph.actions or hub.graph.services)
    assert client.forgotten


def test_strict_types_refuse_an_unknown_package() -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.send("advertise_action", action="/do", type="my_actions/Do")
    assert client.receive_statuses() == [
        "advertise_action: Unable to load the manifest for package my_actions. "
        "Caused by: no folder of definitions contains it (FIBWS_INTERFACES names them)"
    ]
    assert hub.empty is False
    assert hub.graph.actions == {}


def test_action_of_an_unknown_package_gives_a_warning() -> None:
    client = FakeHub().client()
    client.send("set_level", level="warning")
    client.send("advertise_action", action="/do", type="my_actions/Do", id=1)
    [status] = client.receive()
    assert (status["id"], status["level"]) == (1, "warning")
    assert "my_actions/Do are not checked" in status["msg"]


def test_server_may_bring_the_definition() -> None:
    hub = FakeHub(strict_types=True)
    action_server, client = hub.client(), hub.client()
    definition = "int8 goal\n---\nint8 result\n---\nint8 feedback\n"
    action_server.send(
        "advertise_action", action="/do", type="my_actions/Do", definition=definition
    )
    send_goal(client, action="/do", action_type="my_actions/Do", args={"goal": 5}, feedback=True)
    sent = received_goal(action_server)
    action_server.send("action_feedback", action="/do", id=sent, values={"feedback": 500})
    assert "500 is not in -128..127" in action_server.receive_statuses()[0]
    action_server.send("action_feedback", action="/do", id=sent)
    assert client.receive_one("action_feedback")["values"] == {"feedback": 0}
    action_server.send("action_result", action="/do", id=sent, result=True)
    assert received_result(client) == (4, True, {"result": 0})


# Several servers of one name, and the end.


def test_newer_server_takes_the_action_over() -> None:
    hub, older, client = server_and_client()
    send_goal(client, id="old", feedback=True)
    before = received_goal(older)
    newer = server(hub, "/newer")
    assert older.receive_statuses("warning") == ["/fib has another server now: /newer"]
    assert hub.graph.actions["/fib"].node == "/newer"
    send_goal(client, id="new")
    after = received_goal(newer)
    send_feedback(older, before, 1)
    client.send("cancel_action_goal", action="/fib", id="old")
    assert older.receive_one("cancel_action_goal")["id"] == before
    send_result(older, before, status=5)
    send_result(newer, after)
    assert [(each["op"], each["id"]) for each in client.receive()] == [
        ("action_feedback", "old"),
        ("action_result", "old"),
        ("action_result", "new"),
    ]


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_older_server_cannot_remove_the_newer(end: str) -> None:
    hub, older, client = server_and_client()
    newer = server(hub, "/newer")
    if end == "leave":
        older.disconnect()
    else:
        older.send("unadvertise_action", action="/fib")
    send_goal(client)
    assert len(received_goals(newer)) == 1
    assert CANCEL_GOAL in hub.graph.services


def test_client_may_serve_its_action_again_under_another_spelling() -> None:
    _, action_server, client = server_and_client()
    send_goal(client, id="before")
    before = received_goal(action_server)
    action_server.send("advertise_action", action="fib", type=FIBONACCI)
    send_goal(client, id="after")
    sent = action_server.receive_one("send_action_goal")
    assert sent["action"] == "fib"
    send_result(action_server, before)
    send_result(action_server, sent["id"])
    assert [each["id"] for each in client.receive()] == ["before", "after"]


@pytest.mark.parametrize("by", ["service", "operation"])
def test_goals_continue_and_can_be_cancelled_after_the_server_is_replaced(by: str) -> None:
    for later in product(("a serves", "a ends", "b serves", "b ends"), repeat=3):
        events = ("a serves", *later)
        hub = FakeHub()
        client, servers = hub.client("/client"), {name: hub.client(f"/{name}") for name in "ab"}
        goals: dict[str, dict[str, int]] = {"a": {}, "b": {}}
        """The goals that each server has: their ids there, and at the client."""
        current = None
        for number, event in enumerate(events):
            name, _, verb = event.partition(" ")
            if verb == "serves":
                servers[name].send("advertise_action", action="/fib", type=FIBONACCI)
                current = name
            else:
                servers[name].send("unadvertise_action", action="/fib")
                if name == current:
                    assert received_ids(client, "action_result") == set(goals[name].values())
                    goals[name].clear()
                    current = None
            if current is not None:
                send_goal(client, id=number)
                [id_] = received_ids(servers[current], "send_action_goal")
                goals[current][id_] = number
        running = {id_ for each in goals.values() for id_ in each.values()}
        if by == "operation":
            for id_ in running:
                client.send("cancel_action_goal", action="/fib", id=id_)
        elif current is not None:
            client.send("call_service", service=CANCEL_GOAL, args={})
            values = client.receive_one("service_response")["values"]
            assert (values["return_code"], len(values["goals_canceling"])) == (0, len(running))
        for name, each in servers.items():
            is_cancelled = by == "operation" or current is not None
            expected = goals[name].keys() if is_cancelled else set()
            assert received_ids(each, "cancel_action_goal") == expected, events
            for id_ in goals[name]:
                send_result(each, id_, status=5)
        assert received_ids(client, "action_result") == running, events
        assert client.forgotten
        for each in (client, *servers.values()):
            each.disconnect()
        assert hub.empty


def received_ids(client: Client, op: str) -> set[Any]:
    """Return the ids of the operations of one name; others may have come, too."""
    return {each["id"] for each in client.receive() if each["op"] == op}


@pytest.mark.parametrize("again", [False, True])
def test_goals_are_aborted_when_the_action_is_unadvertised(again: bool) -> None:
    hub, action_server, client = server_and_client()
    send_goal(client, id="x")
    if again:
        action_server.send("advertise_action", action="/fib", type=FIBONACCI)
    sent = received_goal(action_server)
    action_server.send("unadvertise_action", action="fib")
    assert received_result(client) == (6, False, "Action /fib was unadvertised")
    assert not (hub.graph.actions or hub.graph.services)
    send_goal(client)
    assert received_result(client) == (6, False, "Action /fib does not exist")
    send_result(action_server, sent)
    assert client.receive() == action_server.receive() == []


@pytest.mark.parametrize("action", ["/nope", "nope"])
def test_unadvertising_an_unknown_action_is_harmless(action: str) -> None:
    hub, action_server, client = server_and_client()
    action_server.send("unadvertise_action", action=action)
    client.send("unadvertise_action", action="/fib")
    assert action_server.receive() == client.receive() == []
    assert list(hub.graph.actions) == ["/fib"]


@pytest.mark.parametrize("replaced", [False, True])
def test_goals_are_aborted_when_the_server_leaves(replaced: bool) -> None:
    hub, action_server, client = server_and_client()
    for id_ in "ab":
        send_goal(client, id=id_)
    if replaced:
        hub.client("/server")
    else:
        action_server.disconnect()
    assert [(each["id"], each["status"], each["result"]) for each in client.receive()] == [
        (id_, 6, False) for id_ in "ab"
    ]
    assert client.forgotten
    assert not (hub.graph.actions or hub.graph.services)


def test_leaving_client_cancels_its_goals() -> None:
    hub, action_server, client = server_and_client()
    other = hub.client()
    send_goal(client, id="x", feedback=True)
    send_goal(other, id="x")
    [sent, others] = received_goals(action_server)
    client.disconnect()
    assert action_server.receive() == [{"op": "cancel_action_goal", "id": sent, "action": "/fib"}]
    send_feedback(action_server, sent)
    send_result(action_server, sent, status=5)
    assert action_server.receive() == client.receive() == []
    send_result(action_server, others)
    assert received_result(other) == (4, True, {"sequence": []})


# How much one client may have.


def test_number_of_actions_of_a_client_is_limited() -> None:
    hub = FakeHub(max_advertisements=2)
    client = hub.client()
    for action in ("/a", "/b", "/c", "a", "/b"):
        client.send("advertise_action", action=action, type=FIBONACCI)
    [text] = client.receive_statuses()
    assert text.startswith("advertise_action: ")
    assert "limit 2" in text
    assert "--max-advertisements" in text
    assert sorted(hub.graph.actions) == ["/a", "/b"]


def test_goals_for_a_server_that_does_not_read_are_limited() -> None:
    hub, action_server, client = server_and_client(max_queued_bytes=2000)
    action_server.queue.pause()
    for id_ in range(50):
        send_goal(client, id=id_)
    refused = [each["values"] for each in client.receive()]
    assert 0 < len(refused) < 50
    assert set(refused) == {"Action /fib is unavailable: /server reads too slowly"}
    assert not action_server.queue.overfull
    assert len(hub.graph.actions["/fib"].goals) == 50 - len(refused)


def test_cancels_do_not_close_a_server_that_does_not_read() -> None:
    _, action_server, client = server_and_client(max_queued_bytes=2000)
    send_goal(client, id="x")
    received_goals(action_server)
    action_server.queue.pause()
    for _ in range(100):
        client.send("cancel_action_goal", action="/fib", id="x")
    assert not action_server.queue.overfull


def test_feedback_does_not_close_a_client_that_does_not_read() -> None:
    _, action_server, client = server_and_client(max_queued_bytes=2000)
    send_goal(client, id="x", feedback=True)
    sent = received_goal(action_server)
    client.queue.pause()
    for number in range(100):
        send_feedback(action_server, sent, number)
    send_result(action_server, sent)
    assert not client.queue.overfull
    client.queue.resume()
    assert client.receive()[-1]["op"] == "action_result"
