"""The messages of octomap_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, std_msgs

__all__ = [
    "Octomap",
    "OctomapWithPose",
]


@dataclass(slots=True, eq=False, repr=False)
class Octomap(ros.Message):
    """octomap_msgs/Octomap"""

    _type: ClassVar[str] = "octomap_msgs/Octomap"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    binary: bool = False
    id: str = ""
    resolution: float = 0.0
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class OctomapWithPose(ros.Message):
    """octomap_msgs/OctomapWithPose"""

    _type: ClassVar[str] = "octomap_msgs/OctomapWithPose"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    origin: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    octomap: Octomap = field(default_factory=lambda: Octomap())
