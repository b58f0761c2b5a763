"""Periodic work: `Rate` for loops, and `Timer` for callbacks."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

import genpy

from rospy import core
from rospy.exceptions import ROSInterruptException, ROSTimeMovedBackwardsException
from rospy.rostime import Duration, Time, get_rostime, sleep

__all__ = ["Rate", "Timer", "TimerEvent", "sleep"]


class Rate:
    """Keeps the rate of a loop, without drift unless it is late by more than two periods.

    Args:
        hz: the rate.
        reset: restart when simulated time goes back, instead of an exception.

    Raises:
        ROSInitException: `init_node` has not been called.
    """

    def __init__(self, hz: float, reset: bool = False) -> None:
        self.last_time: genpy.Time = get_rostime()
        self.sleep_dur = Duration(0, int(1e9 / hz))
        self._reset = reset

    def remaining(self) -> genpy.Duration:
        """Return the duration of a `sleep` now; negative if the loop is late."""
        return self._remaining(get_rostime())

    def sleep(self) -> None:
        """Sleep until the period is over, or the node ends.

        Raises:
            ROSInterruptException: the node ends, and time is simulated.
            ROSTimeMovedBackwardsException: simulated time went back, and ``reset`` is false.
        """
        now = get_rostime()
        try:
            sleep(self._remaining(now))
        except ROSTimeMovedBackwardsException:
            if not self._reset:
                raise
            self.last_time = get_rostime()
            return
        self.last_time = self.last_time + self.sleep_dur
        if now - self.last_time > self.sleep_dur * 2:
            self.last_time = now

    def _remaining(self, now: Time) -> genpy.Duration:
        if self.last_time > now:
            self.last_time = now
        return self.sleep_dur - (now - self.last_time)


@dataclass(eq=False)
class TimerEvent:
    """The expected and the real time of a timer's call, and of the previous call.

    ``last_duration`` is the duration of the previous call in seconds. Before the second call, the
    fields of the previous call are None.
    """

    last_expected: genpy.Time | None
    last_real: genpy.Time | None
    current_expected: genpy.Time
    current_real: genpy.Time
    last_duration: float | None


class Timer(threading.Thread):
    """Calls a function periodically, in a thread of its own, until the node ends.

    Args:
        period: the time between calls, and before the first one.
        callback: called with a `TimerEvent`; if it raises, the timer ends.
        oneshot: call it only once.
        reset: continue when simulated time goes back, instead of ending with an exception.
    """

    def __init__(
        self,
        period: genpy.Duration,
        callback: Callable[[TimerEvent], object],
        oneshot: bool = False,
        reset: bool = False,
    ) -> None:
        super().__init__(daemon=True)
        self._period = period
        self._callback = callback
        self._oneshot = oneshot
        self._reset = reset
        self._shut_down = False
        self.start()

    def shutdown(self) -> None:
        """Stop calling the function."""
        self._shut_down = True

    def run(self) -> None:
        """Call the function periodically; the thread runs this."""
        rate = Rate(1 / self._period.to_sec(), reset=self._reset)
        expected: genpy.Time = get_rostime() + self._period
        last_expected: genpy.Time | None = None
        last_real: genpy.Time | None = None
        last_duration: float | None = None
        while self._sleep(rate):
            real, began = get_rostime(), monotonic()
            self._callback(TimerEvent(last_expected, last_real, expected, real, last_duration))
            if self._oneshot:
                return
            last_duration = monotonic() - began
            last_expected, last_real = expected, real
            expected = expected + self._period

    def _sleep(self, rate: Rate) -> bool:
        """Sleep until the next call; return False if the timer has ended."""
        if self._is_over():
            return False
        try:
            rate.sleep()
        except ROSInterruptException:
            if not core.is_shutdown():
                raise
        return not self._is_over()

    def _is_over(self) -> bool:
        return self._shut_down or core.is_shutdown()
