"""How often messages come, in a script that hears them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from time import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fibws.cli.topic.hz import Rate


class ROSTopicHz:
    """The rates of topics, by the messages that `callback_hz` is given.

    Args:
        window_size: how many of the newest messages count; below 0, 50 000.
        filter_expr: which messages count; by default all.
        use_wtime: whether time is the machine's even if it is simulated.
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
        """Take note that a message has come; of several topics each is named."""
        import rospy

        if self.filter_expr is not None and not self.filter_expr(m):
            return
        now = time() if self.use_wtime else rospy.get_rostime().to_sec()
        if now:  # Else simulated time has yet to begin.
            with self.lock:
                self._rate(topic).take(now)

    def get_hz(self, topic: str | None = None) -> tuple[float, float, float, float, int] | None:
        """The rate in Hz; the least, the most and the deviation of the seconds between; the count.

        None if no message has come since this was asked, or none but one.
        """
        with self.lock:
            news = self._rate(topic).news()
        if news is None:
            return None
        rate, seconds, count = news
        return rate, seconds.least, seconds.most, seconds.deviation, count

    def print_hz(self, topics: Sequence[str | None] = (None,)) -> None:
        """Print the rates of topics."""
        from fibws.cli.topic.hz import show

        with self.lock:
            show({str(topic): self._rate(topic) for topic in topics})

    def _rate(self, topic: str | None) -> Rate:
        from fibws.cli.topic.hz import Rate
        from fibws.cli.topic.window import MOST

        if topic not in self._rates:
            self._rates[topic] = Rate(self._window_size if self._window_size > 0 else MOST)
        return self._rates[topic]
