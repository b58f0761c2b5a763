"""The services of geographic_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import geographic_msgs, uuid_msgs

__all__ = [
    "GetGeoPath",
    "GetGeoPathRequest",
    "GetGeoPathResponse",
    "GetGeographicMap",
    "GetGeographicMapRequest",
    "GetGeographicMapResponse",
    "GetRoutePlan",
    "GetRoutePlanRequest",
    "GetRoutePlanResponse",
    "UpdateGeographicMap",
    "UpdateGeographicMapRequest",
    "UpdateGeographicMapResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class GetGeoPathRequest(ros.Message):
    """geographic_msgs/GetGeoPathRequest"""

    _type: ClassVar[str] = "geographic_msgs/GetGeoPathRequest"

    start: geographic_msgs.GeoPoint = field(default_factory=lambda: geographic_msgs.GeoPoint())
    goal: geographic_msgs.GeoPoint = field(default_factory=lambda: geographic_msgs.GeoPoint())


@dataclass(slots=True, eq=False, repr=False)
class GetGeoPathResponse(ros.Message):
    """geographic_msgs/GetGeoPathResponse"""

    _type: ClassVar[str] = "geographic_msgs/GetGeoPathResponse"

    success: bool = False
    status: str = ""
    plan: geographic_msgs.GeoPath = field(default_factory=lambda: geographic_msgs.GeoPath())
    network: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    start_seg: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    goal_seg: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    distance: float = 0.0


class GetGeoPath(ros.Service[GetGeoPathRequest, GetGeoPathResponse]):
    """geographic_msgs/GetGeoPath"""

    _type = "geographic_msgs/GetGeoPath"
    Request: TypeAlias = GetGeoPathRequest
    Response: TypeAlias = GetGeoPathResponse


@dataclass(slots=True, eq=False, repr=False)
class GetGeographicMapRequest(ros.Message):
    """geographic_msgs/GetGeographicMapRequest"""

    _type: ClassVar[str] = "geographic_msgs/GetGeographicMapRequest"

    url: str = ""
    bounds: geographic_msgs.BoundingBox = field(
        default_factory=lambda: geographic_msgs.BoundingBox()
    )


@dataclass(slots=True, eq=False, repr=False)
class GetGeographicMapResponse(ros.Message):
    """geographic_msgs/GetGeographicMapResponse"""

    _type: ClassVar[str] = "geographic_msgs/GetGeographicMapResponse"

    success: bool = False
    status: str = ""
    map: geographic_msgs.GeographicMap = field(
        default_factory=lambda: geographic_msgs.GeographicMap()
    )


class GetGeographicMap(ros.Service[GetGeographicMapRequest, GetGeographicMapResponse]):
    """geographic_msgs/GetGeographicMap"""

    _type = "geographic_msgs/GetGeographicMap"
    Request: TypeAlias = GetGeographicMapRequest
    Response: TypeAlias = GetGeographicMapResponse


@dataclass(slots=True, eq=False, repr=False)
class GetRoutePlanRequest(ros.Message):
    """geographic_msgs/GetRoutePlanRequest"""

    _type: ClassVar[str] = "geographic_msgs/GetRoutePlanRequest"

    network: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    start: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    goal: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())


@dataclass(slots=True, eq=False, repr=False)
class GetRoutePlanResponse(ros.Message):
    """geographic_msgs/GetRoutePlanResponse"""

    _type: ClassVar[str] = "geographic_msgs/GetRoutePlanResponse"

    success: bool = False
    status: str = ""
    plan: geographic_msgs.RoutePath = field(default_factory=lambda: geographic_msgs.RoutePath())


class GetRoutePlan(ros.Service[GetRoutePlanRequest, GetRoutePlanResponse]):
    """geographic_msgs/GetRoutePlan"""

    _type = "geographic_msgs/GetRoutePlan"
    Request: TypeAlias = GetRoutePlanRequest
    Response: TypeAlias = GetRoutePlanResponse


@dataclass(slots=True, eq=False, repr=False)
class UpdateGeographicMapRequest(ros.Message):
    """geographic_msgs/UpdateGeographicMapRequest"""

    _type: ClassVar[str] = "geographic_msgs/UpdateGeographicMapRequest"

    updates: geographic_msgs.GeographicMapChanges = field(
        default_factory=lambda: geographic_msgs.GeographicMapChanges()
    )


@dataclass(slots=True, eq=False, repr=False)
class UpdateGeographicMapResponse(ros.Message):
    """geographic_msgs/UpdateGeographicMapResponse"""

    _type: ClassVar[str] = "geographic_msgs/UpdateGeographicMapResponse"

    success: bool = False
    status: str = ""


class UpdateGeographicMap(ros.Service[UpdateGeographicMapRequest, UpdateGeographicMapResponse]):
    """geographic_msgs/UpdateGeographicMap"""

    _type = "geographic_msgs/UpdateGeographicMap"
    Request: TypeAlias = UpdateGeographicMapRequest
    Response: TypeAlias = UpdateGeographicMapResponse
