"""Statistics of the latest measurements."""

from __future__ import annotations

import pytest

from fibws.cli.topic.window import Summary, Window, as_object, in_seconds


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
