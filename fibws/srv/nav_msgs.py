"""The services of nav_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, nav_msgs

__all__ = [
    "GetMap",
    "GetMapRequest",
    "GetMapResponse",
    "GetPlan",
    "GetPlanRequest",
    "GetPlanResponse",
    "LoadMap",
    "LoadMapRequest",
    "LoadMapResponse",
    "SetMap",
    "SetMapRequest",
    "SetMapResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class GetMapRequest(ros.Message):
    """nav_msgs/GetMapRequest"""

    _type: ClassVar[str] = "nav_msgs/GetMapRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetMapResponse(ros.Message):
    """nav_msgs/GetMapResponse"""

    _type: ClassVar[str] = "nav_msgs/GetMapResponse"

    map: nav_msgs.OccupancyGrid = field(default_factory=lambda: nav_msgs.OccupancyGrid())


class GetMap(ros.Service[GetMapRequest, GetMapResponse]):
    """nav_msgs/GetMap"""

    _type = "nav_msgs/GetMap"
    Request: TypeAlias = GetMapRequest
    Response: TypeAlias = GetMapResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPlanRequest(ros.Message):
    """nav_msgs/GetPlanRequest"""

    _type: ClassVar[str] = "nav_msgs/GetPlanRequest"

    start: geometry_msgs.PoseStamped = field(default_factory=lambda: geometry_msgs.PoseStamped())
    goal: geometry_msgs.PoseStamped = field(default_factory=lambda: geometry_msgs.PoseStamped())
    tolerance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class GetPlanResponse(ros.Message):
    """nav_msgs/GetPlanResponse"""

    _type: ClassVar[str] = "nav_msgs/GetPlanResponse"

    plan: nav_msgs.Path = field(default_factory=lambda: nav_msgs.Path())


class GetPlan(ros.Service[GetPlanRequest, GetPlanResponse]):
    """nav_msgs/GetPlan"""

    _type = "nav_msgs/GetPlan"
    Request: TypeAlias = GetPlanRequest
    Response: TypeAlias = GetPlanResponse


@dataclass(slots=True, eq=False, repr=False)
class LoadMapRequest(ros.Message):
    """nav_msgs/LoadMapRequest"""

    _type: ClassVar[str] = "nav_msgs/LoadMapRequest"

    map_url: str = ""


@dataclass(slots=True, eq=False, repr=False)
class LoadMapResponse(ros.Message):
    """nav_msgs/LoadMapResponse"""

    _type: ClassVar[str] = "nav_msgs/LoadMapResponse"
    RESULT_SUCCESS: ClassVar[int] = 0
    RESULT_MAP_DOES_NOT_EXIST: ClassVar[int] = 1
    RESULT_INVALID_MAP_DATA: ClassVar[int] = 2
    RESULT_INVALID_MAP_METADATA: ClassVar[int] = 3
    RESULT_UNDEFINED_FAILURE: ClassVar[int] = 255

    map: nav_msgs.OccupancyGrid = field(default_factory=lambda: nav_msgs.OccupancyGrid())
    result: int = 0


class LoadMap(ros.Service[LoadMapRequest, LoadMapResponse]):
    """nav_msgs/LoadMap"""

    _type = "nav_msgs/LoadMap"
    Request: TypeAlias = LoadMapRequest
    Response: TypeAlias = LoadMapResponse


@dataclass(slots=True, eq=False, repr=False)
class SetMapRequest(ros.Message):
    """nav_msgs/SetMapRequest"""

    _type: ClassVar[str] = "nav_msgs/SetMapRequest"

    map: nav_msgs.OccupancyGrid = field(default_factory=lambda: nav_msgs.OccupancyGrid())
    initial_pose: geometry_msgs.PoseWithCovarianceStamped = field(
        default_factory=lambda: geometry_msgs.PoseWithCovarianceStamped()
    )


@dataclass(slots=True, eq=False, repr=False)
class SetMapResponse(ros.Message):
    """nav_msgs/SetMapResponse"""

    _type: ClassVar[str] = "nav_msgs/SetMapResponse"

    success: bool = False


class SetMap(ros.Service[SetMapRequest, SetMapResponse]):
    """nav_msgs/SetMap"""

    _type = "nav_msgs/SetMap"
    Request: TypeAlias = SetMapRequest
    Response: TypeAlias = SetMapResponse
