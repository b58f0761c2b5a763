"""The messages of shape_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs

__all__ = [
    "Mesh",
    "MeshTriangle",
    "Plane",
    "SolidPrimitive",
]


@dataclass(slots=True, eq=False, repr=False)
class MeshTriangle(ros.Message):
    """shape_msgs/MeshTriangle"""

    _type: ClassVar[str] = "shape_msgs/MeshTriangle"

    vertex_indices: list[int] = field(default_factory=lambda: [0] * 3)


@dataclass(slots=True, eq=False, repr=False)
class Mesh(ros.Message):
    """shape_msgs/Mesh"""

    _type: ClassVar[str] = "shape_msgs/Mesh"

    triangles: list[MeshTriangle] = field(default_factory=list)
    vertices: list[geometry_msgs.Point] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Plane(ros.Message):
    """shape_msgs/Plane"""

    _type: ClassVar[str] = "shape_msgs/Plane"

    coef: list[float] = field(default_factory=lambda: [0.0] * 4)


@dataclass(slots=True, eq=False, repr=False)
class SolidPrimitive(ros.Message):
    """shape_msgs/SolidPrimitive"""

    _type: ClassVar[str] = "shape_msgs/SolidPrimitive"
    BOX: ClassVar[int] = 1
    SPHERE: ClassVar[int] = 2
    CYLINDER: ClassVar[int] = 3
    CONE: ClassVar[int] = 4
    BOX_X: ClassVar[int] = 0
    BOX_Y: ClassVar[int] = 1
    BOX_Z: ClassVar[int] = 2
    SPHERE_RADIUS: ClassVar[int] = 0
    CYLINDER_HEIGHT: ClassVar[int] = 0
    CYLINDER_RADIUS: ClassVar[int] = 1
    CONE_HEIGHT: ClassVar[int] = 0
    CONE_RADIUS: ClassVar[int] = 1

    type: int = 0
    dimensions: list[float] = field(default_factory=list)
