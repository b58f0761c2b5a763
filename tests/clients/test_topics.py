"""Topics, with each client."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("topics")


def test_message_reaches_another_client(seen: Any) -> None:
    assert seen == [{"data": "hello"}, {"data": "wörld 🌍"}]


def test_client_receives_its_own_messages(seen: Any) -> None:
    assert seen == [{"data": 8}]


def test_message_of_many_fields_arrives_as_it_was_sent(seen: Any) -> None:
    none = {"x": 0, "y": 0, "z": 0}
    assert seen == {
        "header": {"seq": 1, "stamp": {"secs": 12, "nsecs": 34}, "frame_id": "base_link"},
        "orientation": {**none, "w": 1},
        "orientation_covariance": [1.5, 0, 0, 0, None, 0, 0, 0, -2],
        "angular_velocity": none,
        "angular_velocity_covariance": [0] * 9,
        "linear_acceleration": {**none, "z": -9.81},
        "linear_acceleration_covariance": [0] * 9,
    }


def test_late_subscriber_receives_the_latched_message_once(seen: Any) -> None:
    assert seen == [{"data": "cellar"}]


def test_throttled_subscriber_receives_the_first_message_and_then_the_newest(seen: Any) -> None:
    assert seen == [0, 9]


def test_queue_of_a_throttled_subscriber_is_sent_after_the_first_message(seen: Any) -> None:
    assert seen == [0, 7, 8, 9]


def test_throttled_subscriber_without_a_queue_misses_early_messages(seen: Any) -> None:
    assert seen[0] == 0
    assert set(seen[1:]) == {10}


def test_two_subscribers_of_one_client_receive_each_message_once(seen: Any) -> None:
    assert seen == [[1, 2], [1, 2]]


def test_topic_may_be_spelled_without_its_slash_and_its_type_as_in_ROS_2(seen: Any) -> None:
    assert seen == [{"data": "hello"}]


def test_message_of_megabytes_arrives(seen: Any) -> None:
    assert seen is True


def test_no_message_arrives_after_unsubscribing(seen: Any) -> None:
    assert [message["data"] for message in seen] == [1, 3]


def test_topic_disappears_with_its_last_publisher(seen: Any) -> None:
    assert seen == {"before": True, "after": False}
