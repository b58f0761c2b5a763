"""Clients that serve a Fibonacci action, and clients that send goals."""

from __future__ import annotations

from typing import Any

from ..fakes import FIBONACCI, Client, FakeHub


def server(hub: FakeHub, node: str = "/server", action: str = "/fib") -> Client:
    """Return a client that serves the action."""
    client = hub.client(node)
    client.send("advertise_action", action=action, type=FIBONACCI)
    assert client.receive() == []
    return client


def server_and_client(**settings: Any) -> tuple[FakeHub, Client, Client]:
    """Return a hub, a client that serves /fib, and one to send goals."""
    hub = FakeHub(**settings)
    return hub, server(hub), hub.client("/client")


def send_goal(client: Client, order: int = 5, *, action: str = "/fib", **fields: Any) -> None:
    """Send a goal."""
    goal = {"action": action, "action_type": FIBONACCI, "args": {"order": order}}
    client.send("send_action_goal", **{**goal, **fields})


def received_goals(server: Client) -> list[str]:
    """Return the ids of the goals that a server received; nothing else may have come."""
    received = server.receive()
    assert all(each["op"] == "send_action_goal" for each in received), received
    return [each["id"] for each in received]


def received_goal(server: Client) -> str:
    """Return the id of the one goal that a server received."""
    [id_] = received_goals(server)
    return id_


def send_feedback(server: Client, id_: str, *sequence: int, action: str = "/fib") -> None:
    """Send feedback of a goal."""
    server.send("action_feedback", action=action, id=id_, values={"sequence": sequence})


def send_result(server: Client, id_: str, *sequence: int, status: int = 4) -> None:
    """Send the result of a goal."""
    values = {"sequence": sequence}
    server.send("action_result", action="/fib", id=id_, values=values, status=status, result=True)


def received_result(client: Client) -> tuple[int, bool, Any]:
    """Return status, success and values of the one result that came."""
    received = client.receive_one("action_result")
    return received["status"], received["result"], received["values"]
