"""Clients that serve and call an AddTwoInts service."""

from __future__ import annotations

from typing import Any

from ..fakes import ADD, Client, FakeHub


def adder(hub: FakeHub, node: str = "/adder", service: str = "/add") -> Client:
    """Return a client that serves the service."""
    client = hub.client(node)
    client.send("advertise_service", service=service, type=ADD)
    assert client.receive() == []
    return client


def adder_and_caller(**settings: Any) -> tuple[FakeHub, Client, Client]:
    """Return a hub, a client that serves /add, and one to call it."""
    hub = FakeHub(**settings)
    return hub, adder(hub), hub.client("/caller")


def call_add(
    client: Client, a: int = 1, b: int = 2, *, service: str = "/add", **fields: Any
) -> None:
    """Call the service."""
    client.send("call_service", service=service, args={"a": a, "b": b}, **fields)


def received_calls(server: Client) -> list[str]:
    """Return the ids of the calls that a server received; nothing else may have come."""
    received = server.receive()
    assert all(each["op"] == "call_service" for each in received), received
    return [each["id"] for each in received]


def received_call(server: Client) -> str:
    """Return the id of the one call that a server received."""
    [id_] = received_calls(server)
    return id_


def respond(server: Client, id_: str, total: int = 3, service: str = "/add") -> None:
    """Respond to a call."""
    values = {"sum": total}
    server.send("service_response", service=service, id=id_, values=values, result=True)


def received_sums(client: Client) -> list[int]:
    """Return the sums of the responses that came; nothing else may have come."""
    received = client.receive()
    assert all(each["op"] == "service_response" and each["result"] for each in received), received
    return [each["values"]["sum"] for each in received]


def received_failure(client: Client) -> str:
    """Return the text of the one response, a failure."""
    response = client.receive_one("service_response")
    assert not response["result"], response
    text: str = response["values"]
    return text
