"""The signals that end a program: one request, repeats of it, and the end at once."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
import threading
from typing import Any

import pytest
from patience import PATIENCE

from fibws.exit_signals import REPEAT, ExitSignals, exit_signals


class Program:
    """What the signals of a program have called, at a time that a test sets."""

    def __init__(self) -> None:
        self.now = 100.0
        self.calls: list[tuple[str, int]] = []
        self.ended = asyncio.Event()
        self.signals = ExitSignals(
            self.end,
            lambda number: self.calls.append(("again", number)),
            clock=lambda: self.now,
        )

    def end(self, number: int) -> None:
        self.calls.append(("end", number))
        self.ended.set()


def test_signals_within_a_second_are_one_request() -> None:
    program = Program()
    for number, seconds in ((2, 0.0), (2, 0.001), (15, REPEAT / 2), (2, REPEAT), (15, 5.0)):
        program.now = 100.0 + seconds
        program.signals.receive(number)
    assert program.calls == [("end", 2), ("again", 2), ("again", 15)]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
async def test_signals_reach_an_event_loop_until_they_are_removed(
    monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    program = Program()
    monkeypatch.setattr("fibws.exit_signals.exit_signals", lambda: (number,))
    before = signal.getsignal(number)
    loop = asyncio.get_running_loop()
    program.signals.install(loop)
    program.signals.remove(loop)
    assert signal.getsignal(number) is before
    program.signals.install(loop)
    signal.raise_signal(number)
    await program.ended.wait()
    program.signals.remove(loop)
    try:
        signal.raise_signal(number)  # It repeats the first one, and would end the tests.
    finally:
        signal.signal(number, before)
    assert program.calls == [("end", number)]


@pytest.mark.parametrize(
    ("handler", "ends"), [(signal.SIG_DFL, True), (signal.SIG_IGN, False), (lambda *_: None, False)]
)
def test_closed_terminal_ends_programs_that_neither_ignore_nor_handle_that(
    handler: Any, ends: bool
) -> None:
    earlier = signal.signal(signal.SIGHUP, handler)
    try:
        assert (signal.SIGHUP in exit_signals()) == ends
    finally:
        signal.signal(signal.SIGHUP, earlier)


def test_other_threads_get_no_signals() -> None:
    program = Program()
    before = signal.getsignal(signal.SIGINT)

    async def install() -> None:
        program.signals.install(asyncio.get_running_loop())
        program.signals.remove(asyncio.get_running_loop())

    thread = threading.Thread(target=lambda: asyncio.run(install()))
    thread.start()
    thread.join(PATIENCE)
    assert signal.getsignal(signal.SIGINT) is before


def test_end_at_once_says_what_is_left() -> None:
    program = """
import signal
from fibws.exit_signals import end_at_once, unfinished

with unfinished(lambda: "a was left"), unfinished(lambda: ""):
    with unfinished(lambda: "b was left"):
        pass
    end_at_once(signal.SIGINT)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE
    )
    assert (done.returncode, done.stderr) == (-signal.SIGINT, "a was left\n")


def test_two_ctrl_c_end_a_command_as_one_does() -> None:
    """``timeout -s INT`` sends the signal to the command and to its group."""
    program = """
import signal
import sys
import types

module = types.ModuleType("a_command")
sys.modules["a_command"] = module

def main():
    try:
        signal.raise_signal(signal.SIGINT)
    finally:
        signal.raise_signal(signal.SIGINT)
        print("cleaned up")

module.main = main
from fibws.__main__ import main
main("a_command")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "cleaned up\n", "")


def test_ctrl_c_that_python_ignores_in_a_callback_ends_the_command() -> None:
    """An import has such callbacks; a supervisor does not send the signal again."""
    program = """
import signal
import sys
import threading
import types
import weakref

module = types.ModuleType("a_command")
sys.modules["a_command"] = module

class It:
    pass

def main():
    it = It()
    reference = weakref.ref(it, lambda _: signal.raise_signal(signal.SIGINT))
    del it
    print("went on", flush=True)
    threading.Event().wait()

module.main = main
from fibws.__main__ import main
main("a_command")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "went on\n", "")
