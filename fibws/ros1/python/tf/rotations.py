"""Vectors, quaternions and Euler angles; scripts import them from `tf.transformations`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy

Array: TypeAlias = numpy.ndarray[Any, Any]
Axes: TypeAlias = str | Sequence[int]

_EPS = float(numpy.finfo(float).eps) * 4.0

_NEXT_AXIS = [1, 2, 0, 1]
"""The axis after each, in the order x, y, z, x."""


def _axes_table() -> dict[str, tuple[int, int, int, int]]:
    """Return all conventions of Euler angles: (first axis, parity, repetition, frame)."""
    table = {}
    for first in range(3):
        for parity in range(2):
            second = _NEXT_AXIS[first + parity]
            third = _NEXT_AXIS[first - parity + 1]
            for repetition in range(2):
                letters = "xyz"[first] + "xyz"[second] + "xyz"[first if repetition else third]
                table[f"s{letters}"] = (first, parity, repetition, 0)
                table[f"r{letters[::-1]}"] = (first, parity, repetition, 1)
    return table


_AXES2TUPLE = _axes_table()
_TUPLE2AXES = {numbers: letters for letters, numbers in _AXES2TUPLE.items()}


# Vectors


def vector_norm(data: Any, axis: int | None = None, out: Array | None = None) -> Any:
    """Return the Euclidean length of an array, or of its vectors along an axis.

    Args:
        out: an array for the result; None is returned then.
    """
    squares = numpy.square(numpy.array(data, dtype=numpy.float64))
    if out is None:
        if axis is None:
            return math.sqrt(squares.sum())
        return numpy.sqrt(squares.sum(axis=axis))
    numpy.sqrt(squares.sum(axis=axis), out=out)
    return None


def unit_vector(data: Any, axis: int | None = None, out: Array | None = None) -> Any:
    """Return an array scaled to length 1, or each of its vectors along an axis.

    Args:
        out: an array for the result, which may be ``data`` itself; None is returned then.
    """
    vectors = numpy.array(data, dtype=numpy.float64)
    if axis is None:
        lengths: Any = numpy.sqrt(numpy.square(vectors).sum())
    else:
        lengths = numpy.sqrt(numpy.square(vectors).sum(axis=axis, keepdims=True))
    vectors /= lengths
    if out is None:
        return vectors
    out[...] = vectors
    return None


def random_vector(size: Any) -> Array:
    """Return an array of random numbers between 0 and 1."""
    numbers: Array = numpy.random.random(size)
    return numbers


# Quaternions


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: Axes = "sxyz") -> Array:
    """Return the quaternion of Euler angles.

    Args:
        ai: roll, with the default axes.
        aj: pitch.
        ak: yaw.
        axes: the convention of the angles.
    """
    first, parity, repetition, frame = _convention(axes)
    second, third = _NEXT_AXIS[first + parity], _NEXT_AXIS[first - parity + 1]
    if frame:
        ai, ak = ak, ai
    if parity:
        aj = -aj
    si, ci = math.sin(ai / 2), math.cos(ai / 2)
    sj, cj = math.sin(aj / 2), math.cos(aj / 2)
    sk, ck = math.sin(ak / 2), math.cos(ak / 2)
    result = numpy.empty(4)
    if repetition:
        result[first] = cj * (ci * sk + si * ck)
        result[second] = sj * (ci * ck + si * sk)
        result[third] = sj * (ci * sk - si * ck)
        result[3] = cj * (ci * ck - si * sk)
    else:
        result[first] = cj * si * ck - sj * ci * sk
        result[second] = cj * si * sk + sj * ci * ck
        result[third] = cj * ci * sk - sj * si * ck
        result[3] = cj * ci * ck + sj * si * sk
    if parity:
        result[second] *= -1
    return result


def quaternion_about_axis(angle: float, axis: Sequence[float]) -> Array:
    """Return the quaternion of the rotation by an angle about an axis."""
    result = numpy.zeros(4)
    result[:3] = axis[:3]
    length = vector_norm(result)
    if length > _EPS:
        result *= math.sin(angle / 2) / length
    result[3] = math.cos(angle / 2)
    return result


def quaternion_matrix(quaternion: Any) -> Array:
    """Return the matrix of a quaternion of any length; the identity for zeros."""
    x, y, z, w = numpy.array(quaternion, dtype=numpy.float64)[:4]
    square = x * x + y * y + z * z + w * w
    if square < _EPS:
        return numpy.identity(4)
    s = 2.0 / square
    return numpy.array(
        [
            [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0.0],
            [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0.0],
            [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def quaternion_from_matrix(matrix: Any) -> Array:
    """Return the quaternion of the rotation in a matrix.

    w is positive, or else the largest of the others.
    """
    m = numpy.array(matrix, dtype=numpy.float64)[:4, :4]
    result = numpy.empty(4)
    trace = numpy.trace(m)
    if trace > m[3, 3]:
        square = trace
        result[:] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], trace
    else:
        i = int(numpy.argmax(numpy.diagonal(m)[:3]))
        j, k = (i + 1) % 3, (i + 2) % 3
        square = m[i, i] - (m[j, j] + m[k, k]) + m[3, 3]
        result[i] = square
        result[j], result[k] = m[i, j] + m[j, i], m[k, i] + m[i, k]
        result[3] = m[k, j] - m[j, k]
    return result * (0.5 / math.sqrt(square * m[3, 3]))


def quaternion_multiply(quaternion1: Any, quaternion0: Any) -> Array:
    """Return the rotation by ``quaternion0`` and then by ``quaternion1``."""
    bx, by, bz, bw = quaternion0
    ax, ay, az, aw = quaternion1
    return numpy.array(
        (
            ax * bw + ay * bz - az * by + aw * bx,
            -ax * bz + ay * bw + az * bx + aw * by,
            ax * by - ay * bx + az * bw + aw * bz,
            -ax * bx - ay * by - az * bz + aw * bw,
        ),
        dtype=numpy.float64,
    )


def quaternion_conjugate(quaternion: Any) -> Array:
    """Return a quaternion with x, y and z negated."""
    x, y, z, w = quaternion
    return numpy.array((-x, -y, -z, w), dtype=numpy.float64)


def quaternion_inverse(quaternion: Any) -> Array:
    """Return the inverse of a quaternion."""
    inverse: Array = quaternion_conjugate(quaternion) / numpy.dot(quaternion, quaternion)
    return inverse


def quaternion_slerp(
    quat0: Any, quat1: Any, fraction: float, spin: int = 0, shortestpath: bool = True
) -> Array:
    """Return a rotation between two, at constant speed.

    Args:
        fraction: 0 gives the first, 1 the second.
        spin: how many half turns to make besides.
        shortestpath: go the shorter way around.
    """
    first, second = unit_vector(quat0[:4]), unit_vector(quat1[:4])
    if fraction == 0.0:
        return first  # type: ignore[no-any-return]
    if fraction == 1.0:
        return second  # type: ignore[no-any-return]
    cosine = numpy.dot(first, second)
    if abs(abs(cosine) - 1.0) < _EPS:
        return first  # type: ignore[no-any-return]
    if shortestpath and cosine < 0.0:
        cosine, second = -cosine, -second
    angle = math.acos(cosine) + spin * math.pi
    if abs(angle) < _EPS:
        return first  # type: ignore[no-any-return]
    result: Array = math.sin((1.0 - fraction) * angle) * first + math.sin(fraction * angle) * second
    return result / math.sin(angle)


def random_quaternion(rand: Sequence[float] | None = None) -> Array:
    """Return a rotation that is uniformly distributed.

    Args:
        rand: three independent random numbers between 0 and 1; None for new ones.
    """
    numbers = numpy.random.rand(3) if rand is None else rand
    assert len(numbers) == 3
    inner, outer = math.sqrt(1.0 - numbers[0]), math.sqrt(numbers[0])
    a, b = 2 * math.pi * numbers[1], 2 * math.pi * numbers[2]
    return numpy.array(
        (math.sin(a) * inner, math.cos(a) * inner, math.sin(b) * outer, math.cos(b) * outer)
    )


def random_rotation_matrix(rand: Sequence[float] | None = None) -> Array:
    """Return the matrix of `random_quaternion`."""
    return quaternion_matrix(random_quaternion(rand))


# Euler angles


def euler_matrix(ai: float, aj: float, ak: float, axes: Axes = "sxyz") -> Array:
    """Return the matrix of Euler angles; the arguments are those of `quaternion_from_euler`."""
    return quaternion_matrix(quaternion_from_euler(ai, aj, ak, axes))


def euler_from_matrix(matrix: Any, axes: Axes = "sxyz") -> tuple[float, float, float]:
    """Return the Euler angles of the rotation in a matrix: roll, pitch and yaw by default.

    Other angles may give the same rotation.
    """
    i, parity, repetition, frame = _convention(axes)
    j, k = _NEXT_AXIS[i + parity], _NEXT_AXIS[i - parity + 1]
    m = numpy.array(matrix, dtype=numpy.float64)[:3, :3].tolist()
    if repetition:
        sine = math.hypot(m[i][j], m[i][k])
        middle = math.atan2(sine, m[i][i])
        if sine > _EPS:
            first, last = math.atan2(m[i][j], m[i][k]), math.atan2(m[j][i], -m[k][i])
        else:
            first, last = math.atan2(-m[j][k], m[j][j]), 0.0
    else:
        cosine = math.hypot(m[i][i], m[j][i])
        middle = math.atan2(-m[k][i], cosine)
        if cosine > _EPS:
            first, last = math.atan2(m[k][j], m[k][k]), math.atan2(m[j][i], m[i][i])
        else:
            first, last = math.atan2(-m[j][k], m[j][j]), 0.0
    if parity:
        first, middle, last = -first, -middle, -last
    return (last, middle, first) if frame else (first, middle, last)


def euler_from_quaternion(quaternion: Any, axes: Axes = "sxyz") -> tuple[float, float, float]:
    """Return the Euler angles of a quaternion; see `euler_from_matrix`."""
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def _convention(axes: Axes) -> tuple[int, int, int, int]:
    """Return a convention as four numbers.

    Raises:
        KeyError: it is unknown.
    """
    if isinstance(axes, str):
        return _AXES2TUPLE[axes.lower()]
    first, parity, repetition, frame = axes
    return _AXES2TUPLE[_TUPLE2AXES[(first, parity, repetition, frame)]]
