"""Wakes threads that wait for a condition.

`threading.Event` cannot be used: a signal handler runs in the main thread at any point, and would
wait for ever for the event's lock if the main thread held it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic

UNINTERRUPTED = 0.5
"""Most seconds of one wait: Windows handles signals only between waits, others interrupt them."""


class Wakeup:
    """Makes threads check their conditions again; signal handlers may use it, too."""

    def __init__(self) -> None:
        self._sleepers: list[threading.Lock] = []

    def wake_all(self) -> None:
        """Make all waiting threads check their conditions."""
        for sleeper in list(self._sleepers):
            with suppress(RuntimeError):  # It was woken just before.
                sleeper.release()

    def wait(self, condition: Callable[[], bool], timeout: float | None = None) -> bool:
        """Wait until ``condition()`` is true, which is checked first and at each `wake_all`.

        Args:
            condition: the condition.
            timeout: most seconds to wait.

        Returns:
            Whether the condition was true.
        """
        end = None if timeout is None else monotonic() + timeout
        sleeper = threading.Lock()
        sleeper.acquire()
        self._sleepers.append(sleeper)
        try:
            while not condition():
                left = UNINTERRUPTED if end is None else min(UNINTERRUPTED, end - monotonic())
                if left <= 0:
                    return False
                sleeper.acquire(timeout=left)
            return True
        finally:
            self._sleepers.remove(sleeper)
