"""A real hub on a free port, on both event loops if a test requests it."""

from __future__ import annotations

import asyncio
import gc
import logging
import os
import re
import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.database import DirectoryBasedExampleDatabase
from recorded_answers import add_option, select_tests
from recorded_answers import answer_files as answer_files
from recorded_answers import answers as answers

from fibws.hub import Settings
from fibws.hub.server import HubServer

# On a busy machine an example may take long, and so may generating it.
_PATIENT: dict[str, Any] = {
    "deadline": None,
    "suppress_health_check": [HealthCheck.too_slow],
}
settings.register_profile("landing", max_examples=20, derandomize=True, **_PATIENT)
settings.register_profile(
    "thorough",
    max_examples=100,
    derandomize=False,  # Hypothesis sets this and the next where the variable CI is set.
    database=DirectoryBasedExampleDatabase(".hypothesis/examples"),
    print_blob=True,
    **_PATIENT,
)
settings.load_profile("landing")

LoopFactory = Callable[[], asyncio.AbstractEventLoop]
StartHub = Callable[..., Awaitable[HubServer]]
UVLOOP: LoopFactory | None
try:
    from uvloop import new_event_loop as UVLOOP
except ImportError:
    UVLOOP = None


class EventLoop(asyncio.SelectorEventLoop):
    """asyncio's, without its loss of a connection that is accepted while its server is closed.

    The loss, between ``accept()`` and the transport, leaves a socket open, and pytest blames the
    test that happens to run when it is collected.
    """

    async def _accept_connection2(
        self,
        protocol_factory: Callable[[], asyncio.BaseProtocol],
        conn: socket.socket,
        extra: dict[str, Any],
        sslcontext: Any = None,
        server: asyncio.Server | None = None,
        *timeouts: float,
    ) -> None:
        if server is not None and not server.is_serving():
            conn.close()
            return
        accept = super()._accept_connection2  # type: ignore[misc]
        await accept(protocol_factory, conn, extra, sslcontext, server, *timeouts)


SWEEP_INTERVAL = 0.02
"""Seconds between two sweeps in tests, so that tests need not wait for a whole second."""
SETTINGS: dict[str, Any] = {
    "port": 0,
    "close_timeout": 1.0,
    # On a busy machine a test may take as long as clients are given, and its own answer no pings.
    "open_timeout": 600.0,
    "stall_timeout": 600.0,
    "ping_interval": 0.0,
}


def pytest_addoption(parser: pytest.Parser) -> None:
    add_option(parser)


def pytest_xdist_auto_num_workers() -> int:
    """Return three workers for two CPUs: many tests wait most of their time."""
    return max(2, (os.cpu_count() or 1) * 3 // 2)


def pytest_asyncio_loop_factories(
    config: pytest.Config, item: pytest.Item
) -> Mapping[str, LoopFactory]:
    """The event loops that a test runs on: uvloop's too, if it is installed and asked for."""
    factories: dict[str, LoopFactory] = {
        "asyncio": EventLoop if os.name != "nt" else asyncio.new_event_loop
    }
    if item.get_closest_marker("both_loops") and UVLOOP is not None:
        factories["uvloop"] = UVLOOP
    return factories


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out modules whose imports are of POSIX alone, such as ``import pty``, on Windows."""
    if os.name != "nt" or collection_path.suffix != ".py":
        return None
    imports = r"^(?:import|from) (?:fcntl|pty|pwd|resource|termios|tty)(?:$| import )"
    return bool(re.search(imports, collection_path.read_text("utf-8"), re.MULTILINE)) or None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark the tests that run on uvloop's event loop; select those that record answers of ROS."""
    select_tests(config, items)
    if UVLOOP is None:
        return
    for item in items:
        parameters = item.callspec.params.values() if hasattr(item, "callspec") else ()
        if any(each is UVLOOP for each in parameters):
            item.add_marker(pytest.mark.uvloop)


def pytest_collection_finish() -> None:
    """Keep the thousands of tests out of each later collection of garbage: they are not any."""
    gc.collect()
    gc.freeze()


class Faults:
    """Internal errors of the hub, which clients do not see."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def expect(self, text: str) -> None:
        """Take note of one fault that the test brought about on purpose."""
        found = [fault for fault in self.seen if text in fault]
        assert found, f"no fault contains {text!r}: {self.seen}"
        self.seen.remove(found[0])

    def in_a_callback(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """The loop's exception handler."""
        self.seen.append(f"{context['message']} {context.get('exception')!r}")


class _Tracebacks(logging.Handler):
    def __init__(self, faults: Faults) -> None:
        super().__init__(logging.ERROR)
        self._faults = faults

    def emit(self, record: logging.LogRecord) -> None:
        self._faults.seen.append(self.format(record))


@pytest.fixture
async def faults() -> AsyncIterator[Faults]:
    """Fails the test if a callback raised, or an error was logged, unless it was expected."""
    faults = Faults()
    asyncio.get_running_loop().set_exception_handler(faults.in_a_callback)
    handler = _Tracebacks(faults)
    loggers = [logging.getLogger("fibws"), logging.getLogger("asyncio")]
    for logger in loggers:
        logger.addHandler(handler)
    yield faults
    for logger in loggers:
        logger.removeHandler(handler)
    assert faults.seen == []


@pytest.fixture(autouse=True)
def patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """Allow late pongs, because the machine may be busy."""
    monkeypatch.setattr("fibws.hub.rosapi.rosnode.PATIENCE", 60.0)


@pytest.fixture
async def start_hub(monkeypatch: pytest.MonkeyPatch, faults: Faults) -> AsyncIterator[StartHub]:
    """Starts hubs with the settings that a test wants; afterwards they must have forgotten all."""
    monkeypatch.setattr("fibws.hub.server.SWEEP_INTERVAL", SWEEP_INTERVAL)
    hubs: list[HubServer] = []
    async with AsyncExitStack() as stack:

        async def start(**settings: Any) -> HubServer:
            hub = await stack.enter_async_context(HubServer(Settings(**{**SETTINGS, **settings})))
            hubs.append(hub)
            return hub

        yield start
        async with asyncio.timeout(60):
            await stack.aclose()
    for hub in hubs:
        graph = hub.graph
        assert (graph.nodes, graph.topics, graph.services, graph.actions) == ({}, {}, {}, {})


@pytest.fixture
async def hub(start_hub: StartHub) -> HubServer:
    """A hub with the ordinary settings on a free port."""
    return await start_hub()
