"""What happens again and again: a loop's rate, and functions that are called by the clock."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

import genpy

from rospy import core
from rospy.exceptions import ROSInterruptException, ROSTimeMovedBackwardsException
from rospy.rostime import Duration, Time, get_rostime, is_wallclock, sleep

__all__ = ["Rate", "Timer", "TimerEvent", "sleep"]


class Rate:
    """A loop's rhythm, without drift; who is late by more than two periods goes on from there.

    Args:
        hz: times a second.
        reset: begin anew when simulated time goes back, rather than raise.

    Raises:
        ROSInitException: `init_node` has not been called.
    """

    def __init__(self, hz: float, reset: bool = False) -> None:
        self.last_time: genpy.Time = get_rostime()
        self.sleep_dur = Duration(0, int(1e9 / hz))
        self._reset = reset
        self._was_cut_short = False

    def remaining(self) -> genpy.Duration:
        """How long `sleep` would sleep now; negative if its time has passed."""
        return self._remaining(get_rostime())

    def sleep(self) -> None:
        """Sleep until the period is over, or the node ends.

        A loop that looks at `is_shutdown` ends by that, so that what follows it is done, as in ROS.

        Raises:
            ROSInterruptException: the loop goes on after the node's end, or time is simulated.
            ROSTimeMovedBackwardsException: simulated time went back, and ``reset`` is false.
        """
        now = get_rostime()
        try:
            # Who is late notices the node's end, too.
            sleep(max(self._remaining(now), Duration()))
        except ROSTimeMovedBackwardsException:
            if not self._reset:
                raise
            self.last_time = get_rostime()
            return
        except ROSInterruptException:
            if self._was_cut_short or not is_wallclock():
                raise
            self._was_cut_short = True
        self.last_time = self.last_time + self.sleep_dur
        if now - self.last_time > self.sleep_dur * 2:
            self.last_time = now

    def _remaining(self, now: Time) -> genpy.Duration:
        if self.last_time > now:
            self.last_time = now
        return self.sleep_dur - (now - self.last_time)


@dataclass(eq=False)
class TimerEvent:
    """When a timer's function should have been called and when it was, this time and the last.

    All but ``last_duration``, the seconds that it took, are Time; of the last time all are None
    when there was none.
    """

    last_expected: genpy.Time | None
    last_real: genpy.Time | None
    current_expected: genpy.Time
    current_real: genpy.Time
    last_duration: float | None


class Timer(threading.Thread):
    """Calls a function once in each period, in a thread of its own, until the node ends.

    Args:
        period: the first call comes after it, too.
        callback: is given a `TimerEvent`; if it raises, the timer ends.
        oneshot: call it once only.
        reset: go on when simulated time goes back, rather than end with an exception.
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
        """Have the function not called any more."""
        self._shut_down = True

    def run(self) -> None:
        """Call the function; this is the thread's own."""
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
        """Sleep until the next call; false if there will be none."""
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
