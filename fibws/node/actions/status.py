"""What becomes of a goal: actionlib's states, and which may follow which.

Source: http://wiki.ros.org/actionlib/DetailedDescription, the server's state machine.
"""

from __future__ import annotations

from enum import Enum, IntEnum, auto


class GoalStatus(IntEnum):
    """The state of a goal, with the numbers of actionlib_msgs/GoalStatus.

    ROS 2 has fewer (action_msgs/GoalStatus), each of which is called here by an actionlib name.
    """

    PENDING = 0
    """The server has yet to begin it; ROS 2: ACCEPTED."""
    ACTIVE = 1
    """The server pursues it; ROS 2: EXECUTING."""
    PREEMPTED = 2
    """It was canceled after it had begun; ROS 2: CANCELED."""
    SUCCEEDED = 3
    """It was reached; so in ROS 2."""
    ABORTED = 4
    """The server gave it up; so in ROS 2."""
    REJECTED = 5
    """The server would not have it."""
    PREEMPTING = 6
    """It is to be canceled and has begun; ROS 2: CANCELING."""
    RECALLING = 7
    """It is to be canceled and has not begun."""
    RECALLED = 8
    """It was canceled before it began."""
    LOST = 9
    """Nothing is heard of it any more, which its client concludes; ROS 2: UNKNOWN."""

    def __str__(self) -> str:
        return self.name

    @property
    def is_final(self) -> bool:
        """Whether no other status can follow."""
        return self in _FINAL

    @property
    def ros2(self) -> int:
        """The number that ROS 2 has for it."""
        return _ROS2[self]


class Transition(Enum):
    """What can happen to a goal."""

    ACCEPT = auto()
    REJECT = auto()
    CANCEL_REQUEST = auto()
    CANCEL = auto()
    SUCCEED = auto()
    ABORT = auto()


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

_FOLLOWING = {
    Transition.ACCEPT: {
        GoalStatus.PENDING: GoalStatus.ACTIVE,
        GoalStatus.RECALLING: GoalStatus.PREEMPTING,
    },
    Transition.REJECT: {
        GoalStatus.PENDING: GoalStatus.REJECTED,
        GoalStatus.RECALLING: GoalStatus.REJECTED,
    },
    Transition.CANCEL_REQUEST: {
        GoalStatus.PENDING: GoalStatus.RECALLING,
        GoalStatus.ACTIVE: GoalStatus.PREEMPTING,
    },
    Transition.CANCEL: {
        GoalStatus.PENDING: GoalStatus.RECALLED,
        GoalStatus.RECALLING: GoalStatus.RECALLED,
        GoalStatus.ACTIVE: GoalStatus.PREEMPTED,
        GoalStatus.PREEMPTING: GoalStatus.PREEMPTED,
    },
    Transition.SUCCEED: {
        GoalStatus.ACTIVE: GoalStatus.SUCCEEDED,
        GoalStatus.PREEMPTING: GoalStatus.SUCCEEDED,
    },
    Transition.ABORT: {
        GoalStatus.ACTIVE: GoalStatus.ABORTED,
        GoalStatus.PREEMPTING: GoalStatus.ABORTED,
    },
}

_ROS2 = {
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

_OF_ROS2 = (
    GoalStatus.LOST,
    GoalStatus.PENDING,
    GoalStatus.ACTIVE,
    GoalStatus.PREEMPTING,
    GoalStatus.SUCCEEDED,
    GoalStatus.PREEMPTED,
    GoalStatus.ABORTED,
)


def following(status: GoalStatus, transition: Transition) -> GoalStatus | None:
    """The status after ``transition``; None if that changes nothing or cannot happen any more."""
    return _FOLLOWING[transition].get(status)


def of_ros2(number: int) -> GoalStatus:
    """The status that ROS 2 gives the number, from 0 to 6."""
    return _OF_ROS2[number]
