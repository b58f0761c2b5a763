"""Statistics of received messages, on /statistics."""

from __future__ import annotations

import asyncio

import pytest
from genpy.dynamic import generate_dynamic
from geometry_msgs.msg import PointStamped
from rospy import Time
from rospy.statistics import LENGTH_FIELD, Settings, Window
from std_msgs.msg import Int32

import fibws
from ros1.rospy.programs import running_hub

SETTINGS = Settings(min_elements=2, max_elements=4, min_window=0.5, max_window=8)


def stamped(seq: int, stamp: float) -> PointStamped:
    message = PointStamped()
    message.header.seq = seq
    message.header.stamp = Time.from_sec(stamp)
    return message


def test_window_measures_periods_ages_losses_and_traffic() -> None:
    window = Window(Time(100))
    window.add(stamped(7, 99.5), 40, Time(100))
    assert window.is_complete(Time(100))
    assert window.result(Time(100), SETTINGS)["delivered_msgs"] == 1

    window.add(stamped(8, 100.0), 40, Time(101))
    window.add(stamped(11, 102.0), 40, Time(104))
    found = window.result(Time(104), SETTINGS)

    assert (found["window_start"], found["window_stop"]) == (Time(100), Time(104))
    assert (found["delivered_msgs"], found["dropped_msgs"], found["traffic"]) == (2, 2, 80)
    assert found["period_mean"].to_sec() == found["period_max"].to_sec() == 3.0
    assert found["stamp_age_mean"].to_sec() == 1.5
    assert found["stamp_age_stddev"].to_sec() == 0.5
    assert found["stamp_age_max"].to_sec() == 2.0


def test_window_adapts_to_the_rate_of_messages() -> None:
    window = Window(Time(0))
    window.add(Int32(), 4, Time(0))
    window.result(Time(0), SETTINGS)  # 1 message is too few: the next window has 2 s.
    assert not window.is_complete(Time(2))
    assert window.is_complete(Time.from_sec(2.1))
    for _ in range(5):
        window.add(Int32(), 4, Time(3))
    window.result(Time(3), SETTINGS)  # 5 messages are too many: 1 s.
    assert not window.is_complete(Time(4))
    assert window.is_complete(Time.from_sec(4.1))
    assert window.is_complete(Time(1)), "time has jumped back"


def test_header_without_seq_has_an_age_and_no_losses() -> None:
    text = f"Header header\n{'=' * 80}\nMSG: std_msgs/Header\ntime stamp\nstring frame_id\n"
    message = generate_dynamic("own/Stamped", text)["own/Stamped"]()
    window = Window(Time(0))
    window.add(message, 12, Time(5))
    window.add(message, 12, Time(5))
    found = window.result(Time(5), SETTINGS)
    assert (found["delivered_msgs"], found["dropped_msgs"]) == (2, 0)
    assert found["stamp_age_mean"].to_sec() == 5.0


def test_messages_without_a_header_have_no_age() -> None:
    window = Window(Time(0))
    window.add(Int32(), 4, Time(0))
    found = window.result(Time(0), SETTINGS)
    assert found["dropped_msgs"] == 0
    assert found["stamp_age_max"].to_sec() == 0


@pytest.mark.parametrize("is_enabled", [True, False])
async def test_subscriber_publishes_statistics_if_they_are_enabled(is_enabled: bool) -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        await node.params.set("/enable_statistics", is_enabled)
        results = node.subscribe("/statistics", "rosgraph_msgs/TopicStatistics")
        numbers = await node.advertise("numbers", "std_msgs/Int32")
        program = await programs.start("""
            import rospy
            from std_msgs.msg import Int32

            rospy.init_node("listener")
            rospy.Subscriber("numbers", Int32, lambda message: print(message.data, flush=True))
            rospy.spin()
        """)

        async def publish() -> None:
            while True:
                await numbers.publish(7)
                await asyncio.sleep(0.01)

        publishing = asyncio.create_task(publish())
        try:
            for _ in range(20):
                assert await program.read_line() == "7"
            publishers = await node.graph.publishers("/statistics")
            assert publishers == (["/listener"] if is_enabled else [])
            if is_enabled:
                found = await anext(results)
                assert (found.topic, found.node_pub, found.node_sub) == (
                    "/numbers",
                    "/talker",
                    "/listener",
                )
                assert (found.delivered_msgs, found.traffic) == (1, 4 + LENGTH_FIELD)
        finally:
            publishing.cancel()
