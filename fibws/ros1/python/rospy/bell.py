"""What wakes the threads that sleep.

`threading.Event` would not do: a signal's handler runs in the main thread, wherever that is, and
would wait for ever for a lock that the main thread was just holding.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic

UNINTERRUPTED = 0.5
"""Seconds for which nobody looks at signals, which Windows needs; elsewhere they interrupt."""


class Bell:
    """May be rung anywhere, even in a signal's handler, and any number of times."""

    def __init__(self) -> None:
        self._sleepers: list[threading.Lock] = []

    def ring(self) -> None:
        """Have all who wait look again at what they wait for."""
        for sleeper in list(self._sleepers):
            with suppress(RuntimeError):  # It was woken just before.
                sleeper.release()

    def wait(self, over: Callable[[], bool], timeout: float | None = None) -> bool:
        """Wait until ``over()``, which is asked at first and each time that the bell rings.

        Args:
            over: tells whether the waiting is over.
            timeout: the most seconds to wait.

        Returns:
            What ``over`` said last.
        """
        end = None if timeout is None else monotonic() + timeout
        sleeper = threading.Lock()
        sleeper.acquire()
        self._sleepers.append(sleeper)
        try:
            while not over():
                left = UNINTERRUPTED if end is None else min(UNINTERRUPTED, end - monotonic())
                if left <= 0:
                    return False
                sleeper.acquire(timeout=left)
            return True
        finally:
            self._sleepers.remove(sleeper)
