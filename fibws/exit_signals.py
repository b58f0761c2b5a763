"""The signals that end a program: Ctrl-C (SIGINT), SIGTERM, and SIGHUP of a closed terminal.

The first one ends the program in order. Others within a second change nothing: ``timeout -s INT``
and supervisors send it to a process and to its group, which are two signals for one request. A
later one ends the program at once, with the status of that signal, and says what was left.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop

REPEAT = 1.0
"""Seconds after the first signal in which others are the same request."""
AGAIN = 0.01
"""Seconds after which an interrupt that Python has ignored is raised again."""

_unfinished: dict[object, Callable[[], str]] = {}


@contextmanager
def unfinished(text: Callable[[], str]) -> Iterator[None]:
    """Print a text if a signal ends the program at once within the block.

    Args:
        text: returns what is left then, and how to mend it; empty for nothing.
    """
    key = object()
    _unfinished[key] = text
    try:
        yield
    finally:
        del _unfinished[key]


def exit_signals() -> tuple[int, ...]:
    """Return the signals that end a program.

    SIGHUP is one of them unless the program handles it, or ignores it, as under ``nohup``.
    """
    numbers: tuple[int, ...] = (signal.SIGINT, signal.SIGTERM)
    if sys.platform != "win32" and signal.getsignal(signal.SIGHUP) == signal.SIG_DFL:
        numbers = (*numbers, signal.SIGHUP)
    return numbers


def end_at_once(number: int) -> None:
    """End the process with the status of a signal, and say what was left."""
    for text in list(_unfinished.values()):
        if sys.stderr is not None and (line := text()):
            with suppress(OSError, ValueError):
                print(line, file=sys.stderr, flush=True)
    if sys.platform != "win32":
        signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {number})
        os.kill(os.getpid(), number)
    os._exit(128 + number)


class ExitSignals:
    """Receives the signals that end a program.

    Args:
        end: called at the first one with its number.
        again: called at each one that comes later than `REPEAT` after the first.
    """

    def __init__(
        self,
        end: Callable[[int], object],
        again: Callable[[int], object] = end_at_once,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._end = end
        self._again = again
        self._clock = clock
        self._first: float | None = None
        self._earlier: dict[int, Any] = {}

    def receive(self, number: int, frame: object = None) -> None:
        """Handle a signal; this is a handler for `signal.signal`, too."""
        now = self._clock()
        if self._first is None:
            self._first = now
            self._end(number)
        elif now - self._first >= REPEAT:
            self._again(number)

    def forget(self) -> None:
        """Take the next signal as the first one."""
        self._first = None

    def install(self, loop: AbstractEventLoop, numbers: Iterable[int] | None = None) -> None:
        """Receive signals in an event loop; in the main thread only, elsewhere do nothing.

        Args:
            numbers: of the signals, by default `exit_signals`.
        """

        def receive(number: int, frame: object = None) -> None:
            loop.call_soon_threadsafe(self.receive, number)

        for number in exit_signals() if numbers is None else numbers:
            with suppress(RuntimeError, ValueError):  # Another thread may not set handlers.
                earlier = signal.getsignal(number)
                try:
                    loop.add_signal_handler(number, self.receive, number)
                except NotImplementedError:  # as on Windows
                    signal.signal(number, receive)
                self._earlier[number] = earlier

    def receive_directly(self) -> None:
        """Receive the signals that follow without the event loop, which may be blocked."""
        for number in self._earlier:
            signal.signal(number, self.receive)

    def remove(self, loop: AbstractEventLoop) -> None:
        """Restore the earlier handlers; after a signal, only once `REPEAT` is over."""
        for number, earlier in self._earlier.items():
            with suppress(NotImplementedError, RuntimeError):
                loop.remove_signal_handler(number)
            signal.signal(number, self._restored if self._first is not None else earlier)

    def _restored(self, number: int, frame: Any) -> None:
        """Ignore a signal that repeats the first one; handle others as before `install`."""
        if self._first is not None and self._clock() - self._first < REPEAT:
            return
        earlier = self._earlier[number]
        signal.signal(number, earlier if earlier is not None else signal.SIG_DFL)
        if callable(earlier):
            earlier(number, frame)
        elif earlier != signal.SIG_IGN:
            end_at_once(number)


def interrupt_once() -> None:
    """Have the first Ctrl-C raise KeyboardInterrupt, and handle others as all programs do.

    Python ignores exceptions in some places, such as the callbacks of weak references while modules
    are imported: it is raised again until it is not ignored, as a supervisor sends only one signal.

    For commands without an event loop; in the main thread only.
    """

    def raise_interrupt(number: int) -> None:
        raise KeyboardInterrupt

    def raise_again(unraisable: Any) -> None:
        if unraisable.exc_type is not KeyboardInterrupt:
            earlier(unraisable)
            return
        signals.forget()
        # Not from here: this is where exceptions are ignored.
        _thread.start_new_thread(interrupt_later, ())

    def interrupt_later() -> None:
        time.sleep(AGAIN)
        if sys.platform == "win32":
            _thread.interrupt_main()
        else:
            signal.pthread_kill(main, signal.SIGINT)  # It ends a wait of the thread, too.

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        with suppress(ValueError):
            main = _thread.get_ident()
            signals = ExitSignals(raise_interrupt)
            signal.signal(signal.SIGINT, signals.receive)
            earlier, sys.unraisablehook = sys.unraisablehook, raise_again
