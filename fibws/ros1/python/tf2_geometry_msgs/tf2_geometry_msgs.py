"""The functions that transform messages of geometry_msgs, without KDL."""

from __future__ import annotations

from typing import Any

import tf2_ros
from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    Vector3Stamped,
    WrenchStamped,
)

from fibws.tf.transform import Transform, rotated, with_sign_of_matrix

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


def to_msg_msg(msg: Any) -> Any:
    """Return a message unchanged."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """Return a message unchanged."""
    return msg


def transform_to_kdl(t: Any) -> Any:
    """Return a TransformStamped as a PyKDL.Frame.

    Raises:
        ImportError: PyKDL is not installed.
    """
    from tf_conversions.posemath import fromTf

    translation, rotation = _transform_of(t)
    return fromTf((translation, rotation))


def do_transform_point(point: Any, transform: Any) -> Any:
    """Return a PointStamped in the frame of a TransformStamped."""
    result = PointStamped()
    position = _vector(point.point)
    result.point.x, result.point.y, result.point.z = _moved(position, _transform_of(transform))
    result.header = transform.header
    return result


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """Return a Vector3Stamped in the frame of a TransformStamped; it is only rotated."""
    result = Vector3Stamped()
    result.vector.x, result.vector.y, result.vector.z = rotated(
        _vector(vector3.vector), _transform_of(transform).rotation
    )
    result.header = transform.header
    return result


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """Return a PoseStamped in the frame of a TransformStamped."""
    result = PoseStamped()
    _set_pose(result.pose, pose.pose, _transform_of(transform))
    result.header = transform.header
    return result


def do_transform_pose_with_covariance_stamped(pose: Any, transform: Any) -> Any:
    """Return a PoseWithCovarianceStamped in the frame of a TransformStamped."""
    result, moved = PoseWithCovarianceStamped(), _transform_of(transform)
    _set_pose(result.pose.pose, pose.pose.pose, moved)
    result.pose.covariance = _rotated_covariance(list(pose.pose.covariance), moved)
    result.header = transform.header
    return result


def do_transform_wrench(wrench: Any, transform: Any) -> Any:
    """Return a WrenchStamped in the frame of a TransformStamped; both vectors are only rotated."""
    result, rotation = WrenchStamped(), _transform_of(transform).rotation
    for name in ("force", "torque"):
        vector = getattr(result.wrench, name)
        vector.x, vector.y, vector.z = rotated(_vector(getattr(wrench.wrench, name)), rotation)
    result.header = transform.header
    return result


def _set_pose(result: Any, pose: Any, transform: Transform) -> None:
    o = pose.orientation
    moved = transform @ Transform(_vector(pose.position), (o.x, o.y, o.z, o.w))
    result.position.x, result.position.y, result.position.z = moved.translation
    o = result.orientation
    o.x, o.y, o.z, o.w = with_sign_of_matrix(moved.rotation)


def _rotated_covariance(covariance: list[float], transform: Transform) -> list[float]:
    """Return a 6x6 covariance, whose four blocks are rotated: R block R^T."""
    axes = [rotated(axis, transform.rotation) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    result = [0.0] * 36
    for corner in (0, 3, 18, 21):
        for row in range(3):
            for column in range(3):
                result[corner + 6 * row + column] = sum(
                    axes[i][row] * covariance[corner + 6 * i + j] * axes[j][column]
                    for i in range(3)
                    for j in range(3)
                )
    return result


def _transform_of(message: Any) -> Transform:
    rotation = message.transform.rotation
    return Transform(
        _vector(message.transform.translation), (rotation.x, rotation.y, rotation.z, rotation.w)
    )


def _vector(message: Any) -> tuple[float, float, float]:
    return (message.x, message.y, message.z)


def _moved(vector: tuple[float, float, float], transform: Transform) -> tuple[float, float, float]:
    x, y, z = rotated(vector, transform.rotation)
    dx, dy, dz = transform.translation
    return (x + dx, y + dy, z + dz)


_transforms, _conversions = tf2_ros.TransformRegistration(), tf2_ros.ConvertRegistration()
for _type, _function in (
    (PointStamped, do_transform_point),
    (Vector3Stamped, do_transform_vector3),
    (PoseStamped, do_transform_pose),
    (PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped),
    (WrenchStamped, do_transform_wrench),
):
    _transforms.add(_type, _function)
    _conversions.add_to_msg(_type, to_msg_msg)
    _conversions.add_from_msg(_type, from_msg_msg)
