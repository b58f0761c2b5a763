"""The latest messages of a filter."""

from __future__ import annotations

from collections import deque
from typing import Any

from message_filters.simple_filter import SimpleFilter
from message_filters.stamp import stamp_of


class Cache(SimpleFilter):
    """Keeps the latest messages of a filter, and lets them through.

    They are in the order in which they came, as their stamps should be, too.

    Args:
        f: the filter.
        cache_size: how many messages are kept.
        allow_headerless: whether messages without a header are of the time at which they come,
            rather than being left out with a warning.
    """

    def __init__(self, f: SimpleFilter, cache_size: int = 1, allow_headerless: bool = False):
        super().__init__()
        self.cache_size = cache_size
        self.allow_headerless = allow_headerless
        self._kept: deque[tuple[Any, Any]] = deque(maxlen=cache_size)
        self.connectInput(f)

    @property
    def cache_msgs(self) -> list[Any]:
        """The messages that are kept."""
        return [message for _, message in list(self._kept)]

    @property
    def cache_times(self) -> list[Any]:
        """Their times."""
        return [time for time, _ in list(self._kept)]

    def connectInput(self, f: SimpleFilter) -> None:
        """Keep the messages of a filter."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Keep a message."""
        stamp = stamp_of(msg, self.allow_headerless)
        if stamp is not None:
            self._kept.append((stamp, msg))
            self.signalMessage(msg)

    def getInterval(self, from_stamp: Any, to_stamp: Any) -> list[Any]:
        """The messages from one time to another, both included."""
        assert from_stamp <= to_stamp
        return [message for time, message in list(self._kept) if from_stamp <= time <= to_stamp]

    def getElemAfterTime(self, stamp: Any) -> Any:
        """The first message of this time or later; None if there is none."""
        return next((message for time, message in list(self._kept) if time >= stamp), None)

    def getElemBeforeTime(self, stamp: Any) -> Any:
        """The last message of this time or earlier; None if there is none."""
        return next(
            (message for time, message in reversed(list(self._kept)) if time <= stamp), None
        )

    def getLatestTime(self) -> Any:
        """The time of the last message; None if there is none."""
        return self._kept[-1][0] if self._kept else None

    def getLastestTime(self) -> Any:
        """The same, by the name that it once was misspelt."""
        return self.getLatestTime()

    def getOldestTime(self) -> Any:
        """The time of the first message; None if there is none."""
        return self._kept[0][0] if self._kept else None

    def getLast(self) -> Any:
        """The first message that is as late as the last one; None if there is none."""
        latest = self.getLatestTime()
        return None if latest is None else self.getElemAfterTime(latest)
