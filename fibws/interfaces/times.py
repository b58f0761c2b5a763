"""ROS's two types of time: a moment and a length of time, in whole nanoseconds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self, overload

_SECOND = 1_000_000_000


@dataclass(slots=True, order=True)
class _Span:
    """Seconds and nanoseconds; whole seconds among the latter are carried over, as in genpy."""

    secs: int = 0
    nsecs: int = 0

    def __post_init__(self) -> None:
        carry, self.nsecs = divmod(self.nsecs, _SECOND)
        self.secs += carry

    @classmethod
    def from_sec(cls, seconds: float) -> Self:
        """That many seconds, rounded to a nanosecond."""
        return cls(nsecs=round(seconds * _SECOND))

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


class Duration(_Span):
    """A length of time; it may be negative, and its ``nsecs`` never are."""

    __slots__ = ()

    def __add__(self, other: Duration) -> Duration:
        return Duration.from_nanoseconds(self.to_nanoseconds() + other.to_nanoseconds())

    def __sub__(self, other: Duration) -> Duration:
        return Duration.from_nanoseconds(self.to_nanoseconds() - other.to_nanoseconds())

    def __neg__(self) -> Duration:
        return Duration.from_nanoseconds(-self.to_nanoseconds())


class Time(_Span):
    """A moment, counted from 1970."""

    __slots__ = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.secs < 0:
            raise ValueError("a time cannot be before 1970")

    def __add__(self, other: Duration) -> Time:
        return Time.from_nanoseconds(self.to_nanoseconds() + other.to_nanoseconds())

    @overload
    def __sub__(self, other: Time) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Time: ...
    def __sub__(self, other: Time | Duration) -> Time | Duration:
        difference = self.to_nanoseconds() - other.to_nanoseconds()
        if isinstance(other, Time):
            return Duration.from_nanoseconds(difference)
        return Time.from_nanoseconds(difference)
