"""Filters between a subscription and a callback: http://wiki.ros.org/message_filters.

Subscriber ─┬─ Cache                            keeps the latest messages
            └─ TimeSynchronizer                 matches messages with equal stamps
               └─ ApproximateTimeSynchronizer   ... or with similar stamps
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable
from itertools import product
from typing import Any

import rospy

__all__ = [
    "ApproximateTimeSynchronizer",
    "Cache",
    "SimpleFilter",
    "Subscriber",
    "TimeSynchronizer",
]


class SimpleFilter:
    """The base of all filters: passes its output to callbacks in the order of registration."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., object], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., object], *args: Any) -> int:
        """Call a function with the filter's output, followed by ``args``.

        Returns:
            The number of the callback, its key in ``callbacks``.
        """
        number = len(self.callbacks)
        self.callbacks[number] = (cb, args)
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Pass a message, or a set of matching messages, to the callbacks."""
        for callback, args in list(self.callbacks.values()):
            callback(*msg, *args)


class Subscriber(SimpleFilter):
    """Outputs all messages of a topic.

    Args:
        args: the arguments of `rospy.Subscriber`, except the callback.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.topic = args[0] if args else kwargs["name"]
        self.sub = rospy.Subscriber(*args, **{**kwargs, "callback": self.callback})

    def callback(self, msg: Any) -> None:
        """Output a message."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """Return the topic's name as it was given."""
        return str(self.topic)

    def __getattr__(self, key: str) -> Any:
        """Return an attribute of the `rospy.Subscriber`, such as ``unregister``."""
        if key == "sub":  # Creating it failed.
            raise AttributeError(key)
        return getattr(self.sub, key)


class Cache(SimpleFilter):
    """Outputs all messages of a filter, and keeps the latest.

    They are kept in the order of arrival, which should be that of their stamps.

    Args:
        f: the filter.
        cache_size: maximum number of messages to keep.
        allow_headerless: give messages without a header the time of their arrival; otherwise they
            are dropped with a warning.
    """

    def __init__(self, f: SimpleFilter, cache_size: int = 1, allow_headerless: bool = False):
        super().__init__()
        self.cache_size = cache_size
        self.allow_headerless = allow_headerless
        self._kept: deque[tuple[Any, Any]] = deque(maxlen=cache_size)
        self.connectInput(f)

    @property
    def cache_msgs(self) -> list[Any]:
        """The messages."""
        return [message for _, message in list(self._kept)]

    @property
    def cache_times(self) -> list[Any]:
        """The times of the messages."""
        return [time for time, _ in list(self._kept)]

    def connectInput(self, f: SimpleFilter) -> None:
        """Keep the messages of a filter."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Keep and output a message."""
        stamp = _stamp(msg, self.allow_headerless)
        if stamp is not None:
            self._kept.append((stamp, msg))
            self.signalMessage(msg)

    def getInterval(self, from_stamp: Any, to_stamp: Any) -> list[Any]:
        """Return the messages from one time to another, both included."""
        assert from_stamp <= to_stamp
        return [message for time, message in list(self._kept) if from_stamp <= time <= to_stamp]

    def getElemAfterTime(self, stamp: Any) -> Any:
        """Return the first message of this time or later, or None."""
        return next((message for time, message in list(self._kept) if time >= stamp), None)

    def getElemBeforeTime(self, stamp: Any) -> Any:
        """Return the last message of this time or earlier, or None."""
        return next(
            (message for time, message in reversed(list(self._kept)) if time <= stamp), None
        )

    def getLatestTime(self) -> Any:
        """Return the time of the last message, or None."""
        return self._kept[-1][0] if self._kept else None

    def getLastestTime(self) -> Any:
        """Return the same; the method's former, misspelled name."""
        return self.getLatestTime()

    def getOldestTime(self) -> Any:
        """Return the time of the first message, or None."""
        return self._kept[0][0] if self._kept else None

    def getLast(self) -> Any:
        """Return the first message whose time is that of the last one, or None."""
        latest = self.getLatestTime()
        return None if latest is None else self.getElemAfterTime(latest)


class TimeSynchronizer(SimpleFilter):
    """Outputs a message of each filter as soon as all have one with the same stamp.

    Callbacks get the messages in the order of the filters, one set at a time.

    Args:
        fs: the filters.
        queue_size: maximum number of messages of each filter to keep; more drop the oldest.
        reset: drop all messages when simulated time goes back.
    """

    def __init__(self, fs: Iterable[SimpleFilter], queue_size: int, reset: bool = False) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.enable_reset = reset
        self.lock = threading.Lock()
        self.connectInput(list(fs))

    def connectInput(self, fs: list[SimpleFilter]) -> None:
        """Synchronize the messages of these filters."""
        self.queues: list[dict[Any, Any]] = [{} for _ in fs]
        self.latest_stamps = [rospy.Time(0) for _ in fs]
        self.input_connections = [
            filter_.registerCallback(self.add, queue, index)
            for index, (filter_, queue) in enumerate(zip(fs, self.queues, strict=True))
        ]

    def add(self, msg: Any, my_queue: dict[Any, Any], my_queue_index: int | None = None) -> None:
        """Add a message of one of the filters.

        Args:
            my_queue: the filter's queue, one of ``queues``.
            my_queue_index: its index there.
        """
        with self.lock:
            if self._keep(msg.header.stamp, msg, my_queue, my_queue_index):
                common = set.intersection(*map(set, self.queues))
                for stamp in sorted(common):
                    self._output([stamp] * len(self.queues))

    def _keep(self, stamp: Any, message: Any, queue: dict[Any, Any], index: int | None) -> bool:
        """Queue a message; return whether the others may be matched with it."""
        now = rospy.Time.now()
        resetting = self.enable_reset and not rospy.rostime.is_wallclock()
        if resetting and index is not None:
            if now < self.latest_stamps[index]:
                rospy.logdebug("Detected jump back in time. Clearing message filter queue")
                queue.clear()
            self.latest_stamps[index] = now
        queue[stamp] = message
        self._check_time(now)
        while len(queue) > self.queue_size:
            del queue[min(queue)]
        # After a jump back, the queues of the other filters are outdated until their next message.
        return not resetting or max(self.latest_stamps) == now

    def _check_time(self, now: Any) -> None:
        """Check whether time went back since the last message."""

    def _output(self, stamps: list[Any]) -> None:
        """Output the messages with these stamps, one of each filter."""
        pairs = list(zip(self.queues, stamps, strict=True))
        try:
            self.signalMessage(*(queue[stamp] for queue, stamp in pairs))
        finally:
            for queue, stamp in pairs:
                del queue[stamp]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Outputs a message of each filter as soon as all have one with similar stamps.

    Args:
        fs: the filters.
        queue_size: maximum number of messages of each filter to keep; more drop the oldest.
        slop: maximum difference of the stamps in seconds.
        allow_headerless: as for `Cache`.
        reset: drop all messages when simulated time goes back.
    """

    def __init__(
        self,
        fs: Iterable[SimpleFilter],
        queue_size: int,
        slop: float,
        allow_headerless: bool = False,
        reset: bool = False,
    ) -> None:
        self.slop = rospy.Duration.from_sec(slop)
        self.allow_headerless = allow_headerless
        self.last_added = rospy.Time()
        super().__init__(fs, queue_size, reset)

    def add(self, msg: Any, my_queue: dict[Any, Any], my_queue_index: int | None = None) -> None:
        """Add a message of one of the filters; see `TimeSynchronizer.add`."""
        stamp = _stamp(msg, self.allow_headerless)
        if stamp is None:
            return
        with self.lock:
            if self._keep(stamp, msg, my_queue, my_queue_index):
                self._match(stamp, my_queue)

    def _check_time(self, now: Any) -> None:
        if now < self.last_added:
            rospy.loginfo(
                "ApproximateTimeSynchronizer: Detected jump back in time. Clearing buffer."
            )
            for queue in self.queues:
                queue.clear()
        self.last_added = now

    def _match(self, stamp: Any, own: dict[Any, Any]) -> None:
        """Output the message with this stamp and the nearest ones of the other filters.

        The nearest of all are tried first, then the next nearest of the last filters.
        """
        near = [
            [stamp] if queue is own else sorted(self._near(queue, stamp), key=_distance_to(stamp))
            for queue in self.queues
        ]
        for stamps in product(*near):
            if max(stamps) - min(stamps) < self.slop and stamp in own:
                self._output(list(stamps))
                return

    def _near(self, queue: dict[Any, Any], stamp: Any) -> list[Any]:
        return [other for other in queue if abs(other - stamp) <= self.slop]


def _distance_to(stamp: Any) -> Callable[[Any], Any]:
    return lambda other: abs(other - stamp)


def _stamp(message: Any, allow_headerless: bool) -> Any:
    """Return a message's stamp, or the current time if it may have none.

    Returns:
        None, after a warning, if the message must have a stamp but has none.
    """
    header: Any = getattr(message, "header", None)
    if hasattr(header, "stamp"):
        return header.stamp
    if allow_headerless:
        return rospy.Time.now()
    rospy.logwarn(
        "Cannot use message filters with non-stamped messages. "
        "Use the 'allow_headerless' constructor option to "
        "auto-assign ROS time to headerless messages."
    )
    return None
