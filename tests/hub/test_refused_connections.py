"""Connections that a port refuses because of a limit: in the log, the audit and the metrics."""

from __future__ import annotations

import asyncio
import errno
import os
from collections.abc import Callable
from contextlib import AsyncExitStack

import pytest
from conftest import StartHub

from fibws.hub.server import HubServer
from fibws.hub.websocket import shared_limits

from .raw_client import handshake, until

pytestmark = pytest.mark.both_loops

PORTS = ("hub", "ros1")


def number(hub: HubServer, port: str) -> int:
    assert hub.ros1 is not None
    return hub.port if port == "hub" else hub.ros1.port


async def connect(hub: HubServer, port: str, stack: AsyncExitStack) -> asyncio.StreamReader:
    """Open a connection and begin to speak."""
    reader, writer = await asyncio.open_connection("127.0.0.1", number(hub, port))
    stack.callback(writer.close)
    writer.write(handshake() if port == "hub" else b"POST / HTTP/1.1\r\n")
    return reader


async def is_refused(reader: asyncio.StreamReader) -> bool:
    try:
        async with asyncio.timeout(60):
            return b" 101 " not in await reader.readline()
    except ConnectionError:
        return True


def events(caplog: pytest.LogCaptureFixture) -> list[str]:
    found = [each for each in caplog.records if each.name == "fibws.hub.audit"]
    assert all(each.event == "refused" for each in found)  # type: ignore[attr-defined]
    return [each.getMessage() for each in found]


def pause_sweeps(hub: HubServer, monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Let the hub log nothing of its own accord; return the function that has it logged."""
    sweep = hub._limits.sweep
    monkeypatch.setattr(hub._limits, "sweep", lambda now: None)
    return lambda: sweep(0.0)


@pytest.mark.parametrize("port", PORTS)
async def test_limit_of_connections(
    start_hub: StartHub,
    caplog: pytest.LogCaptureFixture,
    port: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = await start_hub(ros1=0, max_connections=2)
    sweep = pause_sweeps(hub, monkeypatch)
    assert hub.ros1 is not None
    async with AsyncExitStack() as stack:
        for _ in range(2):
            await connect(hub, port, stack)
        here = hub.ros1._connections if port == "ros1" else hub._connections
        await until(lambda: len(here) == 2 and (port == "ros1" or hub._limits.clients == 2))
        for _ in range(3):
            assert await is_refused(await connect(hub, port, stack))
    sweep()
    (line,) = events(caplog)
    assert "3 refused" in line and "limit of 2 connections" in line and "--max-connections" in line
    assert hub.audit.refusals["limit"] == hub.health()["refused"] == 3


@pytest.mark.parametrize("port", PORTS)
async def test_limit_of_open_files(
    start_hub: StartHub,
    caplog: pytest.LogCaptureFixture,
    port: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = await start_hub(ros1=0)
    sweep = pause_sweeps(hub, monkeypatch)
    monkeypatch.setattr(shared_limits, "_most_files", lambda: 8)
    async with AsyncExitStack() as stack:
        for _ in range(3):
            assert await is_refused(await connect(hub, port, stack))
    sweep()
    (line,) = events(caplog)
    assert "3 refused" in line and "limit of 8 open files" in line and "ulimit -n" in line
    assert hub.audit.refusals["limit"] == hub.health()["refused"] == 3


async def test_accepts_that_fail_are_one_event(
    start_hub: StartHub, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are asyncio's, which does not say of which port."""
    hub = await start_hub(ros1=0)
    sweep = pause_sweeps(hub, monkeypatch)
    fault = OSError(errno.EMFILE, os.strerror(errno.EMFILE))
    for _ in range(1000):
        asyncio.get_running_loop().call_exception_handler(
            {"message": "socket.accept() out of system resource", "exception": fault}
        )
    sweep()
    (line,) = events(caplog)
    assert "open files" in line


async def test_last_refusals_are_logged_when_the_hub_ends(
    start_hub: StartHub, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub = await start_hub(ros1=0, max_connections=0)
    pause_sweeps(hub, monkeypatch)
    async with AsyncExitStack() as stack:
        assert await is_refused(await connect(hub, "ros1", stack))
    await hub.close()
    (line,) = events(caplog)
    assert "1 refused" in line
