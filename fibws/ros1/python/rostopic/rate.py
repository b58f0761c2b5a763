"""The rate of messages that a script receives."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from time import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fibws.values.rates import Rate


class ROSTopicHz:
    """Measures the rates of topics by calls of `callback_hz`.

    Args:
        window_size: number of latest messages to measure; 50 000 if it is negative.
        filter_expr: returns whether to count a message; by default all are counted.
        use_wtime: use wall time even if time is simulated.
    """

    def __init__(
        self,
        window_size: int,
        filter_expr: Callable[[Any], object] | None = None,
        use_wtime: bool = False,
    ) -> None:
        self.lock = threading.Lock()
        self.filter_expr = filter_expr
        self.use_wtime = use_wtime
        self._window_size = window_size
        self._rates: dict[str | None, Rate] = {}

    def callback_hz(self, m: Any, topic: str | None = None) -> None:
        """Count a message that is received now."""
        import rospy

        if self.filter_expr is not None and not self.filter_expr(m):
            return
        now = time() if self.use_wtime else rospy.get_rostime().to_sec()
        if now:  # Simulated time has begun, if it is used.
            with self.lock:
                self._rate(topic).add(now)

    def get_hz(self, topic: str | None = None) -> tuple[float, float, float, float, int] | None:
        """Return the rate in Hz, the min, max and deviation of the intervals, and the count.

        Return None if there is no new message since the last call, or only one message so far.
        """
        with self.lock:
            polled = self._rate(topic).poll()
        if polled is None:
            return None
        rate, seconds, count = polled
        return rate, seconds.least, seconds.most, seconds.deviation, count

    def print_hz(self, topics: Sequence[str | None] = (None,)) -> None:
        """Print the rates of topics."""
        from fibws.values.rates import poll, rates_text

        with self.lock:
            polled = poll({str(topic): self._rate(topic) for topic in topics})
        print(rates_text(polled, len(topics)))

    def _rate(self, topic: str | None) -> Rate:
        from fibws.values.rates import MAX_WINDOW, Rate

        if topic not in self._rates:
            self._rates[topic] = Rate(self._window_size if self._window_size > 0 else MAX_WINDOW)
        return self._rates[topic]
