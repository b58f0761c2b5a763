"""Runs the tests of a node that a script ends with: ``rostest.rosrun(package, name, TestCase)``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import rosunit

__all__ = ["is_publisher", "is_subscriber", "rosrun", "run", "unitrun"]


def rosrun(package: str, test_name: str, test: Any, sysargs: Sequence[str] | None = None) -> None:
    """Run a script's tests and end its node; end the program with code 1 if one went wrong.

    Args:
        package: the script's package.
        test_name: what the tests are called.
        test: a class of tests, or the name by which such are found.
        sysargs: the command line: ``--text`` has the tests' own output printed, and
            ``--gtest_output=xml:FILE`` the results written to a file.
    """
    import rospy

    result = rosunit.run(package, test_name, test, sysargs)
    rospy.signal_shutdown("test complete")
    if not result.wasSuccessful():
        sys.exit(1)


run = rosrun
unitrun = rosunit.unitrun


def is_subscriber(topic: str, subscriber_id: str) -> bool:
    """Whether a node subscribes to a topic; both names are global.

    Raises:
        OSError: there is no hub.
    """
    return _is_end(1, topic, subscriber_id)


def is_publisher(topic: str, publisher_id: str) -> bool:
    """Whether a node publishes a topic; both names are global.

    Raises:
        OSError: there is no hub.
    """
    return _is_end(0, topic, publisher_id)


def _is_end(kind: int, topic: str, node: str) -> bool:
    import rosgraph

    state = rosgraph.Master("/rostest").getSystemState()
    return any(node in nodes for name, nodes in state[kind] if name == topic)
