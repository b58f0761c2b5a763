"""ROS's time: that of the clock on the wall, unless the graph has a simulated one."""

from __future__ import annotations

from time import time_ns
from typing import overload

import genpy

from rospy import core
from rospy.exceptions import ROSInitException, ROSInterruptException, ROSTimeMovedBackwardsException

_initialized = False
_simulated: Time | None = None


class Duration(genpy.Duration):
    """A length of time, in whole nanoseconds."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"rospy.Duration[{self.to_nsec()}]"


class Time(genpy.Time):
    """A moment, in whole nanoseconds; since 1970, unless time is simulated."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"rospy.Time[{self.to_nsec()}]"

    @staticmethod
    def now() -> Time:
        """The present; raises as `get_rostime` does."""
        return get_rostime()

    @classmethod
    def from_seconds(cls, float_secs: float) -> Time:
        """That many seconds after the beginning; `from_sec` is the same."""
        return cls.from_sec(float_secs)


def get_rostime() -> Time:
    """The present time, of the graph's clock if it has a simulated one.

    Raises:
        ROSInitException: `init_node` has not been called.
    """
    if not _initialized:
        raise ROSInitException("time is not initialized. Have you called init_node()?")
    if _simulated is not None:
        return _simulated
    return Time(*divmod(time_ns(), 1_000_000_000))


def get_time() -> float:
    """The present time in seconds; raises as `get_rostime` does."""
    return get_rostime().to_sec()


def is_rostime_initialized() -> bool:
    """Whether `init_node` has been called, so that there is a time."""
    return _initialized


def set_rostime_initialized(val: bool) -> None:
    """Let there be time."""
    global _initialized
    _initialized = val


def is_wallclock() -> bool:
    """Whether the time is that of the clock on the wall."""
    return _simulated is None


def switch_to_wallclock() -> None:
    """Have no simulated time any more."""
    global _simulated
    _simulated = None
    core.wakeup.wake_all()


def set_rostime(time: genpy.Time) -> None:
    """Have simulated time, and this is it.

    Raises:
        ValueError: it is no time.
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
    """The seconds of a Duration, or of what is seconds already."""
    return duration.to_sec() if isinstance(duration, genpy.Duration) else duration


def wallsleep(duration: float) -> None:
    """Sleep for some seconds on the wall's clock, or until the node ends."""
    if duration > 0:
        core.wait_for_shutdown(duration)


def sleep(duration: genpy.Duration | float) -> None:
    """Sleep, of the graph's time; a negative duration is none.

    Args:
        duration: a Duration, or seconds.

    Raises:
        ROSInterruptException: the node ends.
        ROSTimeMovedBackwardsException: simulated time went back, to before the sleep.
    """
    if is_wallclock():
        seconds = seconds_of(duration)
        if seconds < 0:
            return
        if core.wait_for_shutdown(seconds):
            raise ROSInterruptException("ROS shutdown request")
        return
    if not isinstance(duration, genpy.Duration):
        duration = genpy.Duration.from_sec(duration)
    # Before the first word from the clock it is no time at all.
    core.wakeup.wait(lambda: core.is_shutdown() or not get_rostime().is_zero())
    began = get_rostime()
    end = began + duration
    core.wakeup.wait(lambda: core.is_shutdown() or not began <= get_rostime() < end)
    if core.is_shutdown():
        raise ROSInterruptException("ROS shutdown request")
    if get_rostime() < began:
        raise ROSTimeMovedBackwardsException((began - get_rostime()).to_sec())
