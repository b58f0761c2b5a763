"""The actions of control_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import control_msgs

__all__ = [
    "FollowJointTrajectory",
    "GripperCommand",
    "JointTrajectory",
    "PointHead",
    "SingleJointPosition",
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


class GripperCommand(
    ros.Action[
        control_msgs.GripperCommandGoal,
        control_msgs.GripperCommandResult,
        control_msgs.GripperCommandFeedback,
    ]
):
    """control_msgs/GripperCommand"""

    _type = "control_msgs/GripperCommand"
    Goal: TypeAlias = control_msgs.GripperCommandGoal
    Result: TypeAlias = control_msgs.GripperCommandResult
    Feedback: TypeAlias = control_msgs.GripperCommandFeedback


class JointTrajectory(
    ros.Action[
        control_msgs.JointTrajectoryGoal,
        control_msgs.JointTrajectoryResult,
        control_msgs.JointTrajectoryFeedback,
    ]
):
    """control_msgs/JointTrajectory"""

    _type = "control_msgs/JointTrajectory"
    Goal: TypeAlias = control_msgs.JointTrajectoryGoal
    Result: TypeAlias = control_msgs.JointTrajectoryResult
    Feedback: TypeAlias = control_msgs.JointTrajectoryFeedback


class PointHead(
    ros.Action[
        control_msgs.PointHeadGoal,
        control_msgs.PointHeadResult,
        control_msgs.PointHeadFeedback,
    ]
):
    """control_msgs/PointHead"""

    _type = "control_msgs/PointHead"
    Goal: TypeAlias = control_msgs.PointHeadGoal
    Result: TypeAlias = control_msgs.PointHeadResult
    Feedback: TypeAlias = control_msgs.PointHeadFeedback


class SingleJointPosition(
    ros.Action[
        control_msgs.SingleJointPositionGoal,
        control_msgs.SingleJointPositionResult,
        control_msgs.SingleJointPositionFeedback,
    ]
):
    """control_msgs/SingleJointPosition"""

    _type = "control_msgs/SingleJointPosition"
    Goal: TypeAlias = control_msgs.SingleJointPositionGoal
    Result: TypeAlias = control_msgs.SingleJointPositionResult
    Feedback: TypeAlias = control_msgs.SingleJointPositionFeedback
