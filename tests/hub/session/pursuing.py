"""Clients that pursue goals for others, and clients that send them."""

from __future__ import annotations

from typing import Any

from ..fakes import FIBONACCI, Client, FakeHub


def server(hub: FakeHub, node: str = "/server", action: str = "/fib") -> Client:
    """A client that serves the action."""
    client = hub.client(node)
    client.says("advertise_action", action=action, type=FIBONACCI)
    assert client.hears() == []
    return client


def server_and_client(**settings: Any) -> tuple[FakeHub, Client, Client]:
    """A hub with two clients, of which one serves an action and the other wants something."""
    hub = FakeHub(**settings)
    return hub, server(hub), hub.client("/client")


def sends_goal(client: Client, order: int = 5, *, action: str = "/fib", **fields: Any) -> None:
    """Want some Fibonacci numbers."""
    goal = {"action": action, "action_type": FIBONACCI, "args": {"order": order}}
    client.says("send_action_goal", **{**goal, **fields})


def is_sent(server: Client) -> list[str]:
    """The ids of the goals that have come to a server; nothing else may have."""
    heard = server.hears()
    assert all(each["op"] == "send_action_goal" for each in heard), heard
    return [each["id"] for each in heard]


def is_sent_one(server: Client) -> str:
    """The id of the one goal that has come to a server."""
    [id_] = is_sent(server)
    return id_


def tells(server: Client, id_: str, *sequence: int, action: str = "/fib") -> None:
    """Say how far a goal has come."""
    server.says("action_feedback", action=action, id=id_, values={"sequence": sequence})


def finishes(server: Client, id_: str, *sequence: int, status: int = 4) -> None:
    """Say that a goal is reached."""
    values = {"sequence": sequence}
    server.says("action_result", action="/fib", id=id_, values=values, status=status, result=True)


def hears_end(client: Client) -> tuple[int, bool, Any]:
    """The status, the success and the values of the one result that has come."""
    heard = client.hears_one("action_result")
    return heard["status"], heard["result"], heard["values"]
