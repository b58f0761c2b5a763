"""The levels of a log, as ROS and Python have them."""

from __future__ import annotations

import logging

import pytest

from fibws.msg.rosgraph_msgs import Log
from fibws.node.levels import level


@pytest.mark.parametrize(
    ("python", "ros"),
    [
        (logging.DEBUG, Log.DEBUG),
        (5, Log.DEBUG),
        (logging.INFO, Log.INFO),
        (25, Log.INFO),
        (logging.WARNING, Log.WARN),
        (logging.ERROR, Log.ERROR),
        (logging.CRITICAL, Log.FATAL),
        (99, Log.FATAL),
    ],
)
def test_levels_are_those_of_ros(python: int, ros: int) -> None:
    assert level(python).ros == ros
