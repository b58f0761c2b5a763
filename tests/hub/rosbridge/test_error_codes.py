"""Error codes: errors carry them on connections of ``fibws.v1``, and nowhere else."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from fibws.access.rights import Right
from fibws.hub.graph.policy import AllowAll

from ..fakes import ADD, FIBONACCI, INT32, Client, FakeHub

Provoke = Callable[[FakeHub, Client], None]
"""Makes a hub send one error to a client."""


class Refuser(AllowAll):
    """A policy that refuses every use of names below /secret."""

    allows_all = False

    def may(self, node: str, right: Right, name: str) -> bool:
        return not name.startswith("/secret")


def operation(op: str, **fields: Any) -> Provoke:
    """Return a function that sends an operation."""
    return lambda hub, client: client.send(op, **fields)


def call(service: str = "/add", **fields: Any) -> dict[str, Any]:
    return {"service": service, "args": {"a": 1, "b": 2}, "id": "c", **fields}


def goal(action: str = "/fib", **fields: Any) -> dict[str, Any]:
    return {"action": action, "action_type": FIBONACCI, "args": {"order": 3}, "id": "g", **fields}


# Statuses


def other_type(hub: FakeHub, client: Client) -> None:
    client.send("advertise", "/n", type="std_msgs/String")
    client.send("advertise", "/n", type=INT32)


def unfitting_message(hub: FakeHub, client: Client) -> None:
    client.send("advertise", "/n", type=INT32)
    client.send("publish", "/n", msg={"data": "text"})


def second_topic(hub: FakeHub, client: Client) -> None:
    client.send("advertise", "/a", type=INT32)
    client.send("advertise", "/b", type=INT32)


def many_requests_of_one_topic(hub: FakeHub, client: Client) -> None:
    for id_ in range(101):
        client.send("subscribe", "/a", id=id_)


def latched_too_much(hub: FakeHub, client: Client) -> None:
    client.send("advertise", "/a", type="std_msgs/String", latch=True)
    client.send("publish", "/a", msg={"data": "x" * 2000})


def hub_fails(hub: FakeHub, client: Client) -> None:
    hub.graph.topic = None  # type: ignore[method-assign,assignment]
    client.send("subscribe", "/a")


STATUSES: dict[str, tuple[str, Provoke]] = {
    "unknown operation": ("invalid_operation", operation("fly")),
    "missing field": ("invalid_operation", operation("subscribe")),
    "invalid JSON": ("invalid_operation", lambda hub, client: client.send_text("{")),
    "invalid name": ("invalid_name", operation("subscribe", topic="a b")),
    "invalid type name": ("invalid_type_name", operation("advertise", topic="/n", type="Int32")),
    "unknown type": ("unknown_type", operation("advertise", topic="/n", type="std_msgs/Int33")),
    "invalid definition": (
        "invalid_definition",
        operation("advertise", topic="/n", type="my/T", definition="int32"),
    ),
    "other type": ("type_conflict", other_type),
    "other md5sum": (
        "type_conflict",
        operation("subscribe", topic="/n", type=INT32, md5sum="0123"),
    ),
    "unfitting message": ("invalid_message", unfitting_message),
    "too many topics": ("limit_reached", second_topic),
    "too many requests": ("limit_reached", many_requests_of_one_topic),
    "too many latched bytes": ("limit_reached", latched_too_much),
    "forbidden publisher": ("not_allowed", operation("advertise", topic="/secret", type=INT32)),
    "forbidden subscriber": ("not_allowed", operation("subscribe", topic="/secret")),
    "forbidden service": (
        "not_allowed",
        operation("advertise_service", service="/secret", type=ADD),
    ),
    "forbidden action": (
        "not_allowed",
        operation("advertise_action", action="/secret", type=FIBONACCI),
    ),
    "fault of the hub": ("internal_error", hub_fails),
}


@pytest.mark.parametrize("serialized", [True, False], ids=["fibws.v1", "plain"])
@pytest.mark.parametrize("case", STATUSES)
def test_code_of_a_status(case: str, serialized: bool) -> None:
    code, provoke = STATUSES[case]
    hub = FakeHub(policy=Refuser(), max_advertisements=1, max_latched_bytes=1000)
    client = hub.client("/client", serialized=serialized)
    provoke(hub, client)
    status = client.receive_one("status")
    assert status["level"] == "error"
    assert status.get("code", "absent") == (code if serialized else "absent")


@pytest.mark.parametrize("serialized", [True, False], ids=["fibws.v1", "plain"])
def test_warnings_and_infos_have_no_code(serialized: bool) -> None:
    client = FakeHub().client(serialized=serialized)
    client.send("set_level", level="info")
    client.send("auth")
    client.send("advertise", "/n", type="my_msgs/T")
    statuses = client.receive()
    assert {each["level"] for each in statuses} == {"warning", "info"}
    assert not any("code" in each for each in statuses)


# Service responses


def add_server(hub: FakeHub) -> Client:
    server = hub.client("/server")
    server.send("advertise_service", service="/add", type=ADD)
    return server


def called(react: Callable[[Client, str], None]) -> Provoke:
    """Return a function that calls a service whose server reacts with ``react``."""

    def provoke(hub: FakeHub, client: Client) -> None:
        server = add_server(hub)
        client.send("call_service", **call())
        react(server, server.receive_one("call_service")["id"])

    return provoke


def respond(**fields: Any) -> Callable[[Client, str], None]:
    return lambda server, id_: server.send("service_response", service="/add", id=id_, **fields)


def time_passes(hub: FakeHub, client: Client) -> None:
    add_server(hub)
    client.send("call_service", **call(timeout=1))
    hub.clock.advance(2)


def server_reads_slowly(hub: FakeHub, client: Client) -> None:
    add_server(hub).queue.pause()
    hub.client().send("call_service", **call(id="x" * 100))
    for _ in range(20):
        hub.client().send("call_service", **call())
    client.send("call_service", **call())


def too_many_calls(hub: FakeHub, client: Client) -> None:
    add_server(hub)
    client.send("call_service", **call(id="first"))
    client.send("call_service", **call())


def hub_service_fails(hub: FakeHub, client: Client) -> None:
    def fail(request: dict[str, Any], caller: str) -> dict[str, Any]:
        raise ZeroDivisionError

    hub.graph.serve_internally("/fails", ADD, "/rosapi", fail)
    client.send("call_service", **call("/fails"))


def with_add_server(provoke: Provoke) -> Provoke:
    def provoke_with_server(hub: FakeHub, client: Client) -> None:
        add_server(hub)
        provoke(hub, client)

    return provoke_with_server


RESPONSES: dict[str, tuple[str, Provoke]] = {
    "unknown service": ("unknown_service", operation("call_service", **call("/missing"))),
    "invalid name": ("invalid_name", operation("call_service", **call("a b"))),
    "forbidden": ("not_allowed", operation("call_service", **call("/secret"))),
    "timeout": ("timeout", time_passes),
    "server leaves": ("server_lost", called(lambda server, id_: server.disconnect())),
    "server unadvertises": (
        "server_lost",
        called(lambda server, id_: server.send("unadvertise_service", service="/add")),
    ),
    "server reads slowly": ("server_busy", server_reads_slowly),
    "server responds with an error": ("server_failed", called(respond(result=False, values="no"))),
    "server's code is not passed on": (
        "server_failed",
        called(respond(result=False, values="no", code="timeout")),
    ),
    "server's text is the hub's own for an unknown service": (
        "server_failed",
        called(respond(result=False, values="Service /add does not exist", code="unknown_service")),
    ),
    "unfitting response": (
        "invalid_message",
        called(respond(result=True, values={"sum": "three"})),
    ),
    "malformed response": ("invalid_operation", called(respond(result="yes", values={}))),
    "hub fails": ("server_failed", hub_service_fails),
    "unfitting request": (
        "invalid_message",
        with_add_server(operation("call_service", **call(args={"a": "one"}))),
    ),
    "other md5sum": (
        "type_conflict",
        with_add_server(operation("call_service", **call(headers={"md5sum": "0123"}))),
    ),
    "too many calls": ("limit_reached", too_many_calls),
}


@pytest.mark.parametrize("serialized", [True, False], ids=["fibws.v1", "plain"])
@pytest.mark.parametrize("case", RESPONSES)
def test_code_of_a_service_response(case: str, serialized: bool) -> None:
    code, provoke = RESPONSES[case]
    hub = FakeHub(policy=Refuser(), max_calls=1, max_queued_bytes=2000)
    client = hub.client("/client", serialized=serialized)
    provoke(hub, client)
    [response] = [each for each in client.receive() if each["op"] == "service_response"]
    assert (response["id"], response["result"]) == ("c", False)
    assert response.get("code", "absent") == (code if serialized else "absent")


def test_malformed_call_has_a_code_in_its_status_and_in_its_response() -> None:
    client = FakeHub().client(serialized=True)
    client.send("call_service", service="/add", id="c", timeout="long")
    status, response = client.receive()
    assert (status["op"], response["op"]) == ("status", "service_response")
    assert status["code"] == response["code"] == "invalid_operation"


# Action results


def action_server(hub: FakeHub) -> Client:
    server = hub.client("/server")
    server.send("advertise_action", action="/fib", type=FIBONACCI)
    return server


def sent(react: Callable[[Client, str], None]) -> Provoke:
    """Return a function that sends a goal to a server that reacts with ``react``."""

    def provoke(hub: FakeHub, client: Client) -> None:
        server = action_server(hub)
        client.send("send_action_goal", **goal())
        react(server, server.receive_one("send_action_goal")["id"])

    return provoke


def finish(**fields: Any) -> Callable[[Client, str], None]:
    return lambda server, id_: server.send("action_result", action="/fib", id=id_, **fields)


def with_action_server(provoke: Provoke) -> Provoke:
    def provoke_with_server(hub: FakeHub, client: Client) -> None:
        action_server(hub)
        provoke(hub, client)

    return provoke_with_server


def too_many_goals(hub: FakeHub, client: Client) -> None:
    action_server(hub)
    client.send("send_action_goal", **goal(id="first"))
    client.send("send_action_goal", **goal())


def action_server_reads_slowly(hub: FakeHub, client: Client) -> None:
    action_server(hub).queue.pause()
    for _ in range(20):
        hub.client().send("send_action_goal", **goal())
    client.send("send_action_goal", **goal())


RESULTS: dict[str, tuple[str, Provoke]] = {
    "unknown action": ("unknown_action", operation("send_action_goal", **goal("/missing"))),
    "invalid name": ("invalid_name", operation("send_action_goal", **goal("a b"))),
    "forbidden": ("not_allowed", operation("send_action_goal", **goal("/secret"))),
    "other type": (
        "type_conflict",
        with_action_server(
            operation(
                "send_action_goal", **goal(action_type="action_tutorials_interfaces/Fibonacci")
            )
        ),
    ),
    "unfitting goal": (
        "invalid_message",
        with_action_server(operation("send_action_goal", **goal(args={"order": "many"}))),
    ),
    "server leaves": ("server_lost", sent(lambda server, id_: server.disconnect())),
    "server unadvertises": (
        "server_lost",
        sent(lambda server, id_: server.send("unadvertise_action", action="/fib")),
    ),
    "server reads slowly": ("server_busy", action_server_reads_slowly),
    "server fails": ("server_failed", sent(finish(result=False, values="no"))),
    "unfitting result": ("invalid_message", sent(finish(result=True, values={"sequence": "1"}))),
    "malformed result": ("invalid_operation", sent(finish(result=True, status=99))),
    "too many goals": ("limit_reached", too_many_goals),
}


@pytest.mark.parametrize("serialized", [True, False], ids=["fibws.v1", "plain"])
@pytest.mark.parametrize("case", RESULTS)
def test_code_of_an_action_result(case: str, serialized: bool) -> None:
    code, provoke = RESULTS[case]
    hub = FakeHub(policy=Refuser(), max_goals=1, max_queued_bytes=2000)
    client = hub.client("/client", serialized=serialized)
    provoke(hub, client)
    [result] = [each for each in client.receive() if each["op"] == "action_result"]
    assert (result["id"], result["result"], result["status"]) == ("g", False, 6)
    assert result.get("code", "absent") == (code if serialized else "absent")


@pytest.mark.parametrize("serialized", [True, False], ids=["fibws.v1", "plain"])
def test_successes_have_no_code(serialized: bool) -> None:
    hub = FakeHub()
    server, client = add_server(hub), hub.client("/client", serialized=serialized)
    server.send("advertise_action", action="/fib", type=FIBONACCI)
    client.send("call_service", **call())
    respond(result=True, values={"sum": 3})(server, server.receive_one("call_service")["id"])
    client.send("send_action_goal", **goal())
    finish(result=True, values={}, status=4)(server, server.receive_one("send_action_goal")["id"])
    assert [(each["result"], "code" in each) for each in client.receive()] == [(True, False)] * 2
