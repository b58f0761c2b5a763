"""The messages of move_base_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, std_msgs

__all__ = [
    "MoveBaseAction",
    "MoveBaseActionFeedback",
    "MoveBaseActionGoal",
    "MoveBaseActionResult",
    "MoveBaseFeedback",
    "MoveBaseGoal",
    "MoveBaseResult",
    "RecoveryStatus",
]


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseGoal(ros.Message):
    """move_base_msgs/MoveBaseGoal"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseGoal"

    target_pose: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseActionGoal(ros.Message):
    """move_base_msgs/MoveBaseActionGoal"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: MoveBaseGoal = field(default_factory=lambda: MoveBaseGoal())


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseResult(ros.Message):
    """move_base_msgs/MoveBaseResult"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseResult"


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseActionResult(ros.Message):
    """move_base_msgs/MoveBaseActionResult"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: MoveBaseResult = field(default_factory=lambda: MoveBaseResult())


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseFeedback(ros.Message):
    """move_base_msgs/MoveBaseFeedback"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseFeedback"

    base_position: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseActionFeedback(ros.Message):
    """move_base_msgs/MoveBaseActionFeedback"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: MoveBaseFeedback = field(default_factory=lambda: MoveBaseFeedback())


@dataclass(slots=True, eq=False, repr=False)
class MoveBaseAction(ros.Message):
    """move_base_msgs/MoveBaseAction"""

    _type: ClassVar[str] = "move_base_msgs/MoveBaseAction"

    action_goal: MoveBaseActionGoal = field(default_factory=lambda: MoveBaseActionGoal())
    action_result: MoveBaseActionResult = field(default_factory=lambda: MoveBaseActionResult())
    action_feedback: MoveBaseActionFeedback = field(
        default_factory=lambda: MoveBaseActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class RecoveryStatus(ros.Message):
    """move_base_msgs/RecoveryStatus"""

    _type: ClassVar[str] = "move_base_msgs/RecoveryStatus"

    pose_stamped: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )
    current_recovery_number: int = 0
    total_number_of_recoveries: int = 0
    recovery_behavior_name: str = ""
