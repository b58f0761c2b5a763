"""The messages of trajectory_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, std_msgs

__all__ = [
    "JointTrajectory",
    "JointTrajectoryPoint",
    "MultiDOFJointTrajectory",
    "MultiDOFJointTrajectoryPoint",
]


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryPoint(ros.Message):
    """trajectory_msgs/JointTrajectoryPoint"""

    _type: ClassVar[str] = "trajectory_msgs/JointTrajectoryPoint"

    positions: list[float] = field(default_factory=list)
    velocities: list[float] = field(default_factory=list)
    accelerations: list[float] = field(default_factory=list)
    effort: list[float] = field(default_factory=list)
    time_from_start: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectory(ros.Message):
    """trajectory_msgs/JointTrajectory"""

    _type: ClassVar[str] = "trajectory_msgs/JointTrajectory"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    points: list[JointTrajectoryPoint] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MultiDOFJointTrajectoryPoint(ros.Message):
    """trajectory_msgs/MultiDOFJointTrajectoryPoint"""

    _type: ClassVar[str] = "trajectory_msgs/MultiDOFJointTrajectoryPoint"

    transforms: list[geometry_msgs.Transform] = field(default_factory=list)
    velocities: list[geometry_msgs.Twist] = field(default_factory=list)
    accelerations: list[geometry_msgs.Twist] = field(default_factory=list)
    time_from_start: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class MultiDOFJointTrajectory(ros.Message):
    """trajectory_msgs/MultiDOFJointTrajectory"""

    _type: ClassVar[str] = "trajectory_msgs/MultiDOFJointTrajectory"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    points: list[MultiDOFJointTrajectoryPoint] = field(default_factory=list)
