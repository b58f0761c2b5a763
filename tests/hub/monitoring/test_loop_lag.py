"""The event loop's lag: how late a timer is."""

from __future__ import annotations

import pytest

from fibws.hub.graph.totals import Histogram
from fibws.hub.monitoring.loop_lag import INTERVAL, LAG_BUCKETS, LoopLag

from ..fakes import FakeClock


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()


@pytest.fixture
def lag(clock: FakeClock) -> LoopLag:
    lag = LoopLag(clock, clock.time)
    lag.start()
    return lag


def test_values_are_counted_by_their_upper_bounds() -> None:
    histogram = Histogram((1.0, 2.0))
    for value in (0.5, 1.0, 1.5, 3.0):
        histogram.add(value)
    assert histogram.cumulative() == [2, 3, 4]
    assert histogram.sum == 6.0


def test_loop_in_time_has_no_lag(lag: LoopLag, clock: FakeClock) -> None:
    clock.advance(10 * INTERVAL)
    assert lag.current < 1e-9
    assert lag.histogram.cumulative()[0] == lag.histogram.cumulative()[-1] >= 9


def test_late_timer_is_the_lag_until_the_next_one(lag: LoopLag, clock: FakeClock) -> None:
    clock.late = 0.3
    clock.advance(INTERVAL + 0.3)
    assert lag.current == pytest.approx(0.3)
    at_most = dict(zip(LAG_BUCKETS, lag.histogram.cumulative(), strict=False))
    assert (at_most[0.25], at_most[0.5]) == (0, 1)
    clock.late = 0.0
    clock.advance(INTERVAL)
    assert lag.current == pytest.approx(0)


def test_timer_that_is_overdue_counts_before_it_fires(lag: LoopLag, clock: FakeClock) -> None:
    clock.late = 100.0
    clock.advance(INTERVAL + 5.0)
    assert lag.current == pytest.approx(5.0)


def test_no_timer_is_left_after_the_end(lag: LoopLag, clock: FakeClock) -> None:
    lag.stop()
    assert clock.timers == 0
