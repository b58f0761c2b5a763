"""Transforming point clouds; importing it registers them with tf2_ros."""

from tf2_sensor_msgs.tf2_sensor_msgs import (
    PointCloud2,
    do_transform_cloud,
    from_msg_msg,
    to_msg_msg,
    transform_to_kdl,
)

__all__ = ["PointCloud2", "do_transform_cloud", "from_msg_msg", "to_msg_msg", "transform_to_kdl"]
