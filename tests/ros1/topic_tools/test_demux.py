"""Which messages a demux passes on, without a node."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import pytest
from topic_tools import programs


class Outputs:
    """The topics of a demux, and what is published on them."""

    def __init__(self) -> None:
        self.published: list[tuple[str, Any]] = []

    def __call__(self, topic: str) -> Any:
        return SimpleNamespace(publish=lambda message: self.published.append((topic, message)))


def test_no_message_is_passed_on_while_none_is_selected(monkeypatch: pytest.MonkeyPatch) -> None:
    """A program cannot show it: a node takes messages and calls in threads of their own."""
    services: dict[str, Any] = {}
    rospy = Mock()
    rospy.resolve_name = lambda name: name
    rospy.get_param = lambda name, default: default
    rospy.Service = lambda name, type_, function: services.setdefault(name, function)
    outputs = Outputs()
    monkeypatch.setattr(programs, "rospy", rospy)
    monkeypatch.setattr(programs, "Output", outputs)
    programs.Demux("/in", ["/first", "/second"])
    _, _, forward = rospy.Subscriber.call_args.args
    for number, topic in enumerate(("/second", programs.NONE, "/first")):
        forward(f"before {number}")
        services["~select"](SimpleNamespace(topic=topic))
    forward("last")
    assert outputs.published == [
        ("/first", "before 0"),
        ("/second", "before 1"),
        ("/first", "last"),
    ]
