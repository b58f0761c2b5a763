"""Homogeneous 4x4 matrices; scripts import them from `tf.transformations`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy

from tf.rotations import _EPS, Array, euler_matrix, quaternion_matrix, unit_vector, vector_norm


def identity_matrix() -> Array:
    """Return the matrix that changes nothing."""
    return numpy.identity(4)


def translation_matrix(direction: Any) -> Array:
    """Return the matrix that moves points by a vector."""
    matrix = numpy.identity(4)
    matrix[:3, 3] = direction[:3]
    return matrix


def translation_from_matrix(matrix: Any) -> Array:
    """Return the vector by which a matrix moves points."""
    return _array(matrix)[:3, 3].copy()


def reflection_matrix(point: Any, normal: Any) -> Array:
    """Return the matrix that mirrors points at the plane through a point."""
    across = unit_vector(normal[:3])
    matrix = numpy.identity(4)
    matrix[:3, :3] -= 2.0 * numpy.outer(across, across)
    matrix[:3, 3] = 2.0 * numpy.dot(point[:3], across) * across
    return matrix


def reflection_from_matrix(matrix: Any) -> tuple[Array, Array]:
    """Return a point of the plane at which a matrix mirrors, and its normal.

    Raises:
        ValueError: it does not mirror.
    """
    m = _array(matrix)
    normal = _eigenvector(m[:3, :3], -1.0, "no unit eigenvector corresponding to eigenvalue -1")
    point = _eigenvector(m, 1.0, "no unit eigenvector corresponding to eigenvalue 1")
    return point / point[3], normal


def rotation_matrix(angle: float, direction: Any, point: Any = None) -> Array:
    """Return the matrix that turns points about an axis.

    Args:
        angle: the angle.
        direction: the axis.
        point: a point of the axis; None for the origin.
    """
    axis = unit_vector(direction[:3])
    x, y, z = axis
    rotation = math.cos(angle) * numpy.identity(3)
    rotation += (1.0 - math.cos(angle)) * numpy.outer(axis, axis)
    rotation += math.sin(angle) * numpy.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return _about(rotation, point)


def rotation_from_matrix(matrix: Any) -> tuple[float, Array, Array]:
    """Return the angle by which a matrix turns points, the axis, and a point of it.

    Raises:
        ValueError: it does not turn points.
    """
    m = _array(matrix)
    rotation = m[:3, :3]
    fault = "no unit eigenvector corresponding to eigenvalue 1"
    axis = _eigenvector(rotation.T, 1.0, fault)
    point = _eigenvector(m, 1.0, fault)
    cosine = (numpy.trace(rotation) - 1.0) / 2.0
    twice = (
        rotation[2, 1] - rotation[1, 2],
        rotation[0, 2] - rotation[2, 0],
        rotation[1, 0] - rotation[0, 1],
    )
    return math.atan2(numpy.dot(twice, axis) / 2.0, cosine), axis, point / point[3]


def scale_matrix(factor: float, origin: Any = None, direction: Any = None) -> Array:
    """Return the matrix that scales points.

    Args:
        factor: the factor; -1 mirrors.
        origin: the point that stays; None for the origin.
        direction: the only direction in which it scales; None for all.
    """
    if direction is None:
        scale = factor * numpy.identity(3)
    else:
        along = unit_vector(direction[:3])
        scale = numpy.identity(3) - (1.0 - factor) * numpy.outer(along, along)
    return _about(scale, origin)


def scale_from_matrix(matrix: Any) -> tuple[float, Array, Array | None]:
    """Return the factor by which a matrix scales, the point that stays, and the direction.

    The direction is None if it scales in all.

    Raises:
        ValueError: no point stays.
    """
    m = _array(matrix)
    factor = float(numpy.trace(m[:3, :3])) - 2.0
    values, vectors = numpy.linalg.eig(m[:3, :3])
    found = numpy.where(abs(numpy.real(values) - factor) < 1e-8)[0]
    direction: Array | None
    if len(found):
        direction = numpy.real(vectors[:, found[0]]).squeeze()
        direction = direction / vector_norm(direction)
    else:
        factor, direction = (factor + 2.0) / 3.0, None
    origin = _eigenvector(m, 1.0, "no eigenvector corresponding to eigenvalue 1")
    return factor, origin / origin[3], direction


def projection_matrix(
    point: Any, normal: Any, direction: Any = None, perspective: Any = None, pseudo: bool = False
) -> Array:
    """Return the matrix that projects points onto a plane.

    Args:
        point: a point of the plane.
        normal: its normal.
        direction: the direction of a parallel projection; None for the normal.
        perspective: the eye of a perspective projection, before ``direction``.
        pseudo: keep the depths of points in a perspective projection.
    """
    place = numpy.array(point[:3], dtype=numpy.float64)
    across = unit_vector(normal[:3])
    matrix = numpy.identity(4)
    if perspective is not None:
        eye = numpy.array(perspective[:3], dtype=numpy.float64)
        depth = numpy.dot(eye - place, across)
        matrix[:3, :3] *= depth
        matrix[:3, :3] -= numpy.outer(eye, across)
        if pseudo:
            matrix[:3, :3] -= numpy.outer(across, across)
            matrix[:3, 3] = numpy.dot(place, across) * (eye + across)
        else:
            matrix[:3, 3] = numpy.dot(place, across) * eye
        matrix[3, :3] = -across
        matrix[3, 3] = numpy.dot(eye, across)
        return matrix
    if direction is None:
        along = across
    else:
        along = numpy.array(direction[:3], dtype=numpy.float64)
    scale = numpy.dot(along, across)
    matrix[:3, :3] -= numpy.outer(along, across) / scale
    matrix[:3, 3] = along * (numpy.dot(place, across) / scale)
    return matrix


def projection_from_matrix(
    matrix: Any, pseudo: bool = False
) -> tuple[Array, Array, Array | None, Array | None, bool]:
    """Return the arguments of `projection_matrix` for a matrix.

    Args:
        pseudo: the matrix keeps depths.

    Raises:
        ValueError: it does not project.
    """
    m = _array(matrix)
    values, vectors = numpy.linalg.eig(m)
    ones = numpy.where(abs(numpy.real(values) - 1.0) < 1e-8)[0]
    if not pseudo and len(ones):
        point = numpy.real(vectors[:, ones[-1]]).squeeze()
        direction = _eigenvector(m[:3, :3], 0.0, "no eigenvector corresponding to eigenvalue 0")
        normal = _eigenvector(m[:3, :3].T, 0.0, "")
        return point / point[3], normal, direction, None, False
    others = numpy.where(abs(numpy.real(values)) > 1e-8)[0]
    if not len(others):
        raise ValueError("no eigenvector not corresponding to eigenvalue 0")
    point = numpy.real(vectors[:, others[-1]]).squeeze()
    point = point / point[3]
    normal = -m[3, :3]
    perspective = m[:3, 3] / numpy.dot(point[:3], normal)
    if pseudo:
        perspective = perspective - normal
    return point, normal, None, perspective, pseudo


def clip_matrix(
    left: float,
    right: float,
    bottom: float,
    top: float,
    near: float,
    far: float,
    perspective: bool = False,
) -> Array:
    """Return the matrix from a box, or a frustum, to the cube from -1 to 1.

    Args:
        perspective: it is a frustum, whose near plane is the rectangle.

    Raises:
        ValueError: the box is empty, or ``near`` is not in front of the eye.
    """
    if left >= right or bottom >= top or near >= far:
        raise ValueError("invalid frustrum")
    width, height, depth = right - left, top - bottom, far - near
    if not perspective:
        return numpy.array(
            [
                [2.0 / width, 0.0, 0.0, -(right + left) / width],
                [0.0, 2.0 / height, 0.0, -(top + bottom) / height],
                [0.0, 0.0, 2.0 / depth, -(far + near) / depth],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )
    if near <= _EPS:
        raise ValueError("invalid frustrum: near <= 0")
    return numpy.array(
        [
            [-2.0 * near / width, 0.0, (right + left) / width, 0.0],
            [0.0, -2.0 * near / height, (top + bottom) / height, 0.0],
            [0.0, 0.0, -(far + near) / depth, 2.0 * near * far / depth],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )


def shear_matrix(angle: float, direction: Any, point: Any, normal: Any) -> Array:
    """Return the matrix that shears points along a plane.

    Args:
        angle: the angle of the shear.
        direction: its direction, in the plane.
        point: a point of the plane.
        normal: the normal of the plane.

    Raises:
        ValueError: the direction is not in the plane.
    """
    across, along = unit_vector(normal[:3]), unit_vector(direction[:3])
    if abs(numpy.dot(across, along)) > 1e-6:
        raise ValueError("direction and normal vectors are not orthogonal")
    matrix = numpy.identity(4)
    matrix[:3, :3] += math.tan(angle) * numpy.outer(along, across)
    matrix[:3, 3] = -math.tan(angle) * numpy.dot(point[:3], across) * along
    return matrix


def shear_from_matrix(matrix: Any) -> tuple[float, Array, Array, Array]:
    """Return the arguments of `shear_matrix` for a matrix.

    Raises:
        ValueError: it does not shear.
    """
    m = _array(matrix)
    # It moves points by tan(angle) * direction * (normal . (point - p)): a matrix of rank 1.
    directions, sizes, normals = numpy.linalg.svd(m[:3, :3] - numpy.identity(3))
    direction, normal, tangent = directions[:, 0], normals[0], float(sizes[0])
    if tangent < _EPS or sizes[1] > 1e-4 or abs(numpy.dot(direction, normal)) > 1e-4:
        raise ValueError(f"No two linear independent eigenvectors found {m[:3, :3]}")
    point = numpy.array([*(-numpy.dot(m[:3, 3], direction) / tangent * normal), 1.0])
    return math.atan(tangent), direction, point, normal


def decompose_matrix(
    matrix: Any,
) -> tuple[Array, list[float], list[float], Array, Array]:
    """Return the scales, shears, Euler angles, translation and perspective in a matrix.

    `compose_matrix` is the inverse.

    Raises:
        ValueError: the matrix is singular.
    """
    m = _array(matrix).T
    if abs(m[3, 3]) < _EPS:
        raise ValueError("M[3, 3] is zero")
    m /= m[3, 3]
    linear = m.copy()
    linear[:, 3] = 0.0, 0.0, 0.0, 1.0
    if not numpy.linalg.det(linear):
        raise ValueError("Matrix is singular")
    if any(abs(m[:3, 3]) > _EPS):
        perspective = numpy.dot(m[:, 3], numpy.linalg.inv(linear.T))
        m[:, 3] = 0.0, 0.0, 0.0, 1.0
    else:
        perspective = numpy.array((0.0, 0.0, 0.0, 1.0))
    translate = m[3, :3].copy()
    rows = m[:3, :3].copy()
    scale, shear = numpy.zeros(3), [0.0, 0.0, 0.0]
    # Gram and Schmidt
    scale[0] = vector_norm(rows[0])
    rows[0] /= scale[0]
    shear[0] = numpy.dot(rows[0], rows[1])
    rows[1] -= rows[0] * shear[0]
    scale[1] = vector_norm(rows[1])
    rows[1] /= scale[1]
    shear[0] /= scale[1]
    shear[1] = numpy.dot(rows[0], rows[2])
    rows[2] -= rows[0] * shear[1]
    shear[2] = numpy.dot(rows[1], rows[2])
    rows[2] -= rows[1] * shear[2]
    scale[2] = vector_norm(rows[2])
    rows[2] /= scale[2]
    shear[1] /= scale[2]
    shear[2] /= scale[2]
    if numpy.dot(rows[0], numpy.cross(rows[1], rows[2])) < 0:
        scale *= -1
        rows *= -1
    pitch = math.asin(-rows[0, 2])
    if math.cos(pitch):
        roll, yaw = math.atan2(rows[1, 2], rows[2, 2]), math.atan2(rows[0, 1], rows[0, 0])
    else:
        roll, yaw = math.atan2(-rows[2, 1], rows[1, 1]), 0.0
    return scale, shear, [roll, pitch, yaw], translate, perspective


def compose_matrix(
    scale: Any = None,
    shear: Any = None,
    angles: Any = None,
    translate: Any = None,
    perspective: Any = None,
) -> Array:
    """Return the matrix of scales, shears, Euler angles, a translation and a perspective.

    Args:
        scale: the factors along x, y and z.
        shear: the shears of xy, xz and yz.
        angles: roll, pitch and yaw.
        translate: the vector of the translation.
        perspective: the last row.
    """
    matrix = numpy.identity(4)
    if perspective is not None:
        matrix[3, :] = perspective[:4]
    if translate is not None:
        matrix = numpy.dot(matrix, translation_matrix(translate))
    if angles is not None:
        matrix = numpy.dot(matrix, euler_matrix(angles[0], angles[1], angles[2], "sxyz"))
    if shear is not None:
        sheared = numpy.identity(4)
        sheared[0, 1], sheared[0, 2], sheared[1, 2] = shear[0], shear[1], shear[2]
        matrix = numpy.dot(matrix, sheared)
    if scale is not None:
        matrix = numpy.dot(matrix, numpy.diag([scale[0], scale[1], scale[2], 1.0]))
    scaled: Array = matrix / matrix[3, 3]
    return scaled


def orthogonalization_matrix(lengths: Sequence[float], angles: Sequence[float]) -> Array:
    """Return the matrix from the coordinates of a crystal's cell to orthogonal ones.

    Args:
        lengths: the lengths of the cell's edges.
        angles: its angles, in degrees.
    """
    a, b, c = lengths
    (sin_a, sin_b, _), (cos_a, cos_b, cos_g) = (
        numpy.sin(numpy.radians(angles)),
        numpy.cos(numpy.radians(angles)),
    )
    cosine = (cos_a * cos_b - cos_g) / (sin_a * sin_b)
    return numpy.array(
        [
            [a * sin_b * math.sqrt(1.0 - cosine * cosine), 0.0, 0.0, 0.0],
            [-a * sin_b * cosine, b * sin_a, 0.0, 0.0],
            [a * cos_b, b * cos_a, c, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def superimposition_matrix(v0: Any, v1: Any, scaling: bool = False, usesvd: bool = True) -> Array:
    """Return the matrix that moves points as near to others as possible.

    Args:
        v0: the points, as columns: an array of 3 rows, or of 4.
        v1: the points that they shall be near to.
        scaling: scale them, too.
        usesvd: find the rotation by a singular value decomposition, or else by a quaternion.
    """
    first = numpy.array(v0, dtype=numpy.float64)[:3]
    second = numpy.array(v1, dtype=numpy.float64)[:3]
    if first.shape != second.shape or first.shape[1] < 3:
        raise ValueError("Vector sets are of wrong shape or type.")
    center0, center1 = first.mean(axis=1), second.mean(axis=1)
    first = first - center0[:, None]
    second = second - center1[:, None]
    matrix = numpy.identity(4)
    if usesvd:
        u, _, vh = numpy.linalg.svd(numpy.dot(second, first.T))
        rotation = numpy.dot(u, vh)
        if numpy.linalg.det(rotation) < 0.0:
            rotation -= numpy.outer(u[:, 2], vh[2, :] * 2.0)
        matrix[:3, :3] = rotation
    else:
        matrix[:3, :3] = quaternion_matrix(_best_quaternion(first, second))[:3, :3]
    if scaling:
        matrix[:3, :3] *= math.sqrt(numpy.square(second).sum() / numpy.square(first).sum())
    matrix[:3, 3] = center1 - numpy.dot(matrix[:3, :3], center0)
    return matrix


def inverse_matrix(matrix: Any) -> Array:
    """Return the inverse of a square matrix."""
    inverse: Array = numpy.linalg.inv(matrix)
    return inverse


def concatenate_matrices(*matrices: Any) -> Array:
    """Return the product of matrices; the last is applied first."""
    product = numpy.identity(4)
    for matrix in matrices:
        product = numpy.dot(product, matrix)
    return product


def is_same_transform(matrix0: Any, matrix1: Any) -> bool:
    """Return whether two matrices do the same, whatever their scales."""
    first, second = _array(matrix0), _array(matrix1)
    return bool(numpy.allclose(first / first[3, 3], second / second[3, 3]))


def _array(matrix: Any) -> Array:
    return numpy.array(matrix, dtype=numpy.float64)


def _about(linear: Array, point: Any) -> Array:
    """Return the 4x4 matrix of a 3x3 one that leaves a point where it is."""
    matrix = numpy.identity(4)
    matrix[:3, :3] = linear
    if point is not None:
        place = numpy.array(point[:3], dtype=numpy.float64)
        matrix[:3, 3] = place - numpy.dot(linear, place)
    return matrix


def _eigenvector(matrix: Array, value: float, fault: str) -> Array:
    """Return the last eigenvector with an eigenvalue.

    Raises:
        ValueError: with the text ``fault``: there is none.
    """
    values, vectors = numpy.linalg.eig(matrix)
    found = numpy.where(abs(numpy.real(values) - value) < 1e-8)[0]
    if not len(found):
        raise ValueError(fault)
    vector: Array = numpy.real(vectors[:, found[-1]]).squeeze()
    return vector


def _best_quaternion(first: Array, second: Array) -> Array:
    """Return the rotation from centered points to others, after Horn."""
    xx, yy, zz = numpy.sum(first * second, axis=1)
    xy, yz, zx = numpy.sum(first * numpy.roll(second, -1, axis=0), axis=1)
    xz, yx, zy = numpy.sum(first * numpy.roll(second, -2, axis=0), axis=1)
    symmetric = numpy.array(
        [
            [xx - yy - zz, xy + yx, zx + xz, yz - zy],
            [xy + yx, -xx + yy - zz, yz + zy, zx - xz],
            [zx + xz, yz + zy, -xx - yy + zz, xy - yx],
            [yz - zy, zx - xz, xy - yx, xx + yy + zz],
        ]
    )
    _, vectors = numpy.linalg.eigh(symmetric)
    best: Array = unit_vector(vectors[:, -1])
    return best
