"""ROS's time: wall time, or simulated time."""

from __future__ import annotations

import time
from typing import overload

import genpy

from rospy import core
from rospy.exceptions import ROSInitException, ROSInterruptException, ROSTimeMovedBackwardsException

_initialized = False
_simulated: Time | None = None


class Duration(genpy.Duration):
    """A length of time in whole nanoseconds."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"rospy.Duration[{self.to_nsec()}]"


class Time(genpy.Time):
    """A point in time in whole nanoseconds, since 1970 or since the start of a simulation."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"rospy.Time[{self.to_nsec()}]"

    @staticmethod
    def now() -> Time:
        """Return the current time; raise as `get_rostime`."""
        return get_rostime()

    @classmethod
    def from_seconds(cls, float_secs: float) -> Time:
        """Create it from seconds; the same as `from_sec`."""
        return cls.from_sec(float_secs)


def get_rostime() -> Time:
    """Return the current time, which may be simulated.

    Raises:
        ROSInitException: `init_node` has not been called.
    """
    if not _initialized:
        raise ROSInitException("time is not initialized. Have you called init_node()?")
    if _simulated is not None:
        return _simulated
    return Time(*divmod(time.time_ns(), 1_000_000_000))


def get_time() -> float:
    """Return the current time in seconds; raise as `get_rostime`."""
    return get_rostime().to_sec()


def is_rostime_initialized() -> bool:
    """Return whether `init_node` has been called; there is no time before."""
    return _initialized


def set_rostime_initialized(val: bool) -> None:
    """Record whether `init_node` has been called."""
    global _initialized
    _initialized = val


def is_wallclock() -> bool:
    """Return whether time is wall time."""
    return _simulated is None


def switch_to_wallclock() -> None:
    """End simulated time."""
    global _simulated
    _simulated = None
    core.wakeup.wake_all()


def set_rostime(time: genpy.Time) -> None:
    """Set simulated time.

    Raises:
        ValueError: the argument is not a Time.
    """
    global _simulated
    if not isinstance(time, genpy.Time):
        raise ValueError(f"must be Time instance: {type(time)}")
    _simulated = Time(time.secs, time.nsecs)
    core.wakeup.wake_all()


@overload
def seconds_of(duration: genpy.Duration | float) -> float: ...


@overload
def seconds_of(duration: genpy.Duration | float | None) -> float | None: ...


def seconds_of(duration: genpy.Duration | float | None) -> float | None:
    """Return a Duration as seconds; seconds are returned unchanged."""
    return duration.to_sec() if isinstance(duration, genpy.Duration) else duration


def wallsleep(duration: float) -> None:
    """Sleep for seconds of wall time, or until the node ends.

    Once a thread has noticed the node's end, its sleeps last all of their time: the motors that a
    script stops behind its loop may need it. Before, the end interrupts a sleep, even one that
    begins later, so that a loop ends at once when Ctrl-C comes during its work.
    """
    if core.has_noticed_shutdown():
        time.sleep(max(duration, 0))
    else:
        core.wait_for_shutdown(duration)


def sleep(duration: genpy.Duration | float) -> None:
    """Sleep for a duration of ROS's time; return at once if it is negative.

    Args:
        duration: a Duration, or seconds.

    As in ROS, only simulated time raises at the node's end. At wall time a sleep ends early then,
    see `wallsleep`, and what follows it runs.

    Raises:
        ROSInterruptException: the node ends, and time is simulated.
        ROSTimeMovedBackwardsException: simulated time went back to before the sleep.
    """
    if is_wallclock():
        seconds = seconds_of(duration)
        if seconds < 0:
            return
        wallsleep(seconds)
        return
    if not isinstance(duration, genpy.Duration):
        duration = genpy.Duration.from_sec(duration)
    # Simulated time is 0 before the first message of the clock.
    core.wakeup.wait(lambda: core.is_shutdown() or not get_rostime().is_zero())
    began = get_rostime()
    end = began + duration
    core.wakeup.wait(lambda: core.is_shutdown() or not began <= get_rostime() < end)
    if core.is_shutdown():
        raise ROSInterruptException("ROS shutdown request")
    if get_rostime() < began:
        raise ROSTimeMovedBackwardsException((began - get_rostime()).to_sec())
