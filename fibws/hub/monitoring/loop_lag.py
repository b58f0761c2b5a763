"""How late the event loop is: the delay of a timer, measured a few times a second.

Whatever the loop does in one piece delays all clients alike. A timer that is due while the loop is
busy fires late by the rest of that piece.
"""

from __future__ import annotations

from collections.abc import Callable

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.graph.totals import Histogram

INTERVAL = 0.2
"""Seconds between two measurements."""
LAG_BUCKETS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)
"""Upper bounds in seconds."""


class LoopLag:
    """Measures how late timers are while it runs.

    Args:
        clock: the event loop.
        now: returns the seconds since some moment in the past. The loop's own time will not do: it
            may be that of the beginning of its turn.
    """

    def __init__(self, clock: Clock, now: Callable[[], float]) -> None:
        self.histogram = Histogram(LAG_BUCKETS)
        """The lags in seconds."""
        self._clock = clock
        self._now = now
        self._last = 0.0
        self._due = 0.0
        self._timer: Timer | None = None

    def start(self) -> None:
        """Begin to measure."""
        self._due = self._now() + INTERVAL
        self._timer = self._clock.call_later(INTERVAL, self._measure)

    def stop(self) -> None:
        """Stop measuring."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    @property
    def current(self) -> float:
        """The seconds by which the last timer was late, or the next one is already."""
        if self._timer is None:
            return self._last
        return max(self._last, self._now() - self._due)

    def _measure(self) -> None:
        self._last = max(0.0, self._now() - self._due)
        self.histogram.add(self._last)
        self.start()
