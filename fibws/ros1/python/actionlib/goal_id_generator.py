"""Names for goals that came without one."""

from __future__ import annotations

from itertools import count
from typing import Any

import rospy
from actionlib_msgs.msg import GoalID

_numbers = count(1)


class GoalIDGenerator:
    """Makes up the names of goals.

    Args:
        name: what they begin with; the node's global name if it is not given.
    """

    def __init__(self, name: str | None = None) -> None:
        self.name = rospy.get_name() if name is None else name

    def set_name(self, name: str) -> None:
        """Have names begin with another word."""
        self.name = name

    def generate_ID(self) -> Any:
        """A ``GoalID`` that nobody else has, of now."""
        now = rospy.Time.now()
        return GoalID(stamp=now, id=f"{self.name}-{next(_numbers)}-{now.secs}.{now.nsecs}")
