"""The messages of stereo_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import sensor_msgs, std_msgs

__all__ = [
    "DisparityImage",
]


@dataclass(slots=True, eq=False, repr=False)
class DisparityImage(ros.Message):
    """stereo_msgs/DisparityImage"""

    _type: ClassVar[str] = "stereo_msgs/DisparityImage"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    image: sensor_msgs.Image = field(default_factory=lambda: sensor_msgs.Image())
    f: float = 0.0
    T: float = 0.0
    valid_window: sensor_msgs.RegionOfInterest = field(
        default_factory=lambda: sensor_msgs.RegionOfInterest()
    )
    min_disparity: float = 0.0
    max_disparity: float = 0.0
    delta_d: float = 0.0
