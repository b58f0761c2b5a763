"""Converting between PyKDL's frames, messages, tf's tuples and matrices.

Frames need PyKDL (Debian: python3-pykdl), matrices numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geometry_msgs.msg import Pose

try:
    from PyKDL import *  # noqa: F403 (as in ROS, where programs use its names of this module)
    from PyKDL import Frame, Rotation, Vector
except ModuleNotFoundError as error:
    if error.name != "PyKDL":
        raise
    raise ModuleNotFoundError(
        "No module named 'PyKDL', which tf_conversions.posemath needs: install Debian's "
        "python3-pykdl, which only the system's Python finds; without it, use tf.transformations",
        name="PyKDL",
    ) from None


def fromTf(tf: tuple[Sequence[float], Sequence[float]]) -> Any:
    """Return the frame of a translation and a quaternion, as `tf.Transformer.lookupTransform`'s."""
    (x, y, z), (qx, qy, qz, qw) = tf
    return Frame(Rotation.Quaternion(qx, qy, qz, qw), Vector(x, y, z))


def toTf(f: Any) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """Return the translation and the quaternion x, y, z, w of a frame."""
    return (f.p[0], f.p[1], f.p[2]), f.M.GetQuaternion()


def fromMsg(p: Any) -> Any:
    """Return the frame of a geometry_msgs/Pose."""
    position, turn = p.position, p.orientation
    return fromTf(((position.x, position.y, position.z), (turn.x, turn.y, turn.z, turn.w)))


def toMsg(f: Any) -> Any:
    """Return the geometry_msgs/Pose of a frame."""
    pose = Pose()
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = f.M.GetQuaternion()
    pose.position.x, pose.position.y, pose.position.z = f.p[0], f.p[1], f.p[2]
    return pose


def fromMatrix(m: Any) -> Any:
    """Return the frame of a 4x4 matrix of numpy."""
    rotation = Rotation(*(m[row, column] for row in range(3) for column in range(3)))
    return Frame(rotation, Vector(m[0, 3], m[1, 3], m[2, 3]))


def toMatrix(f: Any) -> Any:
    """Return the 4x4 matrix of a frame, as an array of numpy."""
    import numpy

    matrix = numpy.identity(4)
    for row in range(3):
        matrix[row] = [*(f.M[row, column] for column in range(3)), f.p[row]]
    return matrix


def fromCameraParams(cv2: Any, rvec: Any, tvec: Any) -> Any:
    """Return the frame of the results of OpenCV's solvePnP.

    Args:
        cv2: the module of OpenCV.
        rvec: the rotation vector, 3x1.
        tvec: the translation, 3x1.
    """
    x, y, z = (tvec[row, 0] for row in range(3))
    matrix = cv2.Rodrigues(rvec)[0]
    rotation = Rotation(*(matrix[row, column] for row in range(3) for column in range(3)))
    return Frame(rotation, Vector(x, y, z))
