"""Lets a thread act in an event loop's place while the loop sleeps.

To wake the loop for each message that is published would take more time than all the rest: a system
call, a switch of threads, and the wait for the interpreter's lock.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import asyncio


class Gate:
    """Is held by the loop while it runs, and open while it waits for what sockets bring.

    Signal handlers must not come between: what holds the gate would wait for them, and they for it.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._main_is_in = False
        self.admits_main = False
        """Whether the main thread may enter too: what a signal may break off would never leave."""
        self._deferred: list[Callable[[], object]] = []

    def new_loop(self) -> asyncio.AbstractEventLoop:
        """A loop that holds the gate, from now on until `close`."""
        import asyncio
        import selectors

        lock = self._lock

        class Selector(selectors.DefaultSelector):
            """Leaves the gate open while it waits."""

            def select(self, timeout: float | None = None) -> Any:
                lock.release()
                try:
                    return super().select(timeout)
                finally:
                    lock.acquire()

        lock.acquire()
        self._loop = asyncio.SelectorEventLoop(Selector())
        return self._loop

    def close(self) -> None:
        """Let nobody in any more; the loop has ended."""
        self._loop = None
        self._lock.release()

    def enter(self) -> bool:
        """Act in the loop's place until `leave`, if it sleeps; tell whether it does.

        What is scheduled meanwhile runs when the loop next wakes: who needs it has to wake it.
        """
        main = threading.current_thread() is threading.main_thread()
        if main:
            if self._main_is_in or not self.admits_main:
                return False
            self._main_is_in = True
        if self._lock.acquire(blocking=False):
            # A loop that looks for mistakes takes this for one.
            if self._loop is not None and not self._loop.get_debug():
                return True
            self._lock.release()
        if main:
            self._main_leaves()
        return False

    def leave(self) -> None:
        """Act in the loop's place no more."""
        self._lock.release()
        if threading.current_thread() is threading.main_thread():
            self._main_leaves()

    def after_leaving(self, function: Callable[[], object]) -> bool:
        """Have a function called once the main thread has left, for a signal's handler.

        False, and nothing else, if the main thread is not in.
        """
        if self._main_is_in:
            self._deferred.append(function)
        return self._main_is_in

    def _main_leaves(self) -> None:
        self._main_is_in = False
        while self._deferred:
            self._deferred.pop(0)()
