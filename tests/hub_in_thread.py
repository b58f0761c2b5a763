"""Tools run in this process, and the real hub that they meet, in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import pytest
from click.testing import CliRunner, Result

from fibws.cli.commands import command
from fibws.client.hub_client import HubClient
from fibws.hub import Hub, Settings

Run: TypeAlias = Callable[..., Result]
Publish: TypeAlias = Callable[..., HubClient]


class HubThread:
    """A real hub on a free port, in a thread with an event loop of its own."""

    def __init__(self, **settings: Any) -> None:
        self._settings = settings
        self._loop: asyncio.AbstractEventLoop | None = None
        self._end: asyncio.Event | None = None
        self._started = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()))
        self.url = ""
        self.port = 0

    def start(self) -> None:
        self._thread.start()
        assert self._started.wait(60), "the hub does not start"

    def stop(self) -> None:
        if self._thread.is_alive() and self._loop is not None and self._end is not None:
            self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join(60)

    async def _serve(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        async with Hub(Settings(port=0, close_timeout=0.1, **self._settings)) as hub:
            self.url, self.port = hub.url, hub.port
            self._started.set()
            await self._end.wait()


@pytest.fixture
def hub() -> Iterator[HubThread]:
    """A hub for this test alone."""
    thread = HubThread()
    thread.start()
    yield thread
    thread.stop()


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
