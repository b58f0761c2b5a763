"""Wall time and simulated time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from itertools import count

import genpy
import pytest
from rospy import core, rostime
from rospy.exceptions import ROSInitException, ROSInterruptException, ROSTimeMovedBackwardsException
from rospy.rostime import Duration, Time


@pytest.fixture
def wall() -> Iterator[None]:
    """Time is initialized, and is wall time."""
    rostime.set_rostime_initialized(True)
    yield
    rostime.switch_to_wallclock()
    rostime.set_rostime_initialized(False)


def test_time_is_an_error_before_init_node() -> None:
    assert not rostime.is_rostime_initialized()
    for ask in Time.now, rostime.get_time, rostime.get_rostime:
        with pytest.raises(ROSInitException, match="Have you called init_node"):
            ask()


@pytest.mark.usefixtures("wall")
def test_time_is_wall_time() -> None:
    before = time.time()
    now = Time.now()
    assert isinstance(now, Time)
    assert before - 1e-3 <= now.to_sec() <= rostime.get_time() <= time.time() + 1e-3
    assert rostime.is_wallclock()


@pytest.mark.usefixtures("wall")
def test_simulated_time_stands_still_until_it_is_set() -> None:
    rostime.set_rostime(genpy.Time(5, 7))
    assert repr(Time.now()) == "rospy.Time[5000000007]"
    assert not rostime.is_wallclock()
    rostime.set_rostime(genpy.Time(0))
    assert rostime.get_time() == 0
    with pytest.raises(ValueError, match="must be Time instance"):
        rostime.set_rostime(5)  # type: ignore[arg-type]


def test_repr_is_that_of_rospy() -> None:
    assert repr(Time(1, 5)) == "rospy.Time[1000000005]"
    assert repr(Duration(1.5)) == "rospy.Duration[1500000000]"
    assert repr(Time(3) - Duration(1)) == "rospy.Time[2000000000]"
    assert Time.from_seconds(1.5) == Time(1, 500_000_000)


@pytest.mark.usefixtures("wall")
@pytest.mark.parametrize("duration", [0.02, Duration(0, 20_000_000), genpy.Duration(0.02)])
def test_sleep_takes_its_duration(duration: float | genpy.Duration) -> None:
    began = time.monotonic()
    rostime.sleep(duration)
    assert 0.02 <= time.monotonic() - began


@pytest.mark.usefixtures("wall")
def test_negative_sleep_returns_at_once() -> None:
    rostime.sleep(-3600)  # More than a test may take.
    rostime.sleep(Duration(-3600))
    rostime.sleep(0)


@pytest.mark.usefixtures("wall")
@pytest.mark.parametrize("sleep", [rostime.sleep, rostime.wallsleep])
def test_shutdown_ends_a_sleep_without_an_exception(
    monkeypatch: pytest.MonkeyPatch, sleep: Callable[[float], None]
) -> None:
    sleeper = threading.Thread(target=sleep, args=(3600,), daemon=True)
    sleeper.start()
    while not core.wakeup._sleepers:
        pass
    monkeypatch.setattr(core, "_shutdown", True)
    core.wakeup.wake_all()
    sleeper.join(60)
    assert not sleeper.is_alive()
    late = threading.Thread(target=sleep, args=(3600,), daemon=True)
    late.start()
    late.join(60)
    assert not late.is_alive()


@pytest.mark.usefixtures("wall")
@pytest.mark.parametrize("duration", [0.02, Duration(0, 20_000_000)])
def test_sleep_of_a_thread_that_knows_of_shutdown_takes_its_duration(
    monkeypatch: pytest.MonkeyPatch, duration: float | genpy.Duration
) -> None:
    monkeypatch.setattr(core, "_shutdown", True)
    assert core.is_shutdown()
    began = time.monotonic()
    rostime.sleep(duration)
    assert 0.02 <= time.monotonic() - began


@pytest.mark.usefixtures("wall")
def test_shutdown_interrupts_a_sleep_of_simulated_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(core, "_shutdown", True)
    rostime.set_rostime(genpy.Time(1))
    with pytest.raises(ROSInterruptException, match="ROS shutdown request"):
        rostime.sleep(3600)


def test_wallsleep_needs_no_node() -> None:
    began = time.monotonic()
    rostime.wallsleep(0.02)
    assert 0.02 <= time.monotonic() - began
    rostime.wallsleep(-1)


class Sleeper(threading.Thread):
    """Sleeps for a second of simulated time, and keeps the error."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.raised: Exception | None = None

    def run(self) -> None:
        try:
            rostime.sleep(1)
        except ROSTimeMovedBackwardsException as error:
            self.raised = error


@pytest.mark.usefixtures("wall")
def test_sleep_in_simulated_time_begins_with_the_first_time() -> None:
    rostime.set_rostime(genpy.Time())
    sleeper = Sleeper()
    sleeper.start()
    rostime.set_rostime(genpy.Time(100))
    for second in count(101):
        sleeper.join(0.01)
        if not sleeper.is_alive():
            break
        rostime.set_rostime(genpy.Time(second))
    assert sleeper.raised is None
    assert rostime.get_time() >= 101


@pytest.mark.usefixtures("wall")
def test_time_that_goes_back_interrupts_a_sleep() -> None:
    rostime.set_rostime(genpy.Time(100))
    sleeper = Sleeper()
    sleeper.start()
    while not core.wakeup._sleepers:
        pass
    rostime.set_rostime(genpy.Time(40))
    sleeper.join(60)
    assert isinstance(sleeper.raised, ROSTimeMovedBackwardsException)
    assert 0 < sleeper.raised.time <= 60
