"""The function that transforms point clouds; with numpy if that is installed."""

from __future__ import annotations

from typing import Any

import tf2_ros
from sensor_msgs.msg import PointCloud2
from sensor_msgs.point_cloud2 import create_cloud, read_points
from tf2_geometry_msgs import from_msg_msg, to_msg_msg, transform_to_kdl

from fibws.tf.transform import Transform

__all__ = ["PointCloud2", "do_transform_cloud", "from_msg_msg", "to_msg_msg", "transform_to_kdl"]


def do_transform_cloud(cloud: Any, transform: Any) -> Any:
    """Return a PointCloud2 in the frame of a TransformStamped.

    Its first three fields are x, y and z; the others are copied. The result has one row.
    """
    points = list(read_points(cloud))
    t, r = transform.transform.translation, transform.transform.rotation
    moved = _moved(points, Transform((t.x, t.y, t.z), (r.x, r.y, r.z, r.w)))
    return create_cloud(transform.header, cloud.fields, moved)


def _moved(points: list[tuple[Any, ...]], transform: Transform) -> list[tuple[Any, ...]]:
    try:
        import numpy
    except ImportError:
        return [
            (*(transform @ Transform((x, y, z))).translation, *others)
            for x, y, z, *others in points
        ]
    if not points:
        return []
    columns = [
        (transform @ Transform(axis)).translation
        for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    ]
    origin = numpy.array(transform.translation)
    places = numpy.array([point[:3] for point in points], dtype=numpy.float64)
    moved = (places @ (numpy.array(columns) - origin) + origin).tolist()
    return [(*place, *point[3:]) for place, point in zip(moved, points, strict=True)]


tf2_ros.TransformRegistration().add(PointCloud2, do_transform_cloud)
tf2_ros.ConvertRegistration().add_to_msg(PointCloud2, to_msg_msg)
tf2_ros.ConvertRegistration().add_from_msg(PointCloud2, from_msg_msg)
