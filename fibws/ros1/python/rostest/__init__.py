"""Runs a script's tests of a node: ``rostest.rosrun(package, name, TestCase)``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import rosunit
from roslib.scriptutil import is_publisher, is_subscriber

__all__ = ["is_publisher", "is_subscriber", "rosrun", "run", "unitrun"]


def rosrun(package: str, test_name: str, test: Any, sysargs: Sequence[str] | None = None) -> None:
    """Run a script's tests and end its node; exit with code 1 if a test failed.

    Args:
        package: the script's package.
        test_name: the name of the tests.
        test: a class of tests, or the name of one.
        sysargs: the command line: ``--text`` prints the tests' own output,
            ``--gtest_output=xml:FILE`` writes the results to a file.
    """
    import rospy

    result = rosunit.run(package, test_name, test, sysargs)
    rospy.signal_shutdown("test complete")
    if not result.wasSuccessful():
        sys.exit(1)


run = rosrun
unitrun = rosunit.unitrun
