"""What a node has under way beside the program's own doing."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any


class Tasks:
    """Tasks that run until they are done, or until their owner cancels them.

    Args:
        within: the tasks of which these are a part.
    """

    def __init__(self, within: Tasks | None = None) -> None:
        self._within = within
        self._tasks: set[asyncio.Task[None]] = set()

    def __len__(self) -> int:
        return len(self._tasks)

    def start(self, coroutine: Coroutine[Any, Any, None], name: str) -> asyncio.Task[None]:
        """Begin a task; the coroutine sees to its own errors."""
        task = asyncio.create_task(coroutine, name=name)
        self._add(task)
        return task

    def cancel(self) -> None:
        """Cancel all tasks, but for the one that asks for it: that ends by itself."""
        for task in self._others():
            task.cancel()

    async def finished(self) -> None:
        """Wait until no task is left but the one that asks."""
        while others := self._others():
            await asyncio.wait(others)

    def _add(self, task: asyncio.Task[None]) -> None:
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        if self._within is not None:
            self._within._add(task)

    def _others(self) -> set[asyncio.Task[None]]:
        return self._tasks - {asyncio.current_task()} if self._tasks else set()
