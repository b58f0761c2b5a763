"""Arithmetic with translations and rotations.

Quaternions are ``(x, y, z, w)`` as in geometry_msgs/Quaternion, usually of length 1.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import asin, atan2, cos, dist, hypot, sin, sqrt
from operator import add
from typing import NamedTuple, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]
Link: TypeAlias = tuple[str, float, float, float, float, float, float, float]
"""A frame's parent, and its transform there: x, y and z, and those of the quaternion with w.

Python's garbage collector does not visit such a tuple, of which histories have many thousands."""

NO_TRANSLATION: Vector = (0.0, 0.0, 0.0)
NO_ROTATION: Quaternion = (0.0, 0.0, 0.0, 1.0)


class Transform(NamedTuple):
    """The position and orientation of a frame in its parent.

    It turns coordinates in the frame into coordinates in the parent.

    Args:
        translation: metres.
        rotation: a quaternion of length 1.
    """

    translation: Vector = NO_TRANSLATION
    rotation: Quaternion = NO_ROTATION

    def __matmul__(self, inner: Transform) -> Transform:
        """Apply ``inner`` and then this, as with matrices: map→odom @ odom→base is map→base."""
        x, y, z = rotated(inner.translation, self.rotation)
        dx, dy, dz = self.translation
        return Transform((x + dx, y + dy, z + dz), product(self.rotation, inner.rotation))

    def inverse(self) -> Transform:
        """Return the inverse transform."""
        rotation = conjugate(self.rotation)
        x, y, z = rotated(self.translation, rotation)
        return Transform((-x, -y, -z), rotation)

    def distance(self, other: Transform) -> float:
        """Return the distance of the translations in metres."""
        return dist(self.translation, other.translation)

    def angle(self, other: Transform) -> float:
        """Return the angle between the rotations, in radians from 0 to pi."""
        return angle(self.rotation, other.rotation)

    def interpolated(self, other: Transform, ratio: float) -> Transform:
        """Interpolate towards another transform: ``ratio`` 0 gives this one, 1 the other."""
        (x, y, z), (to_x, to_y, to_z) = self.translation, other.translation
        rest = 1 - ratio
        return Transform(
            (x * rest + to_x * ratio, y * rest + to_y * ratio, z * rest + to_z * ratio),
            slerp(self.rotation, other.rotation, ratio),
        )


def product(left: Quaternion, right: Quaternion) -> Quaternion:
    """Return the rotation by ``right`` and then by ``left``."""
    ax, ay, az, aw = left
    bx, by, bz, bw = right
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(rotation: Quaternion) -> Quaternion:
    """Return the inverse rotation."""
    x, y, z, w = rotation
    return (-x, -y, -z, w)


def normalized(quaternion: Quaternion) -> Quaternion:
    """Return a quaternion scaled to length 1.

    Raises:
        ZeroDivisionError: its length is 0.
    """
    x, y, z, w = quaternion
    length = hypot(x, y, z, w)
    return (x / length, y / length, z / length, w / length)


def rotated(vector: Vector, rotation: Quaternion) -> Vector:
    """Return a rotated vector."""
    vx, vy, vz = vector
    x, y, z, w = rotation
    # v + 2w (q x v) + 2 q x (q x v), which is q v q* for a q of length 1, in half the products.
    cx, cy, cz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
    return (
        vx + w * cx + y * cz - z * cy,
        vy + w * cy + z * cx - x * cz,
        vz + w * cz + x * cy - y * cx,
    )


def angle(first: Quaternion, second: Quaternion) -> float:
    """Return the angle between two rotations, in radians from 0 to pi."""
    apart, along = dist(first, second), hypot(*map(add, first, second))
    # q and -q are one rotation. The arc tangent is exact where the cosine's is not: near 0.
    return 4 * atan2(min(apart, along), max(apart, along))


def slerp(first: Quaternion, second: Quaternion, ratio: float) -> Quaternion:
    """Interpolate between two rotations along the shortest arc, at constant speed."""
    if first == second:
        return first
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    if ax * bx + ay * by + az * bz + aw * bw < 0:
        bx, by, bz, bw = -bx, -by, -bz, -bw
    # The arc sine is exact where the arc cosine of the product is not: near 0.
    x, y, z, w = ax - bx, ay - by, az - bz, aw - bw
    half = 2 * asin(min(1.0, sqrt(x * x + y * y + z * z + w * w) / 2))
    if half < 1e-6:  # So close that the arc is its chord, while sines of it are near 0.
        share, rest = ratio, 1 - ratio
    else:
        share, rest = sin(ratio * half) / sin(half), sin((1 - ratio) * half) / sin(half)
    return normalized(
        (
            ax * rest + bx * share,
            ay * rest + by * share,
            az * rest + bz * share,
            aw * rest + bw * share,
        )
    )


def link_of(parent: str, transform: Transform) -> Link:
    """Return a transform in a parent as a flat tuple of floats; it may have numbers of numpy."""
    x, y, z = map(float, transform.translation)
    qx, qy, qz, qw = map(float, transform.rotation)
    return (parent, x, y, z, qx, qy, qz, qw)


def transform_of(link: Link) -> Transform:
    """Return the transform of a flat tuple."""
    _, x, y, z, qx, qy, qz, qw = link
    return Transform((x, y, z), (qx, qy, qz, qw))


def with_sign_of_matrix(rotation: Quaternion) -> Quaternion:
    """Return the one of a quaternion and its negative that conversions of its matrix give.

    w is positive, or else the largest of the others, as with tf's transformations and KDL.
    """
    x, y, z, w = rotation
    leading = w if 4 * w * w > 1 else max(x, y, z, key=abs)
    return (-x, -y, -z, -w) if leading < 0 else rotation


def along(links: Iterable[Link]) -> Transform:
    """Return the product of transforms: from the first one's frame to the last one's parent.

    It is the same as ``last @ ... @ second @ first``, in half the time.
    """
    x = y = z = qx = qy = qz = 0.0
    qw = 1.0
    for _, dx, dy, dz, bx, by, bz, bw in links:
        cx, cy, cz = 2 * (by * z - bz * y), 2 * (bz * x - bx * z), 2 * (bx * y - by * x)
        x, y, z = (
            x + bw * cx + by * cz - bz * cy + dx,
            y + bw * cy + bz * cx - bx * cz + dy,
            z + bw * cz + bx * cy - by * cx + dz,
        )
        qx, qy, qz, qw = (
            bw * qx + bx * qw + by * qz - bz * qy,
            bw * qy - bx * qz + by * qw + bz * qx,
            bw * qz + bx * qy - by * qx + bz * qw,
            bw * qw - bx * qx - by * qy - bz * qz,
        )
    return Transform((x, y, z), (qx, qy, qz, qw))


def of_yaw_pitch_roll(yaw: float, pitch: float, roll: float) -> Quaternion:
    """Return the rotation by ``roll`` about x, then ``pitch`` about y, then ``yaw`` about z.

    The angles are in radians and the axes are fixed, as in REP 103.
    """
    about_x = (sin(roll / 2), 0.0, 0.0, cos(roll / 2))
    about_y = (0.0, sin(pitch / 2), 0.0, cos(pitch / 2))
    about_z = (0.0, 0.0, sin(yaw / 2), cos(yaw / 2))
    return product(about_z, product(about_y, about_x))


def roll_pitch_yaw(rotation: Quaternion) -> Vector:
    """Return the angles, in radians, about the fixed axes x, y and z, in this order.

    They are those of `of_yaw_pitch_roll`; if the pitch is a right angle, the yaw is 0.
    """
    x, y, z, w = rotation
    sine = 2 * (w * y - x * z)
    across = hypot(1 - 2 * (y * y + z * z), 2 * (x * y + w * z))
    pitch = atan2(sine, across)
    if across < 1e-9:
        return (atan2(2 * (w * x - y * z), 1 - 2 * (x * x + z * z)), pitch, 0.0)
    roll = atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return (roll, pitch, atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z)))
