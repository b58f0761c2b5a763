"""The messages of geometry_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "Accel",
    "AccelStamped",
    "AccelWithCovariance",
    "AccelWithCovarianceStamped",
    "Inertia",
    "InertiaStamped",
    "Point",
    "Point32",
    "PointStamped",
    "Polygon",
    "PolygonStamped",
    "Pose",
    "Pose2D",
    "PoseArray",
    "PoseStamped",
    "PoseWithCovariance",
    "PoseWithCovarianceStamped",
    "Quaternion",
    "QuaternionStamped",
    "Transform",
    "TransformStamped",
    "Twist",
    "TwistStamped",
    "TwistWithCovariance",
    "TwistWithCovarianceStamped",
    "Vector3",
    "Vector3Stamped",
    "Wrench",
    "WrenchStamped",
]


@dataclass(slots=True, eq=False, repr=False)
class Vector3(ros.Message):
    """geometry_msgs/Vector3"""

    _type: ClassVar[str] = "geometry_msgs/Vector3"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Accel(ros.Message):
    """geometry_msgs/Accel"""

    _type: ClassVar[str] = "geometry_msgs/Accel"

    linear: Vector3 = field(default_factory=lambda: Vector3())
    angular: Vector3 = field(default_factory=lambda: Vector3())


@dataclass(slots=True, eq=False, repr=False)
class AccelStamped(ros.Message):
    """geometry_msgs/AccelStamped"""

    _type: ClassVar[str] = "geometry_msgs/AccelStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    accel: Accel = field(default_factory=lambda: Accel())


@dataclass(slots=True, eq=False, repr=False)
class AccelWithCovariance(ros.Message):
    """geometry_msgs/AccelWithCovariance"""

    _type: ClassVar[str] = "geometry_msgs/AccelWithCovariance"

    accel: Accel = field(default_factory=lambda: Accel())
    covariance: list[float] = field(default_factory=lambda: [0.0] * 36)


@dataclass(slots=True, eq=False, repr=False)
class AccelWithCovarianceStamped(ros.Message):
    """geometry_msgs/AccelWithCovarianceStamped"""

    _type: ClassVar[str] = "geometry_msgs/AccelWithCovarianceStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    accel: AccelWithCovariance = field(default_factory=lambda: AccelWithCovariance())


@dataclass(slots=True, eq=False, repr=False)
class Inertia(ros.Message):
    """geometry_msgs/Inertia"""

    _type: ClassVar[str] = "geometry_msgs/Inertia"

    m: float = 0.0
    com: Vector3 = field(default_factory=lambda: Vector3())
    ixx: float = 0.0
    ixy: float = 0.0
    ixz: float = 0.0
    iyy: float = 0.0
    iyz: float = 0.0
    izz: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class InertiaStamped(ros.Message):
    """geometry_msgs/InertiaStamped"""

    _type: ClassVar[str] = "geometry_msgs/InertiaStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    inertia: Inertia = field(default_factory=lambda: Inertia())


@dataclass(slots=True, eq=False, repr=False)
class Point(ros.Message):
    """geometry_msgs/Point"""

    _type: ClassVar[str] = "geometry_msgs/Point"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Point32(ros.Message):
    """geometry_msgs/Point32"""

    _type: ClassVar[str] = "geometry_msgs/Point32"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PointStamped(ros.Message):
    """geometry_msgs/PointStamped"""

    _type: ClassVar[str] = "geometry_msgs/PointStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    point: Point = field(default_factory=lambda: Point())


@dataclass(slots=True, eq=False, repr=False)
class Polygon(ros.Message):
    """geometry_msgs/Polygon"""

    _type: ClassVar[str] = "geometry_msgs/Polygon"

    points: list[Point32] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PolygonStamped(ros.Message):
    """geometry_msgs/PolygonStamped"""

    _type: ClassVar[str] = "geometry_msgs/PolygonStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    polygon: Polygon = field(default_factory=lambda: Polygon())


@dataclass(slots=True, eq=False, repr=False)
class Quaternion(ros.Message):
    """geometry_msgs/Quaternion"""

    _type: ClassVar[str] = "geometry_msgs/Quaternion"

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Pose(ros.Message):
    """geometry_msgs/Pose"""

    _type: ClassVar[str] = "geometry_msgs/Pose"

    position: Point = field(default_factory=lambda: Point())
    orientation: Quaternion = field(default_factory=lambda: Quaternion())


@dataclass(slots=True, eq=False, repr=False)
class Pose2D(ros.Message):
    """geometry_msgs/Pose2D"""

    _type: ClassVar[str] = "geometry_msgs/Pose2D"

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PoseArray(ros.Message):
    """geometry_msgs/PoseArray"""

    _type: ClassVar[str] = "geometry_msgs/PoseArray"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    poses: list[Pose] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PoseStamped(ros.Message):
    """geometry_msgs/PoseStamped"""

    _type: ClassVar[str] = "geometry_msgs/PoseStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: Pose = field(default_factory=lambda: Pose())


@dataclass(slots=True, eq=False, repr=False)
class PoseWithCovariance(ros.Message):
    """geometry_msgs/PoseWithCovariance"""

    _type: ClassVar[str] = "geometry_msgs/PoseWithCovariance"

    pose: Pose = field(default_factory=lambda: Pose())
    covariance: list[float] = field(default_factory=lambda: [0.0] * 36)


@dataclass(slots=True, eq=False, repr=False)
class PoseWithCovarianceStamped(ros.Message):
    """geometry_msgs/PoseWithCovarianceStamped"""

    _type: ClassVar[str] = "geometry_msgs/PoseWithCovarianceStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: PoseWithCovariance = field(default_factory=lambda: PoseWithCovariance())


@dataclass(slots=True, eq=False, repr=False)
class QuaternionStamped(ros.Message):
    """geometry_msgs/QuaternionStamped"""

    _type: ClassVar[str] = "geometry_msgs/QuaternionStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    quaternion: Quaternion = field(default_factory=lambda: Quaternion())


@dataclass(slots=True, eq=False, repr=False)
class Transform(ros.Message):
    """geometry_msgs/Transform"""

    _type: ClassVar[str] = "geometry_msgs/Transform"

    translation: Vector3 = field(default_factory=lambda: Vector3())
    rotation: Quaternion = field(default_factory=lambda: Quaternion())


@dataclass(slots=True, eq=False, repr=False)
class TransformStamped(ros.Message):
    """geometry_msgs/TransformStamped"""

    _type: ClassVar[str] = "geometry_msgs/TransformStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    child_frame_id: str = ""
    transform: Transform = field(default_factory=lambda: Transform())


@dataclass(slots=True, eq=False, repr=False)
class Twist(ros.Message):
    """geometry_msgs/Twist"""

    _type: ClassVar[str] = "geometry_msgs/Twist"

    linear: Vector3 = field(default_factory=lambda: Vector3())
    angular: Vector3 = field(default_factory=lambda: Vector3())


@dataclass(slots=True, eq=False, repr=False)
class TwistStamped(ros.Message):
    """geometry_msgs/TwistStamped"""

    _type: ClassVar[str] = "geometry_msgs/TwistStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    twist: Twist = field(default_factory=lambda: Twist())


@dataclass(slots=True, eq=False, repr=False)
class TwistWithCovariance(ros.Message):
    """geometry_msgs/TwistWithCovariance"""

    _type: ClassVar[str] = "geometry_msgs/TwistWithCovariance"

    twist: Twist = field(default_factory=lambda: Twist())
    covariance: list[float] = field(default_factory=lambda: [0.0] * 36)


@dataclass(slots=True, eq=False, repr=False)
class TwistWithCovarianceStamped(ros.Message):
    """geometry_msgs/TwistWithCovarianceStamped"""

    _type: ClassVar[str] = "geometry_msgs/TwistWithCovarianceStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    twist: TwistWithCovariance = field(default_factory=lambda: TwistWithCovariance())


@dataclass(slots=True, eq=False, repr=False)
class Vector3Stamped(ros.Message):
    """geometry_msgs/Vector3Stamped"""

    _type: ClassVar[str] = "geometry_msgs/Vector3Stamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    vector: Vector3 = field(default_factory=lambda: Vector3())


@dataclass(slots=True, eq=False, repr=False)
class Wrench(ros.Message):
    """geometry_msgs/Wrench"""

    _type: ClassVar[str] = "geometry_msgs/Wrench"

    force: Vector3 = field(default_factory=lambda: Vector3())
    torque: Vector3 = field(default_factory=lambda: Vector3())


@dataclass(slots=True, eq=False, repr=False)
class WrenchStamped(ros.Message):
    """geometry_msgs/WrenchStamped"""

    _type: ClassVar[str] = "geometry_msgs/WrenchStamped"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    wrench: Wrench = field(default_factory=lambda: Wrench())
