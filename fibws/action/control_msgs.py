"""The actions of control_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import control_msgs

__all__ = [
    "FollowJointTrajectory",
]


class FollowJointTrajectory(
    ros.Action[
        control_msgs.FollowJointTrajectoryGoal,
        control_msgs.FollowJointTrajectoryResult,
        control_msgs.FollowJointTrajectoryFeedback,
    ]
):
    """control_msgs/FollowJointTrajectory"""

    _type = "control_msgs/FollowJointTrajectory"
    Goal: TypeAlias = control_msgs.FollowJointTrajectoryGoal
    Result: TypeAlias = control_msgs.FollowJointTrajectoryResult
    Feedback: TypeAlias = control_msgs.FollowJointTrajectoryFeedback
