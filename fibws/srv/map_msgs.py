"""The services of map_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import map_msgs, nav_msgs, sensor_msgs, std_msgs

__all__ = [
    "GetMapROI",
    "GetMapROIRequest",
    "GetMapROIResponse",
    "GetPointMap",
    "GetPointMapROI",
    "GetPointMapROIRequest",
    "GetPointMapROIResponse",
    "GetPointMapRequest",
    "GetPointMapResponse",
    "ProjectedMapsInfo",
    "ProjectedMapsInfoRequest",
    "ProjectedMapsInfoResponse",
    "SaveMap",
    "SaveMapRequest",
    "SaveMapResponse",
    "SetMapProjections",
    "SetMapProjectionsRequest",
    "SetMapProjectionsResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class GetMapROIRequest(ros.Message):
    """map_msgs/GetMapROIRequest"""

    _type: ClassVar[str] = "map_msgs/GetMapROIRequest"

    x: float = 0.0
    y: float = 0.0
    l_x: float = 0.0
    l_y: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class GetMapROIResponse(ros.Message):
    """map_msgs/GetMapROIResponse"""

    _type: ClassVar[str] = "map_msgs/GetMapROIResponse"

    sub_map: nav_msgs.OccupancyGrid = field(default_factory=lambda: nav_msgs.OccupancyGrid())


class GetMapROI(ros.Service[GetMapROIRequest, GetMapROIResponse]):
    """map_msgs/GetMapROI"""

    _type = "map_msgs/GetMapROI"
    Request: TypeAlias = GetMapROIRequest
    Response: TypeAlias = GetMapROIResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPointMapRequest(ros.Message):
    """map_msgs/GetPointMapRequest"""

    _type: ClassVar[str] = "map_msgs/GetPointMapRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetPointMapResponse(ros.Message):
    """map_msgs/GetPointMapResponse"""

    _type: ClassVar[str] = "map_msgs/GetPointMapResponse"

    map: sensor_msgs.PointCloud2 = field(default_factory=lambda: sensor_msgs.PointCloud2())


class GetPointMap(ros.Service[GetPointMapRequest, GetPointMapResponse]):
    """map_msgs/GetPointMap"""

    _type = "map_msgs/GetPointMap"
    Request: TypeAlias = GetPointMapRequest
    Response: TypeAlias = GetPointMapResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPointMapROIRequest(ros.Message):
    """map_msgs/GetPointMapROIRequest"""

    _type: ClassVar[str] = "map_msgs/GetPointMapROIRequest"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    r: float = 0.0
    l_x: float = 0.0
    l_y: float = 0.0
    l_z: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class GetPointMapROIResponse(ros.Message):
    """map_msgs/GetPointMapROIResponse"""

    _type: ClassVar[str] = "map_msgs/GetPointMapROIResponse"

    sub_map: sensor_msgs.PointCloud2 = field(default_factory=lambda: sensor_msgs.PointCloud2())


class GetPointMapROI(ros.Service[GetPointMapROIRequest, GetPointMapROIResponse]):
    """map_msgs/GetPointMapROI"""

    _type = "map_msgs/GetPointMapROI"
    Request: TypeAlias = GetPointMapROIRequest
    Response: TypeAlias = GetPointMapROIResponse


@dataclass(slots=True, eq=False, repr=False)
class ProjectedMapsInfoRequest(ros.Message):
    """map_msgs/ProjectedMapsInfoRequest"""

    _type: ClassVar[str] = "map_msgs/ProjectedMapsInfoRequest"

    projected_maps_info: list[map_msgs.ProjectedMapInfo] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ProjectedMapsInfoResponse(ros.Message):
    """map_msgs/ProjectedMapsInfoResponse"""

    _type: ClassVar[str] = "map_msgs/ProjectedMapsInfoResponse"


class ProjectedMapsInfo(ros.Service[ProjectedMapsInfoRequest, ProjectedMapsInfoResponse]):
    """map_msgs/ProjectedMapsInfo"""

    _type = "map_msgs/ProjectedMapsInfo"
    Request: TypeAlias = ProjectedMapsInfoRequest
    Response: TypeAlias = ProjectedMapsInfoResponse


@dataclass(slots=True, eq=False, repr=False)
class SaveMapRequest(ros.Message):
    """map_msgs/SaveMapRequest"""

    _type: ClassVar[str] = "map_msgs/SaveMapRequest"

    filename: std_msgs.String = field(default_factory=lambda: std_msgs.String())


@dataclass(slots=True, eq=False, repr=False)
class SaveMapResponse(ros.Message):
    """map_msgs/SaveMapResponse"""

    _type: ClassVar[str] = "map_msgs/SaveMapResponse"


class SaveMap(ros.Service[SaveMapRequest, SaveMapResponse]):
    """map_msgs/SaveMap"""

    _type = "map_msgs/SaveMap"
    Request: TypeAlias = SaveMapRequest
    Response: TypeAlias = SaveMapResponse


@dataclass(slots=True, eq=False, repr=False)
class SetMapProjectionsRequest(ros.Message):
    """map_msgs/SetMapProjectionsRequest"""

    _type: ClassVar[str] = "map_msgs/SetMapProjectionsRequest"


@dataclass(slots=True, eq=False, repr=False)
class SetMapProjectionsResponse(ros.Message):
    """map_msgs/SetMapProjectionsResponse"""

    _type: ClassVar[str] = "map_msgs/SetMapProjectionsResponse"

    projected_maps_info: list[map_msgs.ProjectedMapInfo] = field(default_factory=list)


class SetMapProjections(ros.Service[SetMapProjectionsRequest, SetMapProjectionsResponse]):
    """map_msgs/SetMapProjections"""

    _type = "map_msgs/SetMapProjections"
    Request: TypeAlias = SetMapProjectionsRequest
    Response: TypeAlias = SetMapProjectionsResponse
