"""Points, rotations and poses; a pose is a matrix of 4 x 4."""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Point32, Pose, Quaternion, Transform, Vector3
from tf import transformations

from ros_numpy.registry import converts_from_numpy, converts_to_numpy


@converts_to_numpy(Vector3)
@converts_to_numpy(Point)
@converts_to_numpy(Point32)
def vector_to_numpy(msg: Any, hom: bool = False) -> Any:
    """Return x, y and z, and 1 if ``hom``."""
    return np.array([msg.x, msg.y, msg.z, 1] if hom else [msg.x, msg.y, msg.z])


@converts_from_numpy(Vector3)
def numpy_to_vector3(arr: Any) -> Vector3:
    """Return the Vector3 of x, y, z, or of a homogeneous direction, whose last number is 0."""
    return Vector3(*_checked(arr, 0))


@converts_from_numpy(Point)
def numpy_to_point(arr: Any) -> Point:
    """Return the Point of x, y, z, or of homogeneous coordinates."""
    if np.shape(arr)[-1] == 4:
        arr = np.asarray(arr)[:-1] / arr[-1]
    return Point(*_checked(arr, 1))


@converts_to_numpy(Quaternion)
def quat_to_numpy(msg: Quaternion) -> Any:
    """Return x, y, z and w."""
    return np.array([msg.x, msg.y, msg.z, msg.w])


@converts_from_numpy(Quaternion)
def numpy_to_quat(arr: Any) -> Quaternion:
    """Return the Quaternion of x, y, z and w; raises ValueError for other shapes."""
    if np.shape(arr) != (4,):
        raise ValueError(f"expected 4 numbers, got the shape {np.shape(arr)}")
    return Quaternion(*arr)


@converts_to_numpy(Transform)
def transform_to_numpy(msg: Transform) -> Any:
    """Return the matrix of 4 x 4."""
    return _matrix(msg.translation, msg.rotation)


@converts_from_numpy(Transform)
def numpy_to_transform(arr: Any) -> Transform:
    """Return the Transform of a matrix of 4 x 4; raises ValueError for other shapes."""
    translation, rotation = _parts(arr)
    return Transform(Vector3(*translation), Quaternion(*rotation))


@converts_to_numpy(Pose)
def pose_to_numpy(msg: Pose) -> Any:
    """Return the matrix of 4 x 4."""
    return _matrix(msg.position, msg.orientation)


@converts_from_numpy(Pose)
def numpy_to_pose(arr: Any) -> Pose:
    """Return the Pose of a matrix of 4 x 4; raises ValueError for other shapes."""
    translation, rotation = _parts(arr)
    return Pose(Point(*translation), Quaternion(*rotation))


def _checked(arr: Any, last: float) -> Any:
    """Return three numbers, or the first three of four of which the last is as given."""
    numbers = np.asarray(arr)
    if numbers.shape == (4,) and numbers[3] == last:
        numbers = numbers[:3]
    if numbers.shape != (3,):
        raise ValueError(f"expected 3 numbers, or 4 with {last} at the end, got {numbers}")
    return numbers


def _matrix(position: Any, rotation: Any) -> Any:
    matrix = transformations.quaternion_matrix(quat_to_numpy(rotation))
    matrix[:3, 3] = vector_to_numpy(position)
    return matrix


def _parts(arr: Any) -> tuple[Any, Any]:
    if np.shape(arr) != (4, 4):
        raise ValueError(f"expected a matrix of 4 x 4, got the shape {np.shape(arr)}")
    return (
        transformations.translation_from_matrix(arr),
        transformations.quaternion_from_matrix(arr),
    )
