"""Statistics of the latest measurements."""

from __future__ import annotations

import pytest

from fibws.values.rates import MessageRate, Summary, Window, as_object, in_seconds, rates_text


def test_summary_of_measurements() -> None:
    window = Window()
    for value in (1.0, 2.0, 6.0):
        window.add(value)
    summary = window.summary()
    assert (summary.mean, summary.least, summary.most) == (3.0, 1.0, 6.0)
    assert summary.deviation == pytest.approx((14 / 3) ** 0.5)
    assert (len(window), window.total, window.oldest) == (3, 9.0, 1.0)


def test_full_window_drops_the_oldest_measurement() -> None:
    window = Window(2)
    for value in (1.0, 2.0, 3.0):
        window.add(value)
    assert (len(window), window.oldest, window.total) == (2, 2.0, 5.0)


def test_summary_of_nothing_is_an_error() -> None:
    with pytest.raises(ValueError, match="no measurements"):
        Window().summary()


def test_summary_as_text_and_as_an_object() -> None:
    summary = Summary(1.0, 0.5, 1.5, 0.25)
    assert in_seconds(summary) == "min: 0.500s max: 1.500s std dev: 0.25000s"
    assert as_object(summary) == {"min": 0.5, "max": 1.5, "std_dev": 0.25}


def test_rate_is_computed_from_the_intervals() -> None:
    rate = MessageRate()
    for moment in (1.0, 1.5, 2.0):
        rate.add(moment)
    polled = rate.poll()
    assert polled is not None
    hz, deltas, number = polled
    assert (hz, deltas.least, deltas.most, number) == (2.0, 0.5, 0.5, 3)


def test_poll_returns_nothing_without_new_messages() -> None:
    rate = MessageRate()
    assert rate.poll() is None
    rate.add(1.0)
    assert rate.poll() is None, "one message has no rate"
    rate.add(2.0)
    assert rate.poll() is not None
    assert rate.poll() is None
    rate.add(3.0)
    assert rate.poll() is not None


def test_only_the_latest_messages_are_measured() -> None:
    rate = MessageRate(window=2)
    for moment in (0.0, 10.0, 11.0):
        rate.add(moment)
    polled = rate.poll()
    assert polled is not None
    assert (polled[0], polled[2]) == (1.0, 2)


def test_rate_of_simultaneous_messages_is_0() -> None:
    rate = MessageRate()
    rate.add(1.0)
    rate.add(1.0)
    polled = rate.poll()
    assert polled is not None
    assert polled[0] == 0.0


def test_table_columns_are_aligned() -> None:
    polled = {"/x": (1.0, Summary(1.0, 1.0, 1.0, 0.0), 2)}
    assert rates_text(polled, 2).splitlines() == [
        "topic   rate   min_delta   max_delta   std_dev   window",
        "=" * 55,
        "/x      1.0    1.0         1.0         0.0       2     ",
    ]
