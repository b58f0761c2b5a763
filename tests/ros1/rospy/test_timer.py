"""Rates and timers."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator

import genpy
import pytest
from rospy import core, rostime
from rospy.exceptions import ROSInitException, ROSInterruptException, ROSTimeMovedBackwardsException
from rospy.timer import Rate, Timer, TimerEvent


@pytest.fixture
def simulated() -> Iterator[None]:
    """Time is simulated, and starts at 10 seconds."""
    rostime.set_rostime_initialized(True)
    rostime.set_rostime(genpy.Time(10))
    yield
    rostime.switch_to_wallclock()
    rostime.set_rostime_initialized(False)


@pytest.fixture
def sleeps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The durations of all sleeps, which only advance simulated time."""
    slept: list[float] = []

    def sleep(duration: genpy.Duration) -> None:
        slept.append(round(duration.to_sec(), 6))
        if duration > genpy.Duration():
            rostime.set_rostime(rostime.get_rostime() + duration)

    monkeypatch.setattr("rospy.timer.sleep", sleep)
    return slept


def works(seconds: float) -> None:
    """Advance simulated time, as for work that takes this long."""
    rostime.set_rostime(rostime.get_rostime() + genpy.Duration(seconds))


def test_rate_is_an_error_before_init_node() -> None:
    with pytest.raises(ROSInitException, match="time is not initialized"):
        Rate(10)


@pytest.mark.usefixtures("simulated")
def test_rate_subtracts_the_time_of_the_work(sleeps: list[float]) -> None:
    rate = Rate(2)
    works(0.1)
    rate.sleep()
    works(0.3)
    assert rate.remaining().to_sec() == pytest.approx(0.2)
    rate.sleep()
    assert sleeps == [0.4, 0.2]


@pytest.mark.usefixtures("simulated")
def test_rate_catches_up_only_if_it_is_a_little_late(
    sleeps: list[float],
) -> None:
    rate = Rate(1)
    works(1.5)
    rate.sleep()
    rate.sleep()
    works(10)
    rate.sleep()
    rate.sleep()
    assert sleeps == [-0.5, 0.5, -9, 1]


@pytest.mark.usefixtures("simulated")
def test_rate_raises_or_restarts_when_time_goes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    def sleep(duration: genpy.Duration) -> None:
        rostime.set_rostime(genpy.Time(3))
        raise ROSTimeMovedBackwardsException(7)

    monkeypatch.setattr("rospy.timer.sleep", sleep)
    rate, patient = Rate(1), Rate(1, reset=True)
    with pytest.raises(ROSTimeMovedBackwardsException):
        rate.sleep()
    patient.sleep()
    assert patient.remaining().to_sec() == 1


@pytest.mark.usefixtures("simulated")
def test_rate_continues_from_the_earlier_time(sleeps: list[float]) -> None:
    rate = Rate(1)
    rostime.set_rostime(genpy.Time(5))
    rate.sleep()
    assert sleeps == [1]


def test_no_sleep_after_shutdown_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rostime, "_initialized", True)
    monkeypatch.setattr(core, "_shutdown", True)
    rate, late = Rate(100), Rate(0.01)
    late.last_time = rostime.get_rostime() - genpy.Duration(1000)
    for each in late, rate:
        each.sleep()
    for _ in range(3):
        rate.sleep()


@pytest.mark.usefixtures("simulated")
def test_first_sleep_after_shutdown_raises_in_simulated_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rate = Rate(1)
    monkeypatch.setattr(core, "_shutdown", True)
    with pytest.raises(ROSInterruptException):
        rate.sleep()


@pytest.fixture
def by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """A timer has no thread, but is run by the test."""
    monkeypatch.setattr(Timer, "start", lambda _: None)


@pytest.mark.usefixtures("simulated", "sleeps", "by_hand")
def test_timer_event_has_expected_and_real_times() -> None:
    events: list[TimerEvent] = []

    def note(event: TimerEvent) -> None:
        events.append(event)
        works(0.25)
        if len(events) == 2:
            timer.shutdown()

    timer = Timer(genpy.Duration(1), note)
    timer.run()
    first, second = events
    assert first.last_expected is first.last_real is None
    assert first.last_duration is None
    assert first.current_expected == genpy.Time(11)
    assert first.current_real == genpy.Time(11)
    assert second.last_expected == second.last_real == genpy.Time(11)
    assert second.current_expected == genpy.Time(12)
    assert second.last_duration is not None
    assert second.last_duration >= 0


@pytest.mark.usefixtures("simulated", "sleeps")
def test_oneshot_timer_calls_once() -> None:
    events: queue.Queue[TimerEvent] = queue.Queue()
    Timer(genpy.Duration(1), events.put, oneshot=True).join(60)
    assert events.qsize() == 1


@pytest.mark.usefixtures("simulated")
def test_shutdown_ends_a_timer(monkeypatch: pytest.MonkeyPatch) -> None:
    asleep, over = threading.Event(), threading.Event()

    def sleep(duration: genpy.Duration) -> None:
        asleep.set()
        over.wait(60)
        raise ROSInterruptException("ROS shutdown request")

    monkeypatch.setattr("rospy.timer.sleep", sleep)
    timer = Timer(genpy.Duration(1), print)
    asleep.wait(60)
    monkeypatch.setattr(core, "_shutdown", True)
    over.set()
    timer.join(60)
    assert not timer.is_alive()


@pytest.mark.usefixtures("simulated", "by_hand")
def test_timer_that_is_shut_down_during_its_sleep_does_not_call(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    called: list[TimerEvent] = []
    timer = Timer(genpy.Duration(1), called.append)
    monkeypatch.setattr("rospy.timer.sleep", lambda _: timer.shutdown())
    timer.run()
    assert called == []


@pytest.mark.usefixtures("simulated", "by_hand")
def test_time_that_goes_back_ends_a_timer(monkeypatch: pytest.MonkeyPatch) -> None:
    def sleep(duration: genpy.Duration) -> None:
        raise ROSTimeMovedBackwardsException(7)

    monkeypatch.setattr("rospy.timer.sleep", sleep)
    with pytest.raises(ROSTimeMovedBackwardsException):
        Timer(genpy.Duration(1), print).run()
