"""ROS's two types of time: a moment and a length of time, in whole nanoseconds."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from numbers import Integral, Real
from operator import index
from typing import Self, overload

_SECOND = 1_000_000_000


# The hash is genpy's: times are mutable, and keys of dicts all the same.
@dataclass(slots=True, order=True, unsafe_hash=True, init=False)
class _Span:
    secs: int
    nsecs: int

    def __init__(self, secs: float = 0, nsecs: int = 0) -> None:
        try:
            self.secs, self.nsecs = index(secs), index(nsecs)  # type: ignore[arg-type]
        except TypeError:
            self.secs, self.nsecs = _split(secs, nsecs)
        self._carry()

    def _carry(self) -> None:
        """Carry over whole seconds among the nanoseconds."""
        carry, self.nsecs = divmod(self.nsecs, _SECOND)
        self.secs += carry

    @classmethod
    def from_sec(cls, seconds: float) -> Self:
        """That many seconds, rounded to a nanosecond."""
        return cls(seconds)

    @classmethod
    def from_nanoseconds(cls, nanoseconds: int) -> Self:
        """That many nanoseconds."""
        return cls(nsecs=nanoseconds)

    def to_sec(self) -> float:
        """The seconds as a float, exact to about a microsecond in this century."""
        return self.secs + self.nsecs / _SECOND

    def to_nanoseconds(self) -> int:
        """The nanoseconds, exactly."""
        return self.secs * _SECOND + self.nsecs

    def __bool__(self) -> bool:
        return self.secs != 0 or self.nsecs != 0


class Duration(_Span):
    """A length of time; it may be negative, and its ``nsecs`` never are.

    As in rospy, durations are added, multiplied, divided and compared; 0 is false.

    Args:
        secs: seconds; a float is split, if there are no nanoseconds beside it.
        nsecs: nanoseconds; whole seconds among them are carried over.

    Raises:
        TypeError: a value is not a number, or ``nsecs`` is not an int.
        ValueError: ``secs`` is infinite or NaN, or a float beside nanoseconds.
    """

    __slots__ = ()

    def __add__(self, other: Duration) -> Duration:
        if not isinstance(other, Duration):
            return NotImplemented
        return Duration.from_nanoseconds(self.to_nanoseconds() + other.to_nanoseconds())

    def __sub__(self, other: Duration) -> Duration:
        if not isinstance(other, Duration):
            return NotImplemented
        return Duration.from_nanoseconds(self.to_nanoseconds() - other.to_nanoseconds())

    def __neg__(self) -> Duration:
        return Duration.from_nanoseconds(-self.to_nanoseconds())

    def __abs__(self) -> Duration:
        return Duration.from_nanoseconds(abs(self.to_nanoseconds()))

    def __mul__(self, factor: float) -> Duration:
        if not _is_number(factor):
            return NotImplemented
        return Duration.from_nanoseconds(round(self.to_nanoseconds() * factor))

    __rmul__ = __mul__

    @overload
    def __truediv__(self, divisor: Duration) -> float: ...
    @overload
    def __truediv__(self, divisor: float) -> Duration: ...
    def __truediv__(self, divisor: Duration | float) -> float | Duration:
        if isinstance(divisor, Duration):
            return self.to_nanoseconds() / divisor.to_nanoseconds()
        if not _is_number(divisor):
            return NotImplemented
        return Duration.from_nanoseconds(round(self.to_nanoseconds() / divisor))

    @overload
    def __floordiv__(self, divisor: Duration) -> int: ...
    @overload
    def __floordiv__(self, divisor: float) -> Duration: ...
    def __floordiv__(self, divisor: Duration | float) -> int | Duration:
        if isinstance(divisor, Duration):
            return self.to_nanoseconds() // divisor.to_nanoseconds()
        if not _is_number(divisor):
            return NotImplemented
        return Duration(self.to_sec() // divisor)  # Whole seconds, as in genpy.

    def __mod__(self, divisor: Duration) -> Duration:
        if not isinstance(divisor, Duration):
            return NotImplemented
        return Duration.from_nanoseconds(self.to_nanoseconds() % divisor.to_nanoseconds())

    def __divmod__(self, divisor: Duration) -> tuple[int, Duration]:
        if not isinstance(divisor, Duration):
            return NotImplemented
        return self // divisor, self % divisor


class Time(_Span):
    """A moment, counted from 1970; 0, which is false, stands for none.

    As in rospy, the difference of two times is a `Duration`, which is added to a time or subtracted
    from one, and times are compared.

    Args:
        secs: seconds; a float is split, if there are no nanoseconds beside it.
        nsecs: nanoseconds; whole seconds among them are carried over.

    Raises:
        TypeError: a value is not a number, or ``nsecs`` is not an int.
        ValueError: the time is before 1970, or ``secs`` is infinite, NaN, or a float beside
            nanoseconds.
    """

    __slots__ = ()

    def __init__(self, secs: float = 0, nsecs: int = 0) -> None:
        super().__init__(secs, nsecs)
        if self.secs < 0:
            raise ValueError("a time cannot be before 1970")

    def __add__(self, other: Duration) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        return Time.from_nanoseconds(self.to_nanoseconds() + other.to_nanoseconds())

    __radd__ = __add__

    @overload
    def __sub__(self, other: Time) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Time: ...
    def __sub__(self, other: Time | Duration) -> Time | Duration:
        if not isinstance(other, (Time, Duration)):
            return NotImplemented
        difference = self.to_nanoseconds() - other.to_nanoseconds()
        if isinstance(other, Time):
            return Duration.from_nanoseconds(difference)
        return Time.from_nanoseconds(difference)


def _is_number(value: object) -> bool:
    return isinstance(value, Real)


def _split(seconds: object, nanoseconds: object) -> tuple[int, int]:
    """Return seconds, which are no int, in two parts; the errors are those of `Duration`."""
    if isinstance(seconds, Integral):
        raise TypeError(f"nsecs must be an int, got {nanoseconds!r}")
    if not isinstance(seconds, Real):
        raise TypeError(f"secs must be a number, got {seconds!r}")
    if nanoseconds != 0:
        raise ValueError("if secs is a float, nsecs cannot be set")
    exact = float(seconds)
    if not isfinite(exact):
        raise ValueError(f"secs must be a finite number, got {seconds!r}")
    whole = int(exact)
    return whole, round((exact - whole) * _SECOND)
