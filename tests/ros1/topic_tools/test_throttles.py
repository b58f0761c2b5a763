"""Which messages throttle passes on; its programs are tested as programs."""

from __future__ import annotations

import pytest
import rospy
from topic_tools import programs


def test_throttles_count_messages_and_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    monkeypatch.setattr(rospy, "get_time", lambda: now)
    message = rospy.AnyMsg().deserialize(b"1234")
    by_messages, by_bytes = programs.Throttle(2.0), programs.ByteThrottle(5.0, 1.0)
    passed: dict[str, list[float]] = {"messages": [], "bytes": []}
    for step in [*range(12), 1]:  # At the end, simulated time starts again.
        now = step * 0.25
        if by_messages.passes(message):
            passed["messages"].append(now)
        if by_bytes.passes(message):
            passed["bytes"].append(now)
    assert passed["messages"] == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 0.25]
    assert passed["bytes"] == [0.0, 0.25, 1.0, 1.25, 2.0, 2.25, 0.25]
