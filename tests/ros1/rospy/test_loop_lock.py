"""Other threads get the loop's lock while the loop sleeps, and only then."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator

import pytest
from rospy.loop_lock import LoopLock


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


def test_a_busy_loop_holds_the_lock(looping: Looping) -> None:
    over = looping.busy()
    assert not looping.lock.try_acquire()
    over.set()
    acquire(looping.lock)
    looping.lock.release()


def test_loop_waits_for_thread_with_the_lock(looping: Looping) -> None:
    ran = threading.Event()
    acquire(looping.lock)
    looping.loop.call_soon_threadsafe(ran.set)
    assert not ran.wait(0.02)
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
