"""The messages of control_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, std_msgs, trajectory_msgs

__all__ = [
    "FollowJointTrajectoryAction",
    "FollowJointTrajectoryActionFeedback",
    "FollowJointTrajectoryActionGoal",
    "FollowJointTrajectoryActionResult",
    "FollowJointTrajectoryFeedback",
    "FollowJointTrajectoryGoal",
    "FollowJointTrajectoryResult",
    "JointTolerance",
]


@dataclass(slots=True, eq=False, repr=False)
class JointTolerance(ros.Message):
    """control_msgs/JointTolerance"""

    _type: ClassVar[str] = "control_msgs/JointTolerance"

    name: str = ""
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryGoal(ros.Message):
    """control_msgs/FollowJointTrajectoryGoal"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryGoal"

    trajectory: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    path_tolerance: list[JointTolerance] = field(default_factory=list)
    goal_tolerance: list[JointTolerance] = field(default_factory=list)
    goal_time_tolerance: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryActionGoal(ros.Message):
    """control_msgs/FollowJointTrajectoryActionGoal"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: FollowJointTrajectoryGoal = field(default_factory=lambda: FollowJointTrajectoryGoal())


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryResult(ros.Message):
    """control_msgs/FollowJointTrajectoryResult"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryResult"
    SUCCESSFUL: ClassVar[int] = 0
    INVALID_GOAL: ClassVar[int] = -1
    INVALID_JOINTS: ClassVar[int] = -2
    OLD_HEADER_TIMESTAMP: ClassVar[int] = -3
    PATH_TOLERANCE_VIOLATED: ClassVar[int] = -4
    GOAL_TOLERANCE_VIOLATED: ClassVar[int] = -5

    error_code: int = 0
    error_string: str = ""


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryActionResult(ros.Message):
    """control_msgs/FollowJointTrajectoryActionResult"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: FollowJointTrajectoryResult = field(
        default_factory=lambda: FollowJointTrajectoryResult()
    )


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryFeedback(ros.Message):
    """control_msgs/FollowJointTrajectoryFeedback"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    desired: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )
    actual: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )
    error: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryActionFeedback(ros.Message):
    """control_msgs/FollowJointTrajectoryActionFeedback"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: FollowJointTrajectoryFeedback = field(
        default_factory=lambda: FollowJointTrajectoryFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryAction(ros.Message):
    """control_msgs/FollowJointTrajectoryAction"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryAction"

    action_goal: FollowJointTrajectoryActionGoal = field(
        default_factory=lambda: FollowJointTrajectoryActionGoal()
    )
    action_result: FollowJointTrajectoryActionResult = field(
        default_factory=lambda: FollowJointTrajectoryActionResult()
    )
    action_feedback: FollowJointTrajectoryActionFeedback = field(
        default_factory=lambda: FollowJointTrajectoryActionFeedback()
    )
