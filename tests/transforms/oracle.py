"""The same mathematics by other means: rotation matrices, made from an axis and an angle."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from fibws.tf.transform import Quaternion, Transform, Vector

Matrix: TypeAlias = NDArray[np.floating[Any]]


def rotation_matrix(axis: Vector, angle: float) -> Matrix:
    """Rodrigues' formula: the rotation by ``angle`` around ``axis``, whose length is 1."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=np.float64)
    rotation: Matrix = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return rotation


def quaternion(axis: Vector, angle: float) -> Quaternion:
    x, y, z = (component * math.sin(angle / 2) for component in axis)
    return (x, y, z, math.cos(angle / 2))


def matrix_of(rotation: Quaternion) -> Matrix:
    """The columns of the matrix of a quaternion of length 1."""
    x, y, z, w = rotation
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def homogeneous(transform: Transform) -> Matrix:
    matrix = np.eye(4)
    matrix[:3, :3] = matrix_of(transform.rotation)
    matrix[:3, 3] = transform.translation
    return matrix


def assert_same(transform: Transform, matrix: Matrix, scale: float = 1.0) -> None:
    """Compare a transform with the matrix that it should be; ``scale`` is of the lengths in it."""
    np.testing.assert_allclose(homogeneous(transform), matrix, atol=1e-11 * (1 + scale), rtol=0)


lengths = st.floats(-1000, 1000)
vectors = st.tuples(lengths, lengths, lengths)
ratios = st.floats(0, 1)
angles = st.floats(-math.pi, math.pi) | st.floats(-1e-6, 1e-6)


@st.composite
def axes(draw: st.DrawFn) -> Vector:
    """Directions, of length 1."""
    height, turn = draw(st.floats(-1, 1)), draw(st.floats(0, 2 * math.pi))
    radius = math.sqrt(1 - height * height)
    x, y, z = radius * math.cos(turn), radius * math.sin(turn), height
    length = math.hypot(x, y, z)
    return (x / length, y / length, z / length)


rotations = st.builds(quaternion, axes(), angles)
transforms = st.builds(Transform, vectors, rotations)
