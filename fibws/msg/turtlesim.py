"""The messages of turtlesim, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "Color",
    "Pose",
]


@dataclass(slots=True, eq=False, repr=False)
class Color(ros.Message):
    """turtlesim/Color"""

    _type: ClassVar[str] = "turtlesim/Color"

    r: int = 0
    g: int = 0
    b: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Pose(ros.Message):
    """turtlesim/Pose"""

    _type: ClassVar[str] = "turtlesim/Pose"

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0
    linear_velocity: float = 0.0
    angular_velocity: float = 0.0
