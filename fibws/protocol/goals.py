"""Goals of actions: their status, their ids, and the topics of an action in ROS 1.

Source: http://wiki.ros.org/actionlib/DetailedDescription.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

LOST_AFTER = 5.0
"""Seconds without a message about a goal, or from its server, after which it counts as lost."""


class GoalStatus(IntEnum):
    """The state of a goal, with the numbers of actionlib_msgs/GoalStatus.

    ROS 2 has fewer states (action_msgs/GoalStatus); each has the name of one of actionlib here.
    """

    PENDING = 0
    """The server has not begun yet; ROS 2: ACCEPTED."""
    ACTIVE = 1
    """The server executes the goal; ROS 2: EXECUTING."""
    PREEMPTED = 2
    """Canceled after it had begun; ROS 2: CANCELED."""
    SUCCEEDED = 3
    """The goal was reached; ROS 2: SUCCEEDED."""
    ABORTED = 4
    """The server gave up; ROS 2: ABORTED."""
    REJECTED = 5
    """The server refused the goal."""
    PREEMPTING = 6
    """Being canceled after it has begun; ROS 2: CANCELING."""
    RECALLING = 7
    """Being canceled before it has begun."""
    RECALLED = 8
    """Canceled before it had begun."""
    LOST = 9
    """The client gave up waiting for the server, or lost the hub; ROS 2: UNKNOWN."""

    def __str__(self) -> str:
        return self.name

    @property
    def is_final(self) -> bool:
        """Whether no other status can follow."""
        return self in _FINAL

    @property
    def ros2(self) -> int:
        """The number of the corresponding status of ROS 2."""
        return _TO_ROS2[self]


_FINAL = frozenset(
    {
        GoalStatus.PREEMPTED,
        GoalStatus.SUCCEEDED,
        GoalStatus.ABORTED,
        GoalStatus.REJECTED,
        GoalStatus.RECALLED,
        GoalStatus.LOST,
    }
)

_TO_ROS2 = {
    GoalStatus.PENDING: 1,
    GoalStatus.ACTIVE: 2,
    GoalStatus.PREEMPTED: 5,
    GoalStatus.SUCCEEDED: 4,
    GoalStatus.ABORTED: 6,
    GoalStatus.REJECTED: 6,
    GoalStatus.PREEMPTING: 3,
    GoalStatus.RECALLING: 3,
    GoalStatus.RECALLED: 5,
    GoalStatus.LOST: 0,
}

_FROM_ROS2 = (
    GoalStatus.LOST,
    GoalStatus.PENDING,
    GoalStatus.ACTIVE,
    GoalStatus.PREEMPTING,
    GoalStatus.SUCCEEDED,
    GoalStatus.PREEMPTED,
    GoalStatus.ABORTED,
)


def status_from_ros2(number: int) -> GoalStatus:
    """Return the status that corresponds to a number of ROS 2, which is from 0 to 6."""
    return _FROM_ROS2[number]


def goal_id(node: str, number: int, stamp: int) -> str:
    """Return a goal's id as actionlib writes it: ``/node-1-1700000000.125``.

    It is unique on the graph if each of the node's goals has another number.

    Args:
        node: the node's global name.
        number: the number of the node's goal.
        stamp: the time in nanoseconds since 1970.
    """
    return f"{node}-{number}-{stamp / 1e9:.3f}"


class ActionTopic(NamedTuple):
    """One of an action's topics: the end of its name, and its type with a gap for the action's."""

    name: str
    type: str

    def type_of(self, action: str) -> str:
        """Return the topic's type for an action of a type."""
        return self.type.format(action=action)


GOAL = ActionTopic("goal", "{action}ActionGoal")
CANCEL = ActionTopic("cancel", "actionlib_msgs/GoalID")
STATUS = ActionTopic("status", "actionlib_msgs/GoalStatusArray")
FEEDBACK = ActionTopic("feedback", "{action}ActionFeedback")
RESULT = ActionTopic("result", "{action}ActionResult")
