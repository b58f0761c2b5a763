"""Where one frame was over time."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.tf.errors import OldData, RepeatedData, TransformOutOfTime
from fibws.tf.history import CACHE_TIME, LATEST, History, Sample, Static, seconds
from fibws.tf.transform import Transform, link_of

SECOND = 1_000_000_000


def sample(at: float, x: float, parent: str = "map") -> Sample:
    return Sample(int(at * SECOND), parent, Transform((x, 0.0, 0.0)))


def history(*samples: Sample) -> History:
    history = History()
    for each in samples:
        insert(history, each)
    return history


def insert(history: History, sample: Sample) -> None:
    history.insert(sample.stamp, link_of(sample.parent, sample.transform))


def x_at(places: History | Static, at: float) -> float:
    return places.at(int(at * SECOND))[1]


def test_transform_between_two_samples_is_interpolated() -> None:
    places = history(sample(1, 10), sample(2, 20), sample(4, 0))
    assert [x_at(places, at) for at in (1, 1.5, 2, 3, 4)] == [10, 15, 20, 10, 0]


def test_time_0_is_the_latest_sample() -> None:
    places = history(sample(1, 10), sample(2, 20))
    assert places.latest == sample(2, 20)
    assert places.at(LATEST) == link_of("map", places.latest.transform)


@pytest.mark.parametrize(
    ("at", "fault"),
    [
        (0.5, "into the past.  Requested time 0.500000000 but the earliest data is at time 1.0"),
        (2.25, "into the future.  Requested time 2.250000000 but the latest data is at time 2.0"),
    ],
)
def test_times_outside_the_history_are_an_error(at: float, fault: str) -> None:
    places = history(sample(1, 10), sample(2, 20))
    with pytest.raises(TransformOutOfTime, match=fault):
        places.at(int(at * SECOND))


def test_single_sample_is_valid_at_one_time() -> None:
    places = history(sample(1, 10))
    assert x_at(places, 1) == 10
    with pytest.raises(
        TransformOutOfTime, match=r"at time 2.000000000, but only time 1.000000000 is"
    ):
        places.at(2 * SECOND)


def test_samples_may_arrive_out_of_order() -> None:
    places = history(sample(4, 0), sample(1, 10), sample(2, 20))
    assert [x_at(places, at) for at in (1, 1.5, 2, 3, 4)] == [10, 15, 20, 10, 0]


def test_sample_of_the_same_time_replaces_the_first() -> None:
    places = history(sample(0, 1), sample(0, 2))
    assert (len(places), places.latest) == (1, sample(0, 2))
    places = history(sample(1, 10), sample(2, 20), sample(1, 12))
    assert (len(places), x_at(places, 1.5)) == (2, 16)


def test_transform_is_not_interpolated_between_parents() -> None:
    places = history(sample(1, 10, "map"), sample(2, 20, "odom"))
    assert places.at(int(1.9 * SECOND))[:2] == ("map", 10)
    assert places.at(2 * SECOND)[:2] == ("odom", 20)


def test_history_reaches_ten_seconds_back() -> None:
    places = history(sample(1, 1), sample(2, 2), sample(12, 12))
    assert (len(places), x_at(places, 2)) == (2, 2)
    with pytest.raises(TransformOutOfTime, match=r"the earliest data is at time 2.0"):
        places.at(SECOND)


def test_clock_set_back_begins_a_new_history() -> None:
    places = history(sample(100, 1), sample(101, 2), sample(90.9, 3))
    assert (len(places), places.latest) == (1, sample(90.9, 3))


def test_late_sample_does_not_begin_a_new_history() -> None:
    places = history(sample(100, 1), sample(101, 2), sample(91, 3))
    assert (len(places), places.latest) == (3, sample(101, 2))


def test_strict_history_refuses_repeated_and_old_samples() -> None:
    places = History(strict=True)
    insert(places, sample(100, 1))
    with pytest.raises(RepeatedData, match="TF_REPEATED_DATA"):
        insert(places, sample(100, 2))
    with pytest.raises(OldData, match="TF_OLD_DATA"):
        insert(places, sample(89, 2))
    insert(places, sample(95, 3))
    assert (len(places), places.oldest_stamp, places.latest) == (2, 95 * SECOND, sample(100, 1))


def test_cache_time_can_be_set() -> None:
    places = History(2 * SECOND)
    for at in range(5):
        insert(places, sample(at, at))
    assert places.oldest_stamp == 2 * SECOND


def test_oldest_sample_can_be_removed() -> None:
    places = history(sample(1, 10), sample(2, 20))
    places.shorten()
    assert (len(places), places.latest) == (1, sample(2, 20))


@given(st.lists(st.integers(0, 3 * CACHE_TIME), min_size=1))
def test_history_is_bounded_and_sorted(stamps: list[int]) -> None:
    places = History()
    for stamp in stamps:
        insert(places, Sample(stamp, "map", Transform()))
        kept = list(places._stamps)
        assert kept == sorted(set(kept))
        assert stamp in kept
        assert kept[-1] - kept[0] <= CACHE_TIME


def test_static_transform_is_valid_at_all_times() -> None:
    place = Static(link_of("map", Transform((10.0, 0.0, 0.0))))
    assert [x_at(place, at) for at in (0, 1, 99)] == [10, 10, 10]
    assert (len(place), place.latest.stamp) == (1, LATEST)


@pytest.mark.parametrize(
    ("nanoseconds", "text"),
    [(0, "0.000000000"), (1, "0.000000001"), (1_500_000_000, "1.500000000")],
)
def test_seconds_are_written_exactly(nanoseconds: int, text: str) -> None:
    assert seconds(nanoseconds) == text
