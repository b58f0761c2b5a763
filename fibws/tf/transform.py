"""Arithmetic with translations and rotations.

Quaternions are ``(x, y, z, w)`` as in geometry_msgs/Quaternion, usually of length 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, dist, hypot, sin
from operator import add, mul
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]

NO_TRANSLATION: Vector = (0.0, 0.0, 0.0)
NO_ROTATION: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Transform:
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
    half = angle(first, second) / 2
    if sum(map(mul, first, second)) < 0:
        x, y, z, w = second
        second = (-x, -y, -z, -w)
    if half < 1e-6:  # So close that the arc is its chord, while sines of it are near 0.
        share, rest = ratio, 1 - ratio
    else:
        share, rest = sin(ratio * half) / sin(half), sin((1 - ratio) * half) / sin(half)
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return normalized(
        (
            ax * rest + bx * share,
            ay * rest + by * share,
            az * rest + bz * share,
            aw * rest + bw * share,
        )
    )


def of_yaw_pitch_roll(yaw: float, pitch: float, roll: float) -> Quaternion:
    """Return the rotation by ``roll`` about x, then ``pitch`` about y, then ``yaw`` about z.

    The angles are in radians and the axes are fixed, as in REP 103.
    """
    about_x = (sin(roll / 2), 0.0, 0.0, cos(roll / 2))
    about_y = (0.0, sin(pitch / 2), 0.0, cos(pitch / 2))
    about_z = (0.0, 0.0, sin(yaw / 2), cos(yaw / 2))
    return product(about_z, product(about_y, about_x))
