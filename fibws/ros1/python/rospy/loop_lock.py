"""A lock that an event loop holds while it is awake; it is free while the loop sleeps.

A thread that gets the lock may use the loop's objects itself. Waking the loop for each message that
a script publishes would cost a system call, two switches of threads, and waits for the
interpreter's lock: about a quarter of the latency and of the CPU time of small messages.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import asyncio


class LoopLock:
    """Held by the loop while it runs callbacks, and free while it waits for its sockets.

    A signal handler must not run in a thread that holds the lock: it may wait for the loop, which
    waits for the lock.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._main_has_it = False
        self.allows_main_thread = False
        """Whether the main thread may take the lock, too. It may if all signal handlers use
        `defer`: an exception raised by a handler could leave the lock held for ever."""
        self._deferred: list[Callable[[], object]] = []

    def new_loop(self) -> asyncio.AbstractEventLoop:
        """Return a new event loop, and hold the lock for it until `close`."""
        import asyncio
        import selectors

        lock = self._lock

        class Selector(selectors.DefaultSelector):
            """Releases the lock while it waits."""

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
        """Give the lock to nobody any more: the loop has ended."""
        self._loop = None
        self._lock.release()

    def try_acquire(self) -> bool:
        """Take the lock until `release` if the loop sleeps; return whether it does.

        Callbacks that are scheduled meanwhile run when the loop wakes up next: wake it if they must
        not wait.
        """
        main = threading.current_thread() is threading.main_thread()
        if main:
            if self._main_has_it or not self.allows_main_thread:
                return False
            self._main_has_it = True
        if self._lock.acquire(blocking=False):
            # A loop in debug mode refuses calls from other threads.
            if self._loop is not None and not self._loop.get_debug():
                return True
            self._lock.release()
        if main:
            self._released_by_main()
        return False

    def release(self) -> None:
        """Release the lock after `try_acquire`."""
        self._lock.release()
        if threading.current_thread() is threading.main_thread():
            self._released_by_main()

    def defer(self, function: Callable[[], object]) -> bool:
        """Call a function once the main thread has released the lock; for signal handlers.

        Return False, and do nothing, if the main thread does not hold it.
        """
        if self._main_has_it:
            self._deferred.append(function)
        return self._main_has_it

    def _released_by_main(self) -> None:
        self._main_has_it = False
        while self._deferred:
            self._deferred.pop(0)()
