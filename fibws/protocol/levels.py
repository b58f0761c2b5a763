"""The levels of log messages in ROS and in Python (http://wiki.ros.org/Verbosity%20Levels)."""

from __future__ import annotations

import logging
from typing import NamedTuple


class Level(NamedTuple):
    """A level of ROS: its name, its number in Python's logging, its number in rosgraph_msgs/Log."""

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
"""All levels, from the least severe to the most severe."""


def named(name: str) -> Level | None:
    """Return the level of a name in any case, or None if it is unknown."""
    return next((each for each in LEVELS if each.name == name.lower()), None)


def severity(number: int) -> Level:
    """Return the level of a message by its number in Python: between two levels, the lower one."""
    return next((each for each in reversed(LEVELS) if each.python <= number), LEVELS[0])


def threshold(number: int) -> Level:
    """Return the lowest level that a logger of a Python level logs: between two, the upper one."""
    return next((each for each in LEVELS if each.python >= number), LEVELS[-1])
