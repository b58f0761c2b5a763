"""Clients that add numbers for others, and clients that have them added."""

from __future__ import annotations

from typing import Any

from ..fakes import ADD, Client, FakeHub


def adder(hub: FakeHub, node: str = "/adder", service: str = "/add") -> Client:
    """A client that provides the service."""
    client = hub.client(node)
    client.says("advertise_service", service=service, type=ADD)
    assert client.hears() == []
    return client


def adder_and_caller(**settings: Any) -> tuple[FakeHub, Client, Client]:
    """A hub with two clients, of which one adds and the other calls."""
    hub = FakeHub(**settings)
    return hub, adder(hub), hub.client("/caller")


def calls(client: Client, a: int = 1, b: int = 2, *, service: str = "/add", **fields: Any) -> None:
    """Have two numbers added."""
    client.says("call_service", service=service, args={"a": a, "b": b}, **fields)


def is_asked(provider: Client) -> list[str]:
    """The ids of the calls that have come to a provider; nothing else may have."""
    heard = provider.hears()
    assert all(each["op"] == "call_service" for each in heard), heard
    return [each["id"] for each in heard]


def is_asked_once(provider: Client) -> str:
    """The id of the one call that has come to a provider."""
    [id_] = is_asked(provider)
    return id_


def answers(provider: Client, id_: str, total: int = 3, service: str = "/add") -> None:
    """Answer a call."""
    values = {"sum": total}
    provider.says("service_response", service=service, id=id_, values=values, result=True)


def hears_sums(client: Client) -> list[int]:
    """The responses that have come, which are all successes; nothing else may have."""
    heard = client.hears()
    assert all(each["op"] == "service_response" and each["result"] for each in heard), heard
    return [each["values"]["sum"] for each in heard]


def hears_failure(client: Client) -> str:
    """The text of the one response that has come."""
    response = client.hears_one("service_response")
    assert not response["result"], response
    text: str = response["values"]
    return text
