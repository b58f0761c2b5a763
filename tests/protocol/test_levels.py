"""The levels of log messages in ROS and in Python."""

from __future__ import annotations

import logging

import pytest

from fibws.msg.rosgraph_msgs import Log
from fibws.protocol.levels import LEVELS, Level, named, severity, threshold


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
def test_message_between_two_levels_has_the_lower_one(python: int, ros: int) -> None:
    assert severity(python).ros == ros


@pytest.mark.parametrize("number", [0, 5, 10, 11, 20, 25, 30, 40, 49, 50])
def test_threshold_is_the_lowest_level_that_is_logged(number: int) -> None:
    log = logging.Logger("test", number)
    logged = [each for each in LEVELS if log.isEnabledFor(each.python)]
    assert threshold(number) == logged[0]


def test_threshold_above_all_levels_is_fatal() -> None:
    assert threshold(51).name == "fatal"


@pytest.mark.parametrize("each", LEVELS)
def test_level_is_found_by_its_name(each: Level) -> None:
    assert named(each.name) == named(each.name.upper()) == each
    assert named(f"{each.name} ") is None
