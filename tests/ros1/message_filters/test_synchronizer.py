"""Synchronizers."""

from __future__ import annotations

from typing import Any

import pytest
import rospy
from message_filters import ApproximateTimeSynchronizer, SimpleFilter, TimeSynchronizer
from std_msgs.msg import Header, String


class Clock:
    seconds = 1000.0
    simulated = False


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(rospy.Time, "now", lambda: rospy.Time.from_sec(clock.seconds))
    monkeypatch.setattr("rospy.rostime.is_wallclock", lambda: not clock.simulated)
    return clock


class Fed:
    """A synchronizer, and the stamps of its output in seconds."""

    def __init__(self, kind: Any, count: int, *args: Any, **named: Any) -> None:
        self.sources = [SimpleFilter() for _ in range(count)]
        self.synchronizer = kind(self.sources, *args, **named)
        self.output: list[list[float]] = []
        self.synchronizer.registerCallback(self._receive)

    def feed(self, source: int, *seconds: float) -> None:
        for each in seconds:
            message = type("Stamped", (), {"header": Header(stamp=rospy.Time.from_sec(each))})()
            self.sources[source].signalMessage(message)

    def _receive(self, *messages: Any) -> None:
        self.output.append([message.header.stamp.to_sec() for message in messages])


def test_messages_with_equal_stamps_are_matched() -> None:
    fed = Fed(TimeSynchronizer, 3, 10)
    fed.feed(0, 1, 2, 3)
    fed.feed(1, 2, 3, 4)
    fed.feed(2, 3, 2)
    assert fed.output == [[3, 3, 3], [2, 2, 2]]


def test_oldest_message_is_dropped() -> None:
    fed = Fed(TimeSynchronizer, 2, 2)
    fed.feed(0, 1, 2, 3)
    fed.feed(1, 1, 2)
    assert fed.output == [[2, 2]]


def test_messages_with_similar_stamps_are_matched() -> None:
    fed = Fed(ApproximateTimeSynchronizer, 2, 10, 0.1)
    fed.feed(0, 1.0, 1.06, 2.0)
    fed.feed(1, 1.05, 1.5, 2.2)
    assert fed.output == [[1.06, 1.05]]
    fed.feed(1, 1.01)
    assert fed.output[1:] == [[1.0, 1.01]]


def test_all_stamps_of_a_match_are_within_the_slop() -> None:
    fed = Fed(ApproximateTimeSynchronizer, 3, 10, 0.1)
    fed.feed(0, 1.0)
    fed.feed(1, 1.15)
    fed.feed(2, 1.07)
    assert fed.output == []
    fed.feed(1, 1.09)
    assert fed.output == [[1.0, 1.09, 1.07]]


def test_headerless_message_gets_the_current_time_if_allowed(clock: Clock) -> None:
    seen: list[Any] = []
    one, other = SimpleFilter(), SimpleFilter()
    synchronizer = ApproximateTimeSynchronizer([one, other], 10, 0.1, allow_headerless=True)
    synchronizer.registerCallback(lambda *messages: seen.append([each.data for each in messages]))
    one.signalMessage(String("a"))
    clock.seconds += 1
    other.signalMessage(String("b"))
    one.signalMessage(String("c"))
    assert seen == [["c", "b"]]


def test_headerless_message_is_dropped_with_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    warnings: list[str] = []
    monkeypatch.setattr(rospy, "logwarn", warnings.append)
    fed = Fed(ApproximateTimeSynchronizer, 2, 10, 0.1)
    fed.sources[0].signalMessage(String("a"))
    assert len(warnings) == 1
    assert fed.synchronizer.queues == [{}, {}]


def test_error_of_a_callback_does_not_affect_later_messages() -> None:
    fed = Fed(TimeSynchronizer, 2, 10)
    fed.synchronizer.registerCallback(lambda *messages: 1 / 0)
    fed.feed(0, 1, 2)
    with pytest.raises(ZeroDivisionError):
        fed.feed(1, 1)
    with pytest.raises(ZeroDivisionError):
        fed.feed(1, 2)
    assert fed.output == [[1, 1], [2, 2]]


@pytest.mark.parametrize("kind", [TimeSynchronizer, ApproximateTimeSynchronizer])
def test_queues_are_reset_when_simulated_time_goes_back(clock: Clock, kind: Any) -> None:
    slop = () if kind is TimeSynchronizer else (0.1,)
    fed = Fed(kind, 2, 10, *slop, reset=True)
    clock.simulated = True
    fed.feed(0, 1)
    clock.seconds = 500
    fed.feed(0, 2)
    fed.feed(1, 1, 2)
    assert [1, 1] not in fed.output


def test_approximate_queues_are_cleared_when_time_goes_back(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    logged: list[str] = []
    monkeypatch.setattr(rospy, "loginfo", logged.append)
    fed = Fed(ApproximateTimeSynchronizer, 2, 10, 0.1)
    fed.feed(0, 1)
    clock.seconds = 500
    fed.feed(1, 1)
    assert fed.output == []
    assert "Detected jump back in time. Clearing buffer." in logged[0]
