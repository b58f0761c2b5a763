"""What is otherwise where the hub is a rosbridge of ROS's own, which tells less."""

from __future__ import annotations

from collections.abc import Coroutine
from typing import Any

from rospy import core
from rospy.exceptions import ROSInterruptException

PATIENCE = 1.0
"""Seconds that an answer may take; while there is no hub, there is none."""


def count_nodes(question: Coroutine[Any, Any, list[str]]) -> int:
    """How many nodes the hub names; 0 if it does not answer.

    Args:
        question: is asked of the hub, in any thread but the loop's.
    """
    from fibws.errors import FibwsError

    try:
        return len(core.background.call(question, PATIENCE))
    except (FibwsError, TimeoutError, ROSInterruptException):
        return 0
