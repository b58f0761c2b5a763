"""Times and durations count in whole nanoseconds and are ordered."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.interfaces import Duration, Time


@pytest.mark.parametrize("kind", [Time, Duration])
def test_whole_seconds_among_the_nanoseconds_are_carried_over(kind: type[Time | Duration]) -> None:
    assert kind(1, 2_500_000_000) == kind(3, 500_000_000)
    assert repr(kind(3)).endswith("(secs=3, nsecs=0)")


def test_seconds_are_floats() -> None:
    assert Time.from_sec(1.5) == Time(1, 500_000_000)
    assert Duration.from_sec(-0.5) == Duration(-1, 500_000_000)
    assert Duration(-1, 500_000_000).to_sec() == -0.5


@given(st.integers(-(2**62), 2**62))
def test_nanoseconds_are_exact(nanoseconds: int) -> None:
    duration = Duration.from_nanoseconds(nanoseconds)
    assert duration.to_nanoseconds() == nanoseconds
    assert 0 <= duration.nsecs < 1_000_000_000


def test_times_are_ordered() -> None:
    assert Time(1, 5) < Time(2) < Time(2, 1)
    assert Duration(-1) < Duration(0)
    with pytest.raises(TypeError):
        assert Time(1) < Duration(2)  # type: ignore[operator]


def test_times_and_durations_add_up() -> None:
    assert Time(5) - Time(3, 1) == Duration(1, 999_999_999)
    assert Time(5) + Duration(1, 1) == Time(6, 1)
    assert Time(5) - Duration(1) == Time(4)
    assert Duration(5) + Duration(1) == Duration(6)
    assert Duration(5) - Duration(6) == -Duration(1)


def test_times_before_1970_are_refused() -> None:
    with pytest.raises(ValueError, match="before 1970"):
        Time(-1)
