"""The services of octomap_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, octomap_msgs

__all__ = [
    "BoundingBoxQuery",
    "BoundingBoxQueryRequest",
    "BoundingBoxQueryResponse",
    "GetOctomap",
    "GetOctomapRequest",
    "GetOctomapResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class BoundingBoxQueryRequest(ros.Message):
    """octomap_msgs/BoundingBoxQueryRequest"""

    _type: ClassVar[str] = "octomap_msgs/BoundingBoxQueryRequest"

    min: geometry_msgs.Point = field(default_factory=lambda: geometry_msgs.Point())
    max: geometry_msgs.Point = field(default_factory=lambda: geometry_msgs.Point())


@dataclass(slots=True, eq=False, repr=False)
class BoundingBoxQueryResponse(ros.Message):
    """octomap_msgs/BoundingBoxQueryResponse"""

    _type: ClassVar[str] = "octomap_msgs/BoundingBoxQueryResponse"


class BoundingBoxQuery(ros.Service[BoundingBoxQueryRequest, BoundingBoxQueryResponse]):
    """octomap_msgs/BoundingBoxQuery"""

    _type = "octomap_msgs/BoundingBoxQuery"
    Request: TypeAlias = BoundingBoxQueryRequest
    Response: TypeAlias = BoundingBoxQueryResponse


@dataclass(slots=True, eq=False, repr=False)
class GetOctomapRequest(ros.Message):
    """octomap_msgs/GetOctomapRequest"""

    _type: ClassVar[str] = "octomap_msgs/GetOctomapRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetOctomapResponse(ros.Message):
    """octomap_msgs/GetOctomapResponse"""

    _type: ClassVar[str] = "octomap_msgs/GetOctomapResponse"

    map: octomap_msgs.Octomap = field(default_factory=lambda: octomap_msgs.Octomap())


class GetOctomap(ros.Service[GetOctomapRequest, GetOctomapResponse]):
    """octomap_msgs/GetOctomap"""

    _type = "octomap_msgs/GetOctomap"
    Request: TypeAlias = GetOctomapRequest
    Response: TypeAlias = GetOctomapResponse
