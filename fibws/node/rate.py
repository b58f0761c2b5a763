"""Rates: loops that run a number of times per second."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable


class Schedule:
    """When the ticks of a rate are due, by rospy's rules: without drift.

    A loop that is late by more than two periods skips the missed ticks.
    """

    def __init__(self, hz: float) -> None:
        if not 0 < hz < math.inf:
            raise ValueError(f"a rate must be a finite number above 0 (hertz), got {hz!r}")
        self._period = 1 / hz
        self._due: float | None = None

    def delay(self, now: float) -> float:
        """Return the seconds from ``now`` to the next tick; the first one is due at once."""
        due = now if self._due is None else self._due + self._period
        if now - due > 2 * self._period:
            due = now
        self._due = due
        return max(0.0, due - now)


class Rate:
    """Ticks ``hz`` times a second until the node ends: ``async for _ in node.rate(10)``."""

    def __init__(self, hz: float, ended: Callable[[float], Awaitable[bool]]) -> None:
        self._schedule = Schedule(hz)
        self._ended = ended

    def __aiter__(self) -> Rate:
        return self

    async def __anext__(self) -> None:
        # With a delay of 0, too: a loop that is always late must not starve other tasks.
        if await self._ended(self._schedule.delay(asyncio.get_running_loop().time())):
            raise StopAsyncIteration
