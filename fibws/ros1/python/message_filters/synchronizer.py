"""Messages of several topics that belong together, by their stamps."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from itertools import product
from typing import Any

import rospy

from message_filters.simple_filter import SimpleFilter
from message_filters.stamp import stamp_of


class TimeSynchronizer(SimpleFilter):
    """Lets messages through when there is one of each filter, all with the same stamp.

    Callbacks get one message of each filter, in the order of the filters, one set at a time.

    Args:
        fs: the filters.
        queue_size: how many messages of each wait for the others; then the oldest goes.
        reset: whether all that waits goes when simulated time goes back.
    """

    def __init__(self, fs: Iterable[SimpleFilter], queue_size: int, reset: bool = False) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.enable_reset = reset
        self.lock = threading.Lock()
        self.connectInput(list(fs))

    def connectInput(self, fs: list[SimpleFilter]) -> None:
        """Take the messages of these filters."""
        self.queues: list[dict[Any, Any]] = [{} for _ in fs]
        self.latest_stamps = [rospy.Time(0) for _ in fs]
        self.input_connections = [
            filter_.registerCallback(self.add, queue, index)
            for index, (filter_, queue) in enumerate(zip(fs, self.queues, strict=True))
        ]

    def add(self, msg: Any, my_queue: dict[Any, Any], my_queue_index: int | None = None) -> None:
        """Take a message of one of the filters.

        Args:
            my_queue: of ``queues``, the filter's.
            my_queue_index: its place there.
        """
        with self.lock:
            if self._keep(msg.header.stamp, msg, my_queue, my_queue_index):
                common = set.intersection(*map(set, self.queues))
                for stamp in sorted(common):
                    self._let_through([stamp] * len(self.queues))

    def _keep(self, stamp: Any, message: Any, queue: dict[Any, Any], index: int | None) -> bool:
        """Have a message wait for the others; tell whether they may be there."""
        now = rospy.Time.now()
        resetting = self.enable_reset and not rospy.rostime.is_wallclock()
        if resetting and index is not None:
            if now < self.latest_stamps[index]:
                rospy.logdebug("Detected jump back in time. Clearing message filter queue")
                queue.clear()
            self.latest_stamps[index] = now
        queue[stamp] = message
        self._look_back(now)
        while len(queue) > self.queue_size:
            del queue[min(queue)]
        # After time went back, what the other filters have is of before that until they notice.
        return not resetting or max(self.latest_stamps) == now

    def _look_back(self, now: Any) -> None:
        """See whether time went back."""

    def _let_through(self, stamps: list[Any]) -> None:
        """Let the messages of these stamps through, one of each filter."""
        pairs = list(zip(self.queues, stamps, strict=True))
        try:
            self.signalMessage(*(queue[stamp] for queue, stamp in pairs))
        finally:
            for queue, stamp in pairs:
                del queue[stamp]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Lets messages through when there is one of each filter, all with about the same stamp.

    Args:
        fs: the filters.
        queue_size: how many messages of each wait for the others; then the oldest goes.
        slop: the seconds that the stamps are apart at most.
        allow_headerless: whether messages without a header are of the time at which they come,
            rather than being left out with a warning.
        reset: whether all that waits goes when simulated time goes back.
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
        """Take a message of one of the filters.

        Args:
            my_queue: of ``queues``, the filter's.
            my_queue_index: its place there.
        """
        stamp = stamp_of(msg, self.allow_headerless)
        if stamp is None:
            return
        with self.lock:
            if self._keep(stamp, msg, my_queue, my_queue_index):
                self._match(stamp, my_queue)

    def _look_back(self, now: Any) -> None:
        if now < self.last_added:
            rospy.loginfo(
                "ApproximateTimeSynchronizer: Detected jump back in time. Clearing buffer."
            )
            for queue in self.queues:
                queue.clear()
        self.last_added = now

    def _match(self, stamp: Any, own: dict[Any, Any]) -> None:
        """Let the message of this stamp through with those of the others that are nearest to it.

        What is tried first are the nearest of all, then the last filters' next nearest.
        """
        near = [
            [stamp] if queue is own else sorted(self._near(queue, stamp), key=_distance_to(stamp))
            for queue in self.queues
        ]
        for stamps in product(*near):
            if max(stamps) - min(stamps) < self.slop and stamp in own:
                self._let_through(list(stamps))
                return

    def _near(self, queue: dict[Any, Any], stamp: Any) -> list[Any]:
        return [other for other in queue if abs(other - stamp) <= self.slop]


def _distance_to(stamp: Any) -> Callable[[Any], Any]:
    return lambda other: abs(other - stamp)
