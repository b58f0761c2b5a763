"""The messages of rospy_tutorials, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "Floats",
    "HeaderString",
]


@dataclass(slots=True, eq=False, repr=False)
class Floats(ros.Message):
    """rospy_tutorials/Floats"""

    _type: ClassVar[str] = "rospy_tutorials/Floats"

    data: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class HeaderString(ros.Message):
    """rospy_tutorials/HeaderString"""

    _type: ClassVar[str] = "rospy_tutorials/HeaderString"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    data: str = ""
