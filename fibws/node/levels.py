"""How grave a line of the log is, in ROS's words (http://wiki.ros.org/Verbosity%20Levels)."""

from __future__ import annotations

import logging
from typing import NamedTuple


class Level(NamedTuple):
    """One of ROS's five: its name, its number in Python's logging and in rosgraph_msgs/Log."""

    name: str
    python: int
    ros: int


LEVELS = (
    Level("debug", logging.DEBUG, 1),
    Level("info", logging.INFO, 2),
    Level("warn", logging.WARNING, 4),
    Level("error", logging.ERROR, 8),
    Level("fatal", logging.CRITICAL, 16),
)


def level(number: int) -> Level:
    """The level for one of Python's numbers, which may be in between: then it is the one below."""
    return next((each for each in reversed(LEVELS) if each.python <= number), LEVELS[0])
