"""The messages of geographic_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, std_msgs, uuid_msgs

__all__ = [
    "BoundingBox",
    "GeoPath",
    "GeoPoint",
    "GeoPointStamped",
    "GeoPose",
    "GeoPoseStamped",
    "GeographicMap",
    "GeographicMapChanges",
    "KeyValue",
    "MapFeature",
    "RouteNetwork",
    "RoutePath",
    "RouteSegment",
    "WayPoint",
]


@dataclass(slots=True, eq=False, repr=False)
class GeoPoint(ros.Message):
    """geographic_msgs/GeoPoint"""

    _type: ClassVar[str] = "geographic_msgs/GeoPoint"

    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class BoundingBox(ros.Message):
    """geographic_msgs/BoundingBox"""

    _type: ClassVar[str] = "geographic_msgs/BoundingBox"

    min_pt: GeoPoint = field(default_factory=lambda: GeoPoint())
    max_pt: GeoPoint = field(default_factory=lambda: GeoPoint())


@dataclass(slots=True, eq=False, repr=False)
class GeoPose(ros.Message):
    """geographic_msgs/GeoPose"""

    _type: ClassVar[str] = "geographic_msgs/GeoPose"

    position: GeoPoint = field(default_factory=lambda: GeoPoint())
    orientation: geometry_msgs.Quaternion = field(
        default_factory=lambda: geometry_msgs.Quaternion()
    )


@dataclass(slots=True, eq=False, repr=False)
class GeoPoseStamped(ros.Message):
    """geographic_msgs/GeoPoseStamped"""

    _type: ClassVar[str] = "geographic_msgs/GeoPoseStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: GeoPose = field(default_factory=lambda: GeoPose())


@dataclass(slots=True, eq=False, repr=False)
class GeoPath(ros.Message):
    """geographic_msgs/GeoPath"""

    _type: ClassVar[str] = "geographic_msgs/GeoPath"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    poses: list[GeoPoseStamped] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class GeoPointStamped(ros.Message):
    """geographic_msgs/GeoPointStamped"""

    _type: ClassVar[str] = "geographic_msgs/GeoPointStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    position: GeoPoint = field(default_factory=lambda: GeoPoint())


@dataclass(slots=True, eq=False, repr=False)
class KeyValue(ros.Message):
    """geographic_msgs/KeyValue"""

    _type: ClassVar[str] = "geographic_msgs/KeyValue"

    key: str = ""
    value: str = ""


@dataclass(slots=True, eq=False, repr=False)
class WayPoint(ros.Message):
    """geographic_msgs/WayPoint"""

    _type: ClassVar[str] = "geographic_msgs/WayPoint"

    id: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    position: GeoPoint = field(default_factory=lambda: GeoPoint())
    props: list[KeyValue] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MapFeature(ros.Message):
    """geographic_msgs/MapFeature"""

    _type: ClassVar[str] = "geographic_msgs/MapFeature"

    id: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    components: list[uuid_msgs.UniqueID] = field(default_factory=list)
    props: list[KeyValue] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class GeographicMap(ros.Message):
    """geographic_msgs/GeographicMap"""

    _type: ClassVar[str] = "geographic_msgs/GeographicMap"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    id: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    bounds: BoundingBox = field(default_factory=lambda: BoundingBox())
    points: list[WayPoint] = field(default_factory=list)
    features: list[MapFeature] = field(default_factory=list)
    props: list[KeyValue] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class GeographicMapChanges(ros.Message):
    """geographic_msgs/GeographicMapChanges"""

    _type: ClassVar[str] = "geographic_msgs/GeographicMapChanges"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    diffs: GeographicMap = field(default_factory=lambda: GeographicMap())
    deletes: list[uuid_msgs.UniqueID] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class RouteSegment(ros.Message):
    """geographic_msgs/RouteSegment"""

    _type: ClassVar[str] = "geographic_msgs/RouteSegment"

    id: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    start: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    end: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    props: list[KeyValue] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class RouteNetwork(ros.Message):
    """geographic_msgs/RouteNetwork"""

    _type: ClassVar[str] = "geographic_msgs/RouteNetwork"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    id: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    bounds: BoundingBox = field(default_factory=lambda: BoundingBox())
    points: list[WayPoint] = field(default_factory=list)
    segments: list[RouteSegment] = field(default_factory=list)
    props: list[KeyValue] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class RoutePath(ros.Message):
    """geographic_msgs/RoutePath"""

    _type: ClassVar[str] = "geographic_msgs/RoutePath"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    network: uuid_msgs.UniqueID = field(default_factory=lambda: uuid_msgs.UniqueID())
    segments: list[uuid_msgs.UniqueID] = field(default_factory=list)
    props: list[KeyValue] = field(default_factory=list)
