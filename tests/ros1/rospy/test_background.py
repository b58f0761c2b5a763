"""The process's one node, in a thread of its own."""

from __future__ import annotations

import asyncio
import inspect
import threading
import time
from collections.abc import AsyncIterator, Iterator
from typing import NoReturn

import pytest
from rospy.background import Background
from rospy.exceptions import ROSException, ROSInterruptException

import fibws
from fibws.hub import Hub


@pytest.fixture
def background() -> Iterator[Background]:
    background = Background()
    yield background
    background.stop()


@pytest.fixture
async def running(background: Background, hub: Hub) -> AsyncIterator[Background]:
    """The node /worker runs."""
    await asyncio.to_thread(background.start, lambda: fibws.Node("worker", hub=hub.url), print)
    yield background
    await asyncio.to_thread(background.stop)


def test_before_its_start_there_is_no_node(background: Background) -> None:
    assert not background.running
    with pytest.raises(ROSException, match="Please call init_node"):
        _ = background.node
    assert not background.soon(print)
    for give in background.call, background.begin:
        with pytest.raises(ROSInterruptException):
            give(asyncio.sleep(0))


async def test_any_thread_can_ask_the_node(running: Background) -> None:
    node = running.node
    assert node.name == "/worker"
    await asyncio.to_thread(running.call, node.params.set("~x", 5))
    future = await asyncio.to_thread(running.begin, node.params.get("~x"))
    assert await asyncio.wrap_future(future) == 5
    called = threading.Event()
    assert running.soon(called.set)
    assert await asyncio.to_thread(called.wait, 10)


async def test_what_the_coroutine_raises_is_raised(running: Background) -> None:
    async def fail() -> NoReturn:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        await asyncio.to_thread(running.call, fail())


async def test_what_takes_too_long_is_cancelled(running: Background) -> None:
    cancelled = threading.Event()

    async def wait() -> None:
        try:
            await asyncio.Event().wait()
        finally:
            cancelled.set()

    with pytest.raises(TimeoutError):
        await asyncio.to_thread(running.call, wait(), 0.01)
    assert await asyncio.to_thread(cancelled.wait, 10)


async def test_its_end_ends_what_is_under_way(running: Background) -> None:
    begun = threading.Event()

    async def wait() -> None:
        begun.set()
        await asyncio.Event().wait()

    def interrupted() -> bool:
        with pytest.raises(ROSInterruptException, match="rospy shutdown"):
            running.call(wait())
        return True

    waiting = asyncio.create_task(asyncio.to_thread(interrupted))
    await asyncio.to_thread(begun.wait, 10)
    await asyncio.to_thread(running.stop)
    assert await waiting
    with pytest.raises(ROSInterruptException):
        running.call(asyncio.sleep(0))
    with pytest.raises(ROSInterruptException):
        running.begin(asyncio.sleep(0))
    assert not running.soon(print)


async def test_it_tells_what_has_ended_the_node(background: Background, hub: Hub) -> None:
    told: asyncio.Queue[Exception] = asyncio.Queue()
    loop = asyncio.get_running_loop()

    def ended(fault: Exception) -> None:
        loop.call_soon_threadsafe(told.put_nowait, fault)

    def node() -> fibws.Node:
        return fibws.Node("worker", hub=hub.url)

    await asyncio.to_thread(background.start, node, ended)
    async with fibws.Node("worker", hub=hub.url):
        assert isinstance(await told.get(), fibws.NodeReplaced)
        await asyncio.to_thread(background.stop)


def test_what_the_node_raises_at_first_is_raised(background: Background) -> None:
    with pytest.raises(fibws.InvalidAddress):
        background.start(lambda: fibws.Node("worker", hub="http://x"), print)
    assert not background.running


def test_it_can_be_stopped_while_it_waits_for_its_hub(background: Background) -> None:
    waiting = threading.Event()

    def node() -> fibws.Node:
        waiting.set()
        return fibws.Node("worker", hub="ws://127.0.0.1:1")

    def stop() -> None:
        waiting.wait(60)
        background.stop()

    stopping = threading.Thread(target=stop)
    stopping.start()
    began = time.monotonic()
    with pytest.raises(ROSInterruptException, match="rospy shutdown"):
        background.start(node, print)
    stopping.join(60)
    assert time.monotonic() - began < 10


def test_it_can_be_stopped_before_its_start(background: Background) -> None:
    background.stop()
    with pytest.raises(ROSInterruptException):
        background.start(lambda: fibws.Node("worker"), print)


async def test_what_the_loops_end_has_forestalled_is_closed(running: Background) -> None:
    await asyncio.to_thread(running.stop)
    loop = asyncio.new_event_loop()
    running._loop = loop  # It takes what it is given, but nobody runs it any more.
    coroutine = asyncio.sleep(0)
    with pytest.raises(ROSInterruptException):
        await asyncio.to_thread(running.call, coroutine)
    assert inspect.getcoroutinestate(coroutine) == inspect.CORO_CLOSED
    loop.close()


async def test_who_gives_way_waits_for_a_node_that_runs_and_for_no_other(
    running: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Patience(Exception):
        """It would wait."""

    def join(timeout: float) -> None:
        raise Patience

    monkeypatch.setattr(running._thread, "join", join)
    with pytest.raises(Patience):
        running.give_way()
    monkeypatch.undo()
    await asyncio.to_thread(running.stop)
    running.give_way()
    Background().give_way()
