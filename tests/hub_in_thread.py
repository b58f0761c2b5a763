"""Tools run in this process, and the real hub that they meet, in a thread of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import pytest
from click.testing import CliRunner, Result

from fibws.cli.commands import command
from fibws.client.hub_client import HubClient
from fibws.testing import HubThread as HubThread

Run: TypeAlias = Callable[..., Result]
Publish: TypeAlias = Callable[..., HubClient]


@pytest.fixture
def hub() -> Iterator[HubThread]:
    """A hub for this test alone."""
    with HubThread() as hub:
        yield hub


@pytest.fixture
def run(hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run ``fibws`` with these arguments at the hub; ``input`` is its standard input."""
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)

    def run(*words: str, input: str | None = None) -> Result:
        return CliRunner().invoke(command, words, input=input, prog_name="fibws")

    return run


@pytest.fixture
def client(hub: HubThread) -> Iterator[HubClient]:
    """A node that is there while the test runs: its name is `HubClient.node`."""
    with HubClient("pub", hub.url) as client:
        yield client


@pytest.fixture
def publish(client: HubClient) -> Publish:
    """Publish a latched message by `client`; when this returns, the hub has it."""

    def publish(topic: str, type_: str, msg: Any = None) -> HubClient:
        client.send({"op": "advertise", "topic": topic, "type": type_, "latch": True})
        client.send({"op": "publish", "topic": topic, "msg": msg})
        client.call("/rosapi/get_time")
        while (operation := client.receive(0)) is not None:
            assert operation.get("op") != "status", operation
        return client

    return publish
