"""Ids for goals that have none."""

from __future__ import annotations

from itertools import count
from typing import Any

import rospy
from actionlib_msgs.msg import GoalID

_numbers = count(1)


class GoalIDGenerator:
    """Generates ids of goals.

    Args:
        name: the start of the ids; by default the node's global name.
    """

    def __init__(self, name: str | None = None) -> None:
        self.name = rospy.get_name() if name is None else name

    def set_name(self, name: str) -> None:
        """Set the start of the ids."""
        self.name = name

    def generate_ID(self) -> Any:
        """Return a unique ``GoalID`` with the current time."""
        now = rospy.Time.now()
        return GoalID(stamp=now, id=f"{self.name}-{next(_numbers)}-{now.secs}.{now.nsecs}")
