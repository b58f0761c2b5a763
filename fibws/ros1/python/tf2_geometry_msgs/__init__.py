"""Transforming messages of geometry_msgs; importing it registers them with tf2_ros.

buffer.transform(point_stamped, "map")
"""

from tf2_geometry_msgs.tf2_geometry_msgs import (
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    Vector3Stamped,
    WrenchStamped,
    do_transform_point,
    do_transform_pose,
    do_transform_pose_with_covariance_stamped,
    do_transform_vector3,
    do_transform_wrench,
    from_msg_msg,
    to_msg_msg,
    transform_to_kdl,
)

__all__ = [
    "PointStamped",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "Vector3Stamped",
    "WrenchStamped",
    "do_transform_point",
    "do_transform_pose",
    "do_transform_pose_with_covariance_stamped",
    "do_transform_vector3",
    "do_transform_wrench",
    "from_msg_msg",
    "to_msg_msg",
    "transform_to_kdl",
]
