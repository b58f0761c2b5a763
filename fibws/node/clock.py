"""A node's time, the system's or a simulated one, and the rates of its loops."""

from __future__ import annotations

import asyncio
import math
import time
from typing import ClassVar

from fibws.node.checks import is_number
from fibws.node.session import Session
from fibws.public_classes import AsyncIterable, made_by

CLOCK_QUEUE = 100
"""Length of the queue of /clock: with 1, as in ROS, the hub would drop the times of messages that
it sends together with later ones."""


class NodeClock:
    """Tells the node's time, and waits for it (http://wiki.ros.org/Clock).

    Args:
        session: the node's.

    Attributes:
        simulated: the simulated time in nanoseconds, 0 before the first message of /clock; None
            while the time is the system's. It is set in the node's loop, and read in any thread.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self.simulated: int | None = None
        self._waiting: set[asyncio.Future[None]] = set()

    def now(self) -> int:
        """Return the time in nanoseconds: since 1970, unless it is simulated."""
        return time.time_ns() if self.simulated is None else self.simulated

    def steady(self) -> float:
        """Return the seconds of a clock that is never set back, unless it is simulated."""
        if self.simulated is None:
            return asyncio.get_running_loop().time()
        return self.simulated / 1e9

    def set(self, now: int) -> None:
        """Set the simulated time, in nanoseconds."""
        self.simulated = now
        for waiting in self._waiting:
            if not waiting.done():
                waiting.set_result(None)

    async def ended(self, delay: float) -> bool:
        """Wait for the node's end, or for seconds to pass; return whether the node has ended.

        If simulated time is set back, the wait is over.

        Raises:
            Exception: what ended the node, if it was an error.
            RuntimeError: the node has not been entered.
        """
        if self.simulated is None or delay <= 0:
            return await self._session.ended(delay)
        last = now = self.simulated
        due = now + round(delay * 1e9)
        while last <= now < due:
            last = now
            waiting = asyncio.get_running_loop().create_future()
            self._waiting.add(waiting)
            try:
                if await self._session.ended(waiter=waiting):
                    return True
            finally:
                self._waiting.discard(waiting)
            now = self.simulated
        return self._session.over


class Schedule:
    """When the ticks of a rate are due, by rospy's rules: without drift.

    A loop that is late by more than two periods skips the missed ticks.
    """

    def __init__(self, hz: float) -> None:
        if not is_number(hz):
            raise TypeError(f"a rate must be a number (hertz), got {hz!r}")
        if not 0 < hz < math.inf:
            raise ValueError(f"a rate must be a finite number above 0 (hertz), got {hz!r}")
        self._period = 1 / hz
        self._due: float | None = None

    def delay(self, now: float) -> float:
        """Return the seconds from ``now`` to the next tick; the first one is due at once."""
        due = now if self._due is None else self._due + self._period
        if now - due > 2 * self._period:
            due = now
        due = min(due, now + self._period)  # Simulated time may be set back.
        self._due = due
        return max(0.0, due - now)


@made_by("Node.rate")
class Rate(AsyncIterable):
    """Ticks ``hz`` times a second until the node ends: ``async for _ in node.rate(10)``."""

    _other_names: ClassVar = {"sleep": "async for _ in node.rate(hz)"}

    def __init__(self, hz: float, clock: NodeClock) -> None:
        self._schedule = Schedule(hz)
        self._clock = clock

    def __aiter__(self) -> Rate:
        return self

    async def __anext__(self) -> None:
        # With a delay of 0, too: a loop that is always late must not starve other tasks.
        if await self._clock.ended(self._schedule.delay(self._clock.steady())):
            raise StopAsyncIteration
