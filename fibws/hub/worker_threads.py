"""The hub's worker threads, for work that would block the event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

MOST_THREADS = 2
"""WorkerThreads that work at once: a robot's computer has other things to do."""


class WorkerThreads:
    """`Workers` in threads of their own, which exist once there was work.

    Args:
        most: how many work at once.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, most: int = MOST_THREADS) -> None:
        self._loop = loop
        self._most = most
        self._executor: ThreadPoolExecutor | None = None
        self._is_closed = False

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        """Call ``work`` in a thread and then ``done`` in the event loop; not after `close`."""
        if self._is_closed:
            return
        if self._executor is None:
            self._executor = ThreadPoolExecutor(self._most, "fibws-hub")
        self._executor.submit(self._perform, work, done)

    async def close(self) -> None:
        """Drop the work that has not begun, and wait for the work under way."""
        self._is_closed = True
        if self._executor is not None:
            await asyncio.to_thread(self._executor.shutdown, cancel_futures=True)

    def _perform(self, work: Callable[[], object], done: Callable[[], object]) -> None:
        work()
        with suppress(RuntimeError):  # The loop is closed.
            self._loop.call_soon_threadsafe(done)
