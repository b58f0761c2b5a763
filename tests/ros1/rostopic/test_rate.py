"""Rates of topics."""

from __future__ import annotations

import math

import pytest
import rospy
from geometry_msgs.msg import PointStamped
from rostopic import ROSTopicBandwidth, ROSTopicDelay, ROSTopicHz
from std_msgs.msg import Header


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


def test_delays_are_computed_from_stamps(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    delay = ROSTopicDelay(-1)
    delay.print_delay()
    for clock.seconds, stamp in ((2.0, 1.5), (3.0, 2.75), (4.0, 3.75)):
        delay.callback_delay(PointStamped(header=Header(stamp=rospy.Time.from_sec(stamp))))
    delay.print_delay()
    delay.print_delay()
    assert capsys.readouterr().out == (
        "no new messages\n"
        "average delay: 0.333\n\tmin: 0.250s max: 0.500s std dev: 0.11785s window: 3\n"
        "no new messages\n"
    )


def test_bandwidth_is_computed_from_sizes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    moments = iter((1.0, 1.5, 2.0, 3.0))
    monkeypatch.setattr("rostopic.time", lambda: next(moments))
    bandwidth = ROSTopicBandwidth(2)
    for size in (99, 1000, 3000):
        bandwidth.callback(rospy.AnyMsg().deserialize(bytes(size)))
    bandwidth.print_bw()
    assert capsys.readouterr().out == (
        "average: 2.67KB/s\n\tmean: 2.00KB min: 1.00KB max: 3.00KB window: 2\n"
    )
