"""The messages of map_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import nav_msgs, sensor_msgs, std_msgs

__all__ = [
    "OccupancyGridUpdate",
    "PointCloud2Update",
    "ProjectedMap",
    "ProjectedMapInfo",
]


@dataclass(slots=True, eq=False, repr=False)
class OccupancyGridUpdate(ros.Message):
    """map_msgs/OccupancyGridUpdate"""

    _type: ClassVar[str] = "map_msgs/OccupancyGridUpdate"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    x: int = 0
    y: int = 0
    width: int = 0
    height: int = 0
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PointCloud2Update(ros.Message):
    """map_msgs/PointCloud2Update"""

    _type: ClassVar[str] = "map_msgs/PointCloud2Update"
    ADD: ClassVar[int] = 0
    DELETE: ClassVar[int] = 1

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    type: int = 0
    points: sensor_msgs.PointCloud2 = field(default_factory=lambda: sensor_msgs.PointCloud2())


@dataclass(slots=True, eq=False, repr=False)
class ProjectedMap(ros.Message):
    """map_msgs/ProjectedMap"""

    _type: ClassVar[str] = "map_msgs/ProjectedMap"

    map: nav_msgs.OccupancyGrid = field(default_factory=lambda: nav_msgs.OccupancyGrid())
    min_z: float = 0.0
    max_z: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class ProjectedMapInfo(ros.Message):
    """map_msgs/ProjectedMapInfo"""

    _type: ClassVar[str] = "map_msgs/ProjectedMapInfo"

    frame_id: str = ""
    x: float = 0.0
    y: float = 0.0
    width: float = 0.0
    height: float = 0.0
    min_z: float = 0.0
    max_z: float = 0.0
