"""Another thread acts for the loop while that sleeps, and never otherwise."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator

import pytest
from rospy.gate import Gate


class Looping:
    """A loop in a thread of its own, behind a gate."""

    def __init__(self, *, debug: bool = False) -> None:
        self.gate = Gate()
        self.gate.admits_main = True
        self._begun = threading.Event()
        self._debug = debug
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()
        assert self._begun.wait(60)

    def _run(self) -> None:
        self.loop = self.gate.new_loop()
        self.loop.set_debug(self._debug)
        self.loop.call_soon(self._begun.set)
        try:
            self.loop.run_forever()
        finally:
            self.loop.close()
            self.gate.close()

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


def entered(gate: Gate) -> None:
    """Wait until the loop sleeps, and act for it."""
    while not gate.enter():
        pass


def test_nobody_acts_for_a_loop_that_is_busy(looping: Looping) -> None:
    over = looping.busy()
    assert not looping.gate.enter()
    over.set()
    entered(looping.gate)
    looping.gate.leave()


def test_the_loop_waits_for_who_acts_for_it(looping: Looping) -> None:
    ran = threading.Event()
    entered(looping.gate)
    looping.loop.call_soon_threadsafe(ran.set)
    assert not ran.wait(0.02)
    looping.gate.leave()
    assert ran.wait(60)


def test_only_one_thread_acts_for_it(looping: Looping) -> None:
    others: list[bool] = []
    entered(looping.gate)
    other = threading.Thread(target=lambda: others.append(looping.gate.enter()))
    other.start()
    other.join(60)
    assert others == [False]
    assert not looping.gate.enter(), "nor does the same one twice"
    looping.gate.leave()


def test_what_is_scheduled_meanwhile_runs_when_the_loop_is_woken(looping: Looping) -> None:
    ran = threading.Event()
    entered(looping.gate)
    looping.loop.call_soon(ran.set)
    looping.gate.leave()
    looping.loop.call_soon_threadsafe(lambda: None)
    assert ran.wait(60)


def test_a_signals_handler_comes_after_the_main_thread_has_left(looping: Looping) -> None:
    called: list[str] = []
    gate = looping.gate
    assert not gate.after_leaving(lambda: called.append("at once"))
    entered(gate)
    assert gate.after_leaving(lambda: called.append("1"))
    assert gate.after_leaving(lambda: called.append("2"))
    assert called == []
    gate.leave()
    assert called == ["1", "2"]
    over = looping.busy()
    assert not gate.enter()
    assert not gate.after_leaving(lambda: called.append("3"))
    over.set()


def test_a_main_thread_that_signals_may_break_off_stays_outside(looping: Looping) -> None:
    entered(looping.gate)
    looping.gate.leave()
    looping.gate.admits_main = False
    assert not any(looping.gate.enter() for _ in range(1000))


def test_other_threads_are_admitted_when_the_main_thread_is_not(looping: Looping) -> None:
    looping.gate.admits_main = False
    others: list[bool] = []

    def act() -> None:
        entered(looping.gate)
        others.append(True)
        looping.gate.leave()

    other = threading.Thread(target=act, daemon=True)
    other.start()
    other.join(60)
    assert others == [True]


def test_other_threads_are_no_concern_of_signal_handlers(looping: Looping) -> None:
    inside, over = threading.Event(), threading.Event()

    def act() -> None:
        entered(looping.gate)
        inside.set()
        over.wait(60)
        looping.gate.leave()

    other = threading.Thread(target=act)
    other.start()
    assert inside.wait(60)
    assert not looping.gate.after_leaving(lambda: None)
    over.set()
    other.join(60)


def test_after_the_loop_s_end_nobody_gets_in(looping: Looping) -> None:
    looping.stop()
    assert not looping.gate.enter()
    assert not Gate().enter()


def test_a_loop_that_looks_for_mistakes_is_left_alone() -> None:
    looping = Looping(debug=True)
    asleep = threading.Event()
    looping.loop.call_soon_threadsafe(asleep.set)
    assert asleep.wait(60)
    assert not any(looping.gate.enter() for _ in range(1000))
    looping.stop()


async def test_a_loop_behind_a_gate_does_what_loops_do() -> None:
    def converse() -> bytes:
        gate = Gate()
        loop = gate.new_loop()

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
            gate.close()

    assert await asyncio.to_thread(converse) == b"hello\n"
