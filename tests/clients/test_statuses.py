"""Statuses of the hub for invalid operations."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("statuses")


def test_invalid_message_is_refused_with_the_reason(seen: Any) -> None:
    assert seen == [
        "error: publish: std_msgs/Int32 message requires an int32 for field data, but got a str"
    ]


def test_topic_keeps_its_type(seen: Any) -> None:
    [status] = seen
    assert status.startswith(
        "error: advertise: Tried to register topic /strict with type std_msgs/String "
        "but it is already established with type std_msgs/Int32"
    )
