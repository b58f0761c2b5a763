"""The messages of nav_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, std_msgs

__all__ = [
    "GetMapAction",
    "GetMapActionFeedback",
    "GetMapActionGoal",
    "GetMapActionResult",
    "GetMapFeedback",
    "GetMapGoal",
    "GetMapResult",
    "GridCells",
    "MapMetaData",
    "OccupancyGrid",
    "Odometry",
    "Path",
]


@dataclass(slots=True, eq=False, repr=False)
class GetMapGoal(ros.Message):
    """nav_msgs/GetMapGoal"""

    _type: ClassVar[str] = "nav_msgs/GetMapGoal"


@dataclass(slots=True, eq=False, repr=False)
class GetMapActionGoal(ros.Message):
    """nav_msgs/GetMapActionGoal"""

    _type: ClassVar[str] = "nav_msgs/GetMapActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: GetMapGoal = field(default_factory=lambda: GetMapGoal())


@dataclass(slots=True, eq=False, repr=False)
class MapMetaData(ros.Message):
    """nav_msgs/MapMetaData"""

    _type: ClassVar[str] = "nav_msgs/MapMetaData"

    map_load_time: ros.Time = field(default_factory=ros.Time)
    resolution: float = 0.0
    width: int = 0
    height: int = 0
    origin: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())


@dataclass(slots=True, eq=False, repr=False)
class OccupancyGrid(ros.Message):
    """nav_msgs/OccupancyGrid"""

    _type: ClassVar[str] = "nav_msgs/OccupancyGrid"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    info: MapMetaData = field(default_factory=lambda: MapMetaData())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class GetMapResult(ros.Message):
    """nav_msgs/GetMapResult"""

    _type: ClassVar[str] = "nav_msgs/GetMapResult"

    map: OccupancyGrid = field(default_factory=lambda: OccupancyGrid())


@dataclass(slots=True, eq=False, repr=False)
class GetMapActionResult(ros.Message):
    """nav_msgs/GetMapActionResult"""

    _type: ClassVar[str] = "nav_msgs/GetMapActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: GetMapResult = field(default_factory=lambda: GetMapResult())


@dataclass(slots=True, eq=False, repr=False)
class GetMapFeedback(ros.Message):
    """nav_msgs/GetMapFeedback"""

    _type: ClassVar[str] = "nav_msgs/GetMapFeedback"


@dataclass(slots=True, eq=False, repr=False)
class GetMapActionFeedback(ros.Message):
    """nav_msgs/GetMapActionFeedback"""

    _type: ClassVar[str] = "nav_msgs/GetMapActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: GetMapFeedback = field(default_factory=lambda: GetMapFeedback())


@dataclass(slots=True, eq=False, repr=False)
class GetMapAction(ros.Message):
    """nav_msgs/GetMapAction"""

    _type: ClassVar[str] = "nav_msgs/GetMapAction"

    action_goal: GetMapActionGoal = field(default_factory=lambda: GetMapActionGoal())
    action_result: GetMapActionResult = field(default_factory=lambda: GetMapActionResult())
    action_feedback: GetMapActionFeedback = field(default_factory=lambda: GetMapActionFeedback())


@dataclass(slots=True, eq=False, repr=False)
class GridCells(ros.Message):
    """nav_msgs/GridCells"""

    _type: ClassVar[str] = "nav_msgs/GridCells"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    cell_width: float = 0.0
    cell_height: float = 0.0
    cells: list[geometry_msgs.Point] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Odometry(ros.Message):
    """nav_msgs/Odometry"""

    _type: ClassVar[str] = "nav_msgs/Odometry"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    child_frame_id: str = ""
    pose: geometry_msgs.PoseWithCovariance = field(
        default_factory=lambda: geometry_msgs.PoseWithCovariance()
    )
    twist: geometry_msgs.TwistWithCovariance = field(
        default_factory=lambda: geometry_msgs.TwistWithCovariance()
    )


@dataclass(slots=True, eq=False, repr=False)
class Path(ros.Message):
    """nav_msgs/Path"""

    _type: ClassVar[str] = "nav_msgs/Path"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    poses: list[geometry_msgs.PoseStamped] = field(default_factory=list)
