"""Caches."""

from __future__ import annotations

from typing import Any

import pytest
import rospy
from message_filters import Cache, SimpleFilter
from std_msgs.msg import Header, String


class Stamped:
    def __init__(self, seconds: float) -> None:
        self.header = Header(stamp=rospy.Time.from_sec(seconds))

    def __repr__(self) -> str:
        return str(self.header.stamp.to_sec())


@pytest.fixture
def source() -> SimpleFilter:
    return SimpleFilter()


def filled(source: SimpleFilter, *seconds: float, size: int = 3) -> tuple[Cache, list[Stamped]]:
    cache = Cache(source, size)
    messages = [Stamped(each) for each in seconds]
    for message in messages:
        source.signalMessage(message)
    return cache, messages


def test_latest_messages_are_kept(source: SimpleFilter) -> None:
    cache, messages = filled(source, 1, 2, 3, 4)
    assert cache.cache_msgs == messages[1:]
    assert cache.cache_times == [rospy.Time(2), rospy.Time(3), rospy.Time(4)]
    assert (cache.getOldestTime(), cache.getLatestTime()) == (rospy.Time(2), rospy.Time(4))
    assert cache.getLastestTime() == rospy.Time(4)
    assert cache.getLast() is messages[-1]


def test_messages_are_found_by_time(source: SimpleFilter) -> None:
    cache, (_, two, three) = filled(source, 1, 2, 3)
    assert cache.getInterval(rospy.Time(2), rospy.Time(3)) == [two, three]
    assert cache.getElemBeforeTime(rospy.Time.from_sec(2.5)) is two
    assert cache.getElemAfterTime(rospy.Time.from_sec(1.5)) is two
    assert cache.getElemAfterTime(rospy.Time(4)) is None
    assert cache.getElemBeforeTime(rospy.Time(0)) is None
    with pytest.raises(AssertionError):
        cache.getInterval(rospy.Time(3), rospy.Time(2))


def test_empty_cache_returns_none(source: SimpleFilter) -> None:
    cache = Cache(source)
    assert cache.getLast() is cache.getLatestTime() is cache.getOldestTime() is None


def test_messages_are_output(source: SimpleFilter) -> None:
    cache, seen = Cache(source), list[Any]()
    cache.registerCallback(seen.append)
    message = Stamped(1)
    source.signalMessage(message)
    assert seen == [message]


def test_headerless_messages_get_the_current_time_if_allowed(
    source: SimpleFilter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rospy.Time, "now", lambda: rospy.Time(7))
    cache = Cache(source, allow_headerless=True)
    source.signalMessage(String("a"))
    assert cache.getLatestTime() == rospy.Time(7)


def test_headerless_messages_are_dropped_with_a_warning(
    source: SimpleFilter, monkeypatch: pytest.MonkeyPatch
) -> None:
    warnings: list[str] = []
    monkeypatch.setattr(rospy, "logwarn", warnings.append)
    cache = Cache(source)
    source.signalMessage(String("a"))
    assert cache.getLast() is None
    assert "Use the 'allow_headerless' constructor option" in warnings[0]
