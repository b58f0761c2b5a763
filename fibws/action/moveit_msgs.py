"""The actions of moveit_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from typing import TypeAlias

import fibws.interfaces as ros
from fibws.msg import moveit_msgs

__all__ = [
    "ExecuteTrajectory",
    "MoveGroup",
    "MoveGroupSequence",
    "Pickup",
    "Place",
]


class ExecuteTrajectory(
    ros.Action[
        moveit_msgs.ExecuteTrajectoryGoal,
        moveit_msgs.ExecuteTrajectoryResult,
        moveit_msgs.ExecuteTrajectoryFeedback,
    ]
):
    """moveit_msgs/ExecuteTrajectory"""

    _type = "moveit_msgs/ExecuteTrajectory"
    Goal: TypeAlias = moveit_msgs.ExecuteTrajectoryGoal
    Result: TypeAlias = moveit_msgs.ExecuteTrajectoryResult
    Feedback: TypeAlias = moveit_msgs.ExecuteTrajectoryFeedback


class MoveGroup(
    ros.Action[
        moveit_msgs.MoveGroupGoal,
        moveit_msgs.MoveGroupResult,
        moveit_msgs.MoveGroupFeedback,
    ]
):
    """moveit_msgs/MoveGroup"""

    _type = "moveit_msgs/MoveGroup"
    Goal: TypeAlias = moveit_msgs.MoveGroupGoal
    Result: TypeAlias = moveit_msgs.MoveGroupResult
    Feedback: TypeAlias = moveit_msgs.MoveGroupFeedback


class MoveGroupSequence(
    ros.Action[
        moveit_msgs.MoveGroupSequenceGoal,
        moveit_msgs.MoveGroupSequenceResult,
        moveit_msgs.MoveGroupSequenceFeedback,
    ]
):
    """moveit_msgs/MoveGroupSequence"""

    _type = "moveit_msgs/MoveGroupSequence"
    Goal: TypeAlias = moveit_msgs.MoveGroupSequenceGoal
    Result: TypeAlias = moveit_msgs.MoveGroupSequenceResult
    Feedback: TypeAlias = moveit_msgs.MoveGroupSequenceFeedback


class Pickup(
    ros.Action[moveit_msgs.PickupGoal, moveit_msgs.PickupResult, moveit_msgs.PickupFeedback]
):
    """moveit_msgs/Pickup"""

    _type = "moveit_msgs/Pickup"
    Goal: TypeAlias = moveit_msgs.PickupGoal
    Result: TypeAlias = moveit_msgs.PickupResult
    Feedback: TypeAlias = moveit_msgs.PickupFeedback


class Place(ros.Action[moveit_msgs.PlaceGoal, moveit_msgs.PlaceResult, moveit_msgs.PlaceFeedback]):
    """moveit_msgs/Place"""

    _type = "moveit_msgs/Place"
    Goal: TypeAlias = moveit_msgs.PlaceGoal
    Result: TypeAlias = moveit_msgs.PlaceResult
    Feedback: TypeAlias = moveit_msgs.PlaceFeedback
