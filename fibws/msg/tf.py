"""The messages of tf, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs

__all__ = [
    "tfMessage",
]


@dataclass(slots=True, eq=False, repr=False)
class tfMessage(ros.Message):
    """tf/tfMessage"""

    _type: ClassVar[str] = "tf/tfMessage"

    transforms: list[geometry_msgs.TransformStamped] = field(default_factory=list)
