"""Messages as numpy's arrays, and arrays as messages.

Source: ros_numpy of ROS Noetic, https://github.com/eric-wieser/ros_numpy.
"""

from __future__ import annotations

from ros_numpy import geometry, image, occupancy_grid, point_cloud2
from ros_numpy.registry import converts_from_numpy, converts_to_numpy, msgify, numpify

__all__ = [
    "converts_from_numpy",
    "converts_to_numpy",
    "geometry",
    "image",
    "msgify",
    "numpify",
    "occupancy_grid",
    "point_cloud2",
]
