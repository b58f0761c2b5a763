"""The process's one node, in a thread of its own."""

from __future__ import annotations

import asyncio
import inspect
import selectors
import sys
import threading
from collections.abc import AsyncIterator, Iterator
from typing import Any, NoReturn

import pytest
from patience import PATIENCE
from rospy.background import Background, LoopLock, Response
from rospy.exceptions import ROSException, ROSInterruptException

import fibws
from fibws import NodeClosed
from fibws.hub.server import HubServer


@pytest.fixture
def background() -> Iterator[Background]:
    background = Background()
    yield background
    background.stop()


@pytest.fixture
async def running(background: Background, hub: HubServer) -> AsyncIterator[Background]:
    """The node /worker runs."""
    await asyncio.to_thread(background.start, lambda: fibws.Node("worker", hub=hub.url), print)
    yield background
    await asyncio.to_thread(background.stop)


def test_node_is_an_error_before_start(background: Background) -> None:
    assert not background.running
    with pytest.raises(ROSException, match="Please call init_node"):
        _ = background.node
    assert not background.soon(print)
    for give in background.call, background.begin:
        with pytest.raises(ROSInterruptException):
            give(asyncio.sleep(0))


async def test_threads_can_call_the_node(running: Background) -> None:
    node = running.node
    assert node.name == "/worker"
    await asyncio.to_thread(running.call, node.params.set("~x", 5))
    future = await asyncio.to_thread(running.begin, node.params.get("~x"))
    assert await asyncio.wrap_future(future) == 5
    called = threading.Event()
    assert running.soon(called.set)
    assert await asyncio.to_thread(called.wait, 10)


async def test_error_of_a_call_is_raised(running: Background) -> None:
    async def fail() -> NoReturn:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        await asyncio.to_thread(running.call, fail())


async def test_call_is_cancelled_after_its_timeout(running: Background) -> None:
    started, cancelled = threading.Event(), threading.Event()

    async def wait() -> None:
        started.set()
        try:
            await asyncio.Event().wait()
        finally:
            cancelled.set()

    while not started.is_set():  # On a busy machine the time is over before the call begins.
        with pytest.raises(TimeoutError):
            await asyncio.to_thread(running.call, wait(), 0.01)
    assert await asyncio.to_thread(cancelled.wait, PATIENCE)


async def test_stop_interrupts_calls(running: Background) -> None:
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


async def test_node_ends_after_unfinished_tasks(running: Background) -> None:
    begun = threading.Event()
    results: list[str] = []

    async def send() -> None:
        assert running._stop is not None
        await running._stop.wait()
        for _ in range(5):
            await asyncio.sleep(0)
        await running.node.params.set("~sent", True)
        results.append("sent")

    def start() -> None:
        running.finish_before_end(asyncio.get_running_loop().create_task(send()))
        begun.set()

    assert running.soon(start)
    assert await asyncio.to_thread(begun.wait, 10)
    await asyncio.to_thread(running.stop)
    assert results == ["sent"]


async def test_end_of_the_node_is_reported(background: Background, hub: HubServer) -> None:
    errors: asyncio.Queue[Exception] = asyncio.Queue()
    loop = asyncio.get_running_loop()

    def ended(fault: Exception) -> None:
        loop.call_soon_threadsafe(errors.put_nowait, fault)

    def node() -> fibws.Node:
        return fibws.Node("worker", hub=hub.url)

    await asyncio.to_thread(background.start, node, ended)
    async with fibws.Node("worker", hub=hub.url):
        assert isinstance(await errors.get(), fibws.NodeReplaced)
        await asyncio.to_thread(background.stop)


def test_error_at_the_start_is_raised(background: Background) -> None:
    with pytest.raises(fibws.InvalidAddress):
        background.start(lambda: fibws.Node("worker", hub="http://x"), print)
    assert not background.running


def test_start_can_be_stopped_while_it_waits_for_the_hub(background: Background) -> None:
    waiting = threading.Event()

    def node() -> fibws.Node:
        waiting.set()
        return fibws.Node("worker", hub="ws://127.0.0.1:1")

    def stop() -> None:
        waiting.wait(60)
        background.stop()

    stopping = threading.Thread(target=stop)
    stopping.start()
    with pytest.raises(ROSInterruptException, match="rospy shutdown"):
        background.start(node, print)
    stopping.join(60)
    assert not stopping.is_alive()


def test_start_after_stop_is_interrupted(background: Background) -> None:
    background.stop()
    with pytest.raises(ROSInterruptException):
        background.start(lambda: fibws.Node("worker"), print)


async def test_coroutine_is_closed_if_the_loop_has_ended(running: Background) -> None:
    await asyncio.to_thread(running.stop)
    loop = asyncio.new_event_loop()
    running._loop = loop  # It takes what it is given, but nobody runs it any more.
    coroutine = asyncio.sleep(0)
    with pytest.raises(ROSInterruptException):
        await asyncio.to_thread(running.call, coroutine)
    assert inspect.getcoroutinestate(coroutine) == inspect.CORO_CLOSED
    loop.close()


async def test_give_way_waits_only_for_a_running_node(
    running: Background, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Patience(Exception):
        """Raised instead of a wait."""

    def join(timeout: float) -> None:
        raise Patience

    monkeypatch.setattr(running._thread, "join", join)
    with pytest.raises(Patience):
        running.give_way()
    monkeypatch.undo()
    await asyncio.to_thread(running.stop)
    running.give_way()
    Background().give_way()


# Responses


def lives() -> bool:
    return True


def died() -> bool:
    return False


async def error_of(response: Response[Any]) -> BaseException:
    """Return the error that a thread gets; a KeyboardInterrupt would end the test's loop."""

    def wait() -> BaseException:
        try:
            response.result(lives)
        except BaseException as error:
            return error
        raise AssertionError("there was no error")

    return await asyncio.to_thread(wait)


async def test_result_of_a_coroutine() -> None:
    response: Response[int] = Response()

    async def count() -> int:
        return 3

    response.execute(count())
    assert await asyncio.to_thread(response.result, lives) == 3


async def test_error_of_a_coroutine_is_raised() -> None:
    response: Response[int] = Response()

    async def fail() -> NoReturn:
        raise ZeroDivisionError("on purpose")

    response.execute(fail())
    assert repr(await error_of(response)) == "ZeroDivisionError('on purpose')"


@pytest.mark.parametrize(
    "error",
    [
        NodeClosed("the node has ended"),
        asyncio.CancelledError(),
        ROSInterruptException("rospy shutdown"),
    ],
)
async def test_end_of_the_node_interrupts_the_wait(error: BaseException) -> None:
    response: Response[int] = Response()

    async def fail() -> NoReturn:
        raise error

    response.execute(fail())
    assert repr(await error_of(response)) == "ROSInterruptException('rospy shutdown')"


async def test_coroutine_is_cancelled() -> None:
    response: Response[None] = Response()
    response.cancel()  # Nothing is begun yet.
    response.execute(asyncio.Event().wait())  # type: ignore[arg-type]
    response.cancel()
    assert isinstance(await error_of(response), ROSInterruptException)


def test_wait_ends_after_its_timeout() -> None:
    with pytest.raises(TimeoutError):
        Response().result(lives, timeout=0.01)


def test_wait_ends_with_the_loop() -> None:
    with pytest.raises(ROSInterruptException, match="rospy shutdown"):
        Response().result(died)
    response: Response[str] = Response()
    response.succeed("in time")
    assert response.result(died) == "in time"


# The loop's lock


class Looping:
    """A loop in a thread of its own that holds a lock while it is awake."""

    def __init__(self, *, debug: bool = False) -> None:
        self.lock = LoopLock()
        self.lock.allows_main_thread = True
        self._begun = threading.Event()
        self._debug = debug
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()
        assert self._begun.wait(60)

    def _run(self) -> None:
        self.loop = self.lock.new_loop()
        self.loop.set_debug(self._debug)
        self.loop.call_soon(self._begun.set)
        try:
            self.loop.run_forever()
        finally:
            self.loop.close()
            self.lock.close()

    @property
    def is_awake(self) -> bool:
        """Whether the loop is not in its selector, but runs, or waits for the lock."""
        assert self.thread.ident is not None
        frame = sys._current_frames()[self.thread.ident]
        return frame.f_code.co_filename != selectors.__file__

    def busy(self) -> threading.Event:
        """Keep the loop busy until the event that is returned is set."""
        begun, over = threading.Event(), threading.Event()

        def work() -> None:
            begun.set()
            over.wait(60)

        self.loop.call_soon_threadsafe(work)
        assert begun.wait(60)
        return over

    def stop(self) -> None:
        if self.thread.is_alive():
            self.loop.call_soon_threadsafe(self.loop.stop)
            self.thread.join(60)


@pytest.fixture
def looping() -> Iterator[Looping]:
    looping = Looping()
    yield looping
    looping.stop()


def acquire(lock: LoopLock) -> None:
    """Wait until the loop sleeps, and get its lock."""
    while not lock.try_acquire():
        pass


def test_busy_loop_holds_the_lock(looping: Looping) -> None:
    over = looping.busy()
    assert not looping.lock.try_acquire()
    over.set()
    acquire(looping.lock)
    looping.lock.release()


def test_loop_waits_for_thread_with_the_lock(looping: Looping) -> None:
    ran = threading.Event()
    acquire(looping.lock)
    looping.loop.call_soon_threadsafe(ran.set)
    while not looping.is_awake:
        assert not ran.is_set()
    assert not ran.is_set()
    looping.lock.release()
    assert ran.wait(60)


def test_only_one_thread_gets_the_lock(looping: Looping) -> None:
    others: list[bool] = []
    acquire(looping.lock)
    other = threading.Thread(target=lambda: others.append(looping.lock.try_acquire()))
    other.start()
    other.join(60)
    assert others == [False]
    assert not looping.lock.try_acquire(), "the same thread cannot have it twice"
    looping.lock.release()


def test_scheduled_callbacks_run_when_the_loop_is_woken(looping: Looping) -> None:
    ran = threading.Event()
    acquire(looping.lock)
    looping.loop.call_soon(ran.set)
    looping.lock.release()
    looping.loop.call_soon_threadsafe(lambda: None)
    assert ran.wait(60)


def test_signal_handler_is_deferred_until_main_thread_releases_the_lock(looping: Looping) -> None:
    called: list[str] = []
    lock = looping.lock
    assert not lock.defer(lambda: called.append("at once"))
    acquire(lock)
    assert lock.defer(lambda: called.append("1"))
    assert lock.defer(lambda: called.append("2"))
    assert called == []
    lock.release()
    assert called == ["1", "2"]
    over = looping.busy()
    assert not lock.try_acquire()
    assert not lock.defer(lambda: called.append("3"))
    over.set()


def test_main_thread_needs_permission(looping: Looping) -> None:
    acquire(looping.lock)
    looping.lock.release()
    looping.lock.allows_main_thread = False
    assert not any(looping.lock.try_acquire() for _ in range(1000))


def test_other_threads_need_no_permission(looping: Looping) -> None:
    looping.lock.allows_main_thread = False
    others: list[bool] = []

    def act() -> None:
        acquire(looping.lock)
        others.append(True)
        looping.lock.release()

    other = threading.Thread(target=act, daemon=True)
    other.start()
    other.join(60)
    assert others == [True]


def test_signal_handler_is_not_deferred_while_another_thread_has_the_lock(looping: Looping) -> None:
    inside, over = threading.Event(), threading.Event()

    def act() -> None:
        acquire(looping.lock)
        inside.set()
        over.wait(60)
        looping.lock.release()

    other = threading.Thread(target=act)
    other.start()
    assert inside.wait(60)
    assert not looping.lock.defer(lambda: None)
    over.set()
    other.join(60)


def test_lock_is_not_available_after_the_loop_has_ended(looping: Looping) -> None:
    looping.stop()
    assert not looping.lock.try_acquire()
    assert not LoopLock().try_acquire()


def test_lock_is_not_available_in_debug_mode() -> None:
    looping = Looping(debug=True)
    asleep = threading.Event()
    looping.loop.call_soon_threadsafe(asleep.set)
    assert asleep.wait(60)
    assert not any(looping.lock.try_acquire() for _ in range(1000))
    looping.stop()


async def test_loop_with_lock_serves_sockets() -> None:
    def converse() -> bytes:
        lock = LoopLock()
        loop = lock.new_loop()

        async def echo(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            writer.write(await reader.readline())
            writer.close()

        async def talk() -> bytes:
            async with await asyncio.start_server(echo, "127.0.0.1", 0) as server:
                reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
                writer.write(b"hello\n")
                heard = await reader.read()
                writer.close()
                await writer.wait_closed()
                return heard

        try:
            return loop.run_until_complete(talk())
        finally:
            loop.close()
            lock.close()

    assert await asyncio.to_thread(converse) == b"hello\n"
