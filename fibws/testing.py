"""Tests of your own nodes: a hub for each test, and functions that wait.

Needs ``pip install 'fibws[testing]'``, and in ``conftest.py``:

    pytest_plugins = ["fibws.testing"]

Then a test may take `hub`, a hub of its own, and `node`, a node that is connected to it. While such
a test runs, $FIBWS_HUB is the address of its hub: nodes and programs that it starts need no other.
"""

from __future__ import annotations

import asyncio
import dataclasses
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterator
from contextlib import asynccontextmanager
from inspect import isawaitable
from typing import Any, Self, TypeVar, overload

import pytest
import pytest_asyncio

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer

M = TypeVar("M", bound=fibws.Message)
T = TypeVar("T")

TIMEOUT = 10.0
"""Seconds that the functions of this module wait by default."""
CLOSE_TIMEOUT = 0.2
"""Seconds that a test's hub waits for clients that do not close their connections."""
INTERVAL = 0.01
"""Seconds between two checks of a condition."""


class HubThread:
    """A hub in a thread of its own: ``with HubThread() as hub``.

    A test may block or use another event loop without blocking the hub.

    Args:
        settings: the hub's settings; the default is a free port of this machine.

    Raises:
        HubError: on entering, when the hub cannot listen.
    """

    def __init__(self, settings: Settings | None = None) -> None:
        self._settings = settings or Settings(port=0, close_timeout=CLOSE_TIMEOUT)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._end: asyncio.Event | None = None
        self._ready = threading.Event()
        self._errors: list[BaseException] = []
        self._thread: threading.Thread | None = None
        self.url = ""
        """The hub's URL, such as ``ws://127.0.0.1:41253``."""
        self.master_uri = ""
        """The ``ROS_MASTER_URI`` of ROS 1 nodes; empty without ``Settings(ros1=...)``."""

    @property
    def port(self) -> int:
        """The port that the hub listens on; it stays the same when the hub starts again."""
        return self._settings.port

    def start(self) -> None:
        """Start the hub, or start it again after `stop`; return when nodes can connect.

        Raises:
            HubError: the hub cannot listen.
            RuntimeError: it is running already.
        """
        if self._thread is not None:
            raise RuntimeError(f"the hub at {self.url} is running already")
        self._ready.clear()
        self._thread = threading.Thread(target=self._run, name="hub", daemon=True)
        self._thread.start()
        self._ready.wait()
        if self._errors:
            self._thread = None
            raise self._errors.pop()

    def stop(self) -> None:
        """Stop the hub: its clients lose their connections. Does nothing when called again."""
        if self._thread is None:
            return
        if self._loop is not None and self._end is not None:
            self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join()
        self._thread = None

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *error: object) -> None:
        self.stop()

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:
            self._errors.append(error)
        finally:
            self._ready.set()

    async def _serve(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        async with HubServer(self._settings) as hub:
            self._settings = dataclasses.replace(self._settings, port=hub.port)
            self.url = hub.url
            self.master_uri = hub.ros1.uri if hub.ros1 is not None else ""
            self._ready.set()
            await self._end.wait()


@pytest.fixture
def hub_settings() -> Settings:
    """The settings of `hub`; override this fixture to change them."""
    return Settings(port=0, close_timeout=CLOSE_TIMEOUT)


@pytest.fixture
def hub(hub_settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Iterator[HubThread]:
    """A hub for this test alone, on a free port; $FIBWS_HUB is its address."""
    with HubThread(hub_settings) as hub:
        monkeypatch.setenv("FIBWS_HUB", hub.url)
        monkeypatch.delenv("ROS_NAMESPACE", raising=False)
        yield hub


@pytest_asyncio.fixture
async def node(hub: HubThread) -> AsyncIterator[fibws.Node]:
    """A node, ``/test``, to meet your own nodes with."""
    async with fibws.Node("test") as node:
        yield node


@asynccontextmanager
async def running(program: Coroutine[Any, Any, object]) -> AsyncIterator[None]:
    """Run a program, such as a node's ``main()``, while the block runs; then cancel it.

    Raises:
        Exception: the program failed. The block is cancelled then.
        TypeError: it is not a coroutine, such as when its parentheses are missing.
    """
    if not isinstance(program, Coroutine):
        raise TypeError(f"running takes a coroutine such as main(), got {program!r}")
    block = asyncio.current_task()
    assert block is not None
    is_failed = False

    def on_end(task: asyncio.Task[object]) -> None:
        nonlocal is_failed
        if not task.cancelled() and task.exception() is not None:
            is_failed = True
            block.cancel()

    task = asyncio.ensure_future(program)
    task.add_done_callback(on_end)
    try:
        yield
    except asyncio.CancelledError:
        if not is_failed:
            raise
        block.uncancel()
    finally:
        task.remove_done_callback(on_end)
        task.cancel()
        await asyncio.wait({task})
    if not task.cancelled() and (error := task.exception()) is not None:
        raise error


async def receive(
    subscription: fibws.Subscription[M], count: int, *, timeout: float = TIMEOUT
) -> list[M]:
    """Return the next ``count`` messages of a subscription.

    Args:
        timeout: most seconds to wait for all of them.

    Raises:
        WaitTimeout: fewer messages arrived.
        TypeError: it is not a subscription, such as a topic's name.
    """
    if not isinstance(subscription, fibws.Subscription):
        raise TypeError(f"receive takes what node.subscribe returns, got {subscription!r}")
    messages: list[M] = []
    try:
        async with asyncio.timeout(timeout) as limit:
            while len(messages) < count:
                messages.append(await anext(subscription))
    except TimeoutError:
        if not limit.expired():
            raise
        raise fibws.WaitTimeout(
            f"{len(messages)} of {count} messages on {subscription.topic} within {timeout:g} s"
        ) from None
    return messages


@overload
async def wait_until(condition: Callable[[], Awaitable[T]], *, timeout: float = TIMEOUT) -> T: ...


@overload
async def wait_until(condition: Callable[[], T], *, timeout: float = TIMEOUT) -> T: ...


async def wait_until(condition: Callable[[], Any], *, timeout: float = TIMEOUT) -> Any:
    """Wait until a condition holds, and return its value.

    Args:
        condition: a function, or an async one; it holds when its value is true.
        timeout: most seconds to wait.

    Raises:
        WaitTimeout: it did not hold in time.
        TypeError: it is not a function.
    """
    if not callable(condition):
        raise TypeError(f"wait_until takes a function such as lambda: x == 5, got {condition!r}")
    value: Any = None
    try:
        async with asyncio.timeout(timeout) as limit:
            while True:
                value = condition()
                if isawaitable(value):
                    value = await value
                if value:
                    return value
                await asyncio.sleep(INTERVAL)
    except TimeoutError:
        if not limit.expired():
            raise  # The condition's own.
        raise fibws.WaitTimeout(
            f"the condition did not hold within {timeout:g} s; its last value is {value!r}"
        ) from None


async def wait_for_node(node: fibws.Node, name: str, *, timeout: float = TIMEOUT) -> None:
    """Wait until a node of this name is connected, such as one in another process.

    Raises:
        WaitTimeout: it did not connect in time.
    """
    wanted = node.resolve(name)

    async def is_there() -> bool:
        return wanted in await node.graph.nodes()

    try:
        await wait_until(is_there, timeout=timeout)
    except fibws.WaitTimeout:
        raise fibws.WaitTimeout(f"node {wanted} did not connect within {timeout:g} s") from None


async def wait_for_subscribers(
    node: fibws.Node, topic: str, *, count: int = 1, timeout: float = TIMEOUT
) -> list[str]:
    """Wait until a topic has subscribers, so that no message is published too early.

    Returns:
        The global names of the nodes that subscribe.

    Raises:
        WaitTimeout: there were fewer than ``count`` in time.
    """
    return await _wait_for_ends(node.graph.subscribers, "subscribers", node, topic, count, timeout)


async def wait_for_publishers(
    node: fibws.Node, topic: str, *, count: int = 1, timeout: float = TIMEOUT
) -> list[str]:
    """Wait until a topic has publishers.

    Returns:
        The global names of the nodes that publish.

    Raises:
        WaitTimeout: there were fewer than ``count`` in time.
    """
    return await _wait_for_ends(node.graph.publishers, "publishers", node, topic, count, timeout)


async def _wait_for_ends(
    ends: Callable[[str], Awaitable[list[str]]],
    kind: str,
    node: fibws.Node,
    topic: str,
    count: int,
    timeout: float,
) -> list[str]:
    found: list[str] = []

    async def are_enough() -> bool:
        nonlocal found
        found = await ends(topic)
        return len(found) >= count

    try:
        await wait_until(are_enough, timeout=timeout)
    except fibws.WaitTimeout:
        raise fibws.WaitTimeout(
            f"{node.resolve(topic)} has {len(found)} of {count} {kind} after {timeout:g} s"
        ) from None
    return found
