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
"""From the least to the gravest."""


def named(name: str) -> Level | None:
    """The level of a name, which may be in capitals."""
    return next((each for each in LEVELS if each.name == name.lower()), None)


def severity(number: int) -> Level:
    """How grave a line with one of Python's numbers is: in between, as grave as the level below."""
    return next((each for each in reversed(LEVELS) if each.python <= number), LEVELS[0])


def threshold(number: int) -> Level:
    """The least level that a logger with one of Python's numbers logs: in between, that above."""
    return next((each for each in LEVELS if each.python >= number), LEVELS[-1])
