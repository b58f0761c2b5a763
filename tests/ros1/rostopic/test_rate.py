"""Rates of topics."""

from __future__ import annotations

import math

import pytest
import rospy
from rostopic import ROSTopicHz


class Clock:
    seconds = 0.0


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time.from_sec(clock.seconds))
    return clock


def test_rate_is_computed_from_intervals(clock: Clock) -> None:
    rate = ROSTopicHz(-1)
    assert rate.get_hz() is None
    for clock.seconds in (0.0, 1.0, 1.5, 2.5, 3.0):
        rate.callback_hz(None)
    found = rate.get_hz()
    assert found == pytest.approx((1.5, 0.5, 1.0, 1 / math.sqrt(18), 4))
    assert rate.get_hz() is None


def test_topics_have_separate_rates(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    rate = ROSTopicHz(10)
    for clock.seconds in (1.0, 2.0):
        rate.callback_hz(None, "/a")
    rate.print_hz(["/a"])
    rate.print_hz(["/b"])
    assert capsys.readouterr().out == (
        "average rate: 1.000\n\tmin: 1.000s max: 1.000s std dev: 0.00000s window: 2\n"
        "no new messages\n"
    )


def test_filtered_messages_are_not_counted(clock: Clock) -> None:
    rate = ROSTopicHz(10, filter_expr=lambda message: message != "b")
    for clock.seconds, message in ((1.0, "a"), (2.0, "b"), (3.0, "a")):
        rate.callback_hz(message)
    found = rate.get_hz()
    assert found is not None
    assert found[4] == 2


def test_wall_time_can_be_used(clock: Clock) -> None:
    rate = ROSTopicHz(10, use_wtime=True)
    rate.callback_hz(None)
    rate.callback_hz(None)
    assert rate.get_hz() is not None
