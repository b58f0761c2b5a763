"""genpy's Time and Duration, in whole nanoseconds."""

from __future__ import annotations

from numbers import Integral, Real
from typing import Any, ClassVar, Self, SupportsFloat, SupportsIndex, overload

SECOND = 1_000_000_000


class TVal:
    """Seconds and nanoseconds; nanoseconds beyond a second are carried over.

    Args:
        secs: seconds; a float if ``nsecs`` is 0.
        nsecs: nanoseconds.

    Raises:
        ValueError: ``secs`` is a float, and ``nsecs`` is not 0.
    """

    __slots__ = ["secs", "nsecs"]  # noqa: RUF023 (the order on the wire)
    _slot_types: ClassVar[list[str]] = ["int32", "int32"]

    secs: int
    nsecs: int

    def __init__(self, secs: SupportsFloat = 0, nsecs: SupportsIndex = 0) -> None:
        if isinstance(secs, Integral):
            self.secs, self.nsecs = int(secs), int(nsecs)
        elif nsecs != 0:
            raise ValueError("if secs is a float, nsecs cannot be set")
        else:
            self.secs, self.nsecs = _split(secs)
        self.canon()

    @classmethod
    def from_sec(cls, float_secs: SupportsFloat) -> Self:
        """Create it from seconds, such as ``time.time()``; fractions of nanoseconds are cut off."""
        return cls(*_split(float_secs))

    def is_zero(self) -> bool:
        """Return whether it is 0, which means unset for a time."""
        return self.secs == 0 and self.nsecs == 0

    def set(self, secs: int, nsecs: int) -> None:
        """Set both parts without carrying over."""
        self.secs = secs
        self.nsecs = nsecs

    def canon(self) -> None:
        """Carry whole seconds over, so that 0 <= ``nsecs`` < 1,000,000,000."""
        carry, self.nsecs = divmod(self.nsecs, SECOND)
        self.secs += carry

    def to_sec(self) -> float:
        """Return the seconds as a float."""
        return float(self.secs) + float(self.nsecs) / 1e9

    def to_nsec(self) -> int:
        """Return the nanoseconds as an int."""
        return self.secs * SECOND + self.nsecs

    def __getstate__(self) -> list[int]:
        return [self.secs, self.nsecs]

    def __setstate__(self, state: list[int]) -> None:
        self.secs, self.nsecs = state

    def __hash__(self) -> int:
        return hash((self.secs, self.nsecs))

    def __str__(self) -> str:
        return str(self.to_nsec())

    def __repr__(self) -> str:
        return f"genpy.TVal[{self.to_nsec()}]"

    def __bool__(self) -> bool:
        return not self.is_zero()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TVal) and self.to_nsec() == other.to_nsec()

    def __lt__(self, other: TVal) -> bool:
        return self.to_nsec() < other.to_nsec() if self._is_comparable(other) else NotImplemented

    def __le__(self, other: TVal) -> bool:
        return self.to_nsec() <= other.to_nsec() if self._is_comparable(other) else NotImplemented

    def __gt__(self, other: TVal) -> bool:
        return self.to_nsec() > other.to_nsec() if self._is_comparable(other) else NotImplemented

    def __ge__(self, other: TVal) -> bool:
        return self.to_nsec() >= other.to_nsec() if self._is_comparable(other) else NotImplemented

    def _is_comparable(self, other: object) -> bool:
        """Return whether it can be compared with the other."""
        return isinstance(other, TVal)


class Time(TVal):
    """A point in time since 1970.

    Raises:
        TypeError: it is negative.
    """

    __slots__ = ["secs", "nsecs"]  # noqa: RUF023 (the order on the wire)

    def __init__(self, secs: SupportsFloat = 0, nsecs: SupportsIndex = 0) -> None:
        super().__init__(secs, nsecs)
        if self.secs < 0:
            raise TypeError("time values must be positive")

    def to_time(self) -> float:
        """Return the seconds as ``time.time()`` does; the same as `to_sec`."""
        return self.to_sec()

    def __repr__(self) -> str:
        return f"genpy.Time[{self.to_nsec()}]"

    def __add__(self, other: Duration) -> Self:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    @overload
    def __sub__(self, other: Time) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Self: ...
    def __sub__(self, other: Time | Duration) -> Duration | Self:
        if isinstance(other, Time):
            return Duration(self.secs - other.secs, self.nsecs - other.nsecs)
        if isinstance(other, Duration):
            return type(self)(self.secs - other.secs, self.nsecs - other.nsecs)
        return NotImplemented

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Time) and _parts(self) == _parts(other)

    __hash__ = TVal.__hash__

    def _is_comparable(self, other: object) -> bool:
        return isinstance(other, Time)


class Duration(TVal):
    """A length of time; it may be negative, but its ``nsecs`` never are."""

    __slots__ = ["secs", "nsecs"]  # noqa: RUF023 (the order on the wire)

    def __repr__(self) -> str:
        return f"genpy.Duration[{self.to_nsec()}]"

    def __neg__(self) -> Self:
        return type(self)(-self.secs, -self.nsecs)

    def __abs__(self) -> Self:
        return self if self.secs >= 0 else -self

    def __add__(self, other: Duration) -> Self:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    def __sub__(self, other: Duration) -> Self:
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs - other.secs, self.nsecs - other.nsecs)

    def __mul__(self, factor: Any) -> Self:
        if isinstance(factor, Integral):
            return type(self)(self.secs * int(factor), self.nsecs * int(factor))
        if isinstance(factor, Real):
            return self.from_sec(self.to_sec() * float(factor))
        return NotImplemented

    __rmul__ = __mul__

    @overload
    def __floordiv__(self, divisor: Duration) -> int: ...
    @overload
    def __floordiv__(self, divisor: float) -> Self: ...
    def __floordiv__(self, divisor: Any) -> int | Self:
        if isinstance(divisor, Real):
            return self.from_sec(self.to_sec() // float(divisor))
        if isinstance(divisor, Duration):
            return int(self.to_sec() // divisor.to_sec())
        return NotImplemented

    @overload
    def __truediv__(self, divisor: Duration) -> float: ...
    @overload
    def __truediv__(self, divisor: float) -> Self: ...
    def __truediv__(self, divisor: Any) -> float | Self:
        if isinstance(divisor, Real):
            return self.from_sec(self.to_sec() / float(divisor))
        if isinstance(divisor, Duration):
            return self.to_sec() / divisor.to_sec()
        return NotImplemented

    def __mod__(self, divisor: Duration) -> Self:
        if not isinstance(divisor, Duration):
            return NotImplemented
        return self.from_sec(self.to_sec() % divisor.to_sec())

    def __divmod__(self, divisor: Duration) -> tuple[int, Self]:
        if not isinstance(divisor, Duration):
            return NotImplemented
        quotient, remainder = divmod(self.to_sec(), divisor.to_sec())
        return int(quotient), self.from_sec(remainder)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Duration) and _parts(self) == _parts(other)

    __hash__ = TVal.__hash__

    def _is_comparable(self, other: object) -> bool:
        return isinstance(other, Duration)


def _parts(value: TVal) -> tuple[int, int]:
    return value.secs, value.nsecs


def _split(seconds: Any) -> tuple[int, int]:
    """Return seconds and nanoseconds, both cut off towards zero as in genpy."""
    secs = int(seconds)
    return secs, int((seconds - secs) * SECOND)
