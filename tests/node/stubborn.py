"""Handlers that go on when they are cancelled, such as while a driver does not answer."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import Any


class Stubborn:
    """A handler that ends when the test frees it, and not before."""

    def __init__(self) -> None:
        self.begun = asyncio.Event()
        self._free = asyncio.Event()
        self._task: asyncio.Task[Any] | None = None

    async def __call__(self, request: Any) -> Any:
        self._task = asyncio.current_task()
        self.begun.set()
        while not self._free.is_set():
            with suppress(asyncio.CancelledError):
                await self._free.wait()
        return {}

    async def ends(self) -> None:
        """Let it end, and wait until it has."""
        self._free.set()
        assert self._task is not None
        await asyncio.wait({self._task})
