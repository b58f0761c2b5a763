"""Turning things with a mouse; scripts import it from `tf.transformations`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy

from tf.rotations import (
    Array,
    quaternion_from_matrix,
    quaternion_matrix,
    quaternion_multiply,
    quaternion_slerp,
    unit_vector,
    vector_norm,
)


class Arcball:
    """A ball under the mouse pointer, which turns as it is dragged.

    Args:
        initial: its rotation at first: a quaternion or a matrix; None for no rotation.

    Raises:
        ValueError: ``initial`` is neither.
    """

    def __init__(self, initial: Any = None) -> None:
        self._axis: Array | None = None
        self._axes: list[Array] | None = None
        self._radius = 1.0
        self._center: Sequence[float] = [0.0, 0.0]
        self._start = numpy.array([0.0, 0.0, 1.0])
        self._constrain = False
        if initial is None:
            self._at_start = numpy.array([0.0, 0.0, 0.0, 1.0])
        else:
            given = numpy.array(initial, dtype=numpy.float64)
            if given.shape == (4, 4):
                self._at_start = quaternion_from_matrix(given)
            elif given.shape == (4,):
                self._at_start = unit_vector(given)
            else:
                raise ValueError("initial not a quaternion or matrix.")
        self._before = self._now = self._at_start

    def place(self, center: Sequence[float], radius: float) -> None:
        """Set its center on the screen and its radius, in pixels."""
        self._center = [center[0], center[1]]
        self._radius = float(radius)

    def setaxes(self, *axes: Any) -> None:
        """Set the axes about which it turns while it is constrained; none for any."""
        self._axes = [unit_vector(axis) for axis in axes] if axes and axes[0] is not None else None

    def setconstrain(self, constrain: bool) -> None:
        """Set whether it turns about its axes alone."""
        self._constrain = constrain is True

    def getconstrain(self) -> bool:
        """Return whether it turns about its axes alone."""
        return self._constrain

    def down(self, point: Sequence[float]) -> None:
        """Begin to drag at a point of the screen."""
        self._start = arcball_map_to_sphere(point, self._center, self._radius)
        self._at_start = self._before = self._now
        if self._constrain and self._axes is not None:
            self._axis = arcball_nearest_axis(self._start, self._axes)
            self._start = arcball_constrain_to_axis(self._start, self._axis)
        else:
            self._axis = None

    def drag(self, point: Sequence[float]) -> None:
        """Turn it: the pointer is at another point."""
        there = arcball_map_to_sphere(point, self._center, self._radius)
        if self._axis is not None:
            there = arcball_constrain_to_axis(there, self._axis)
        self._before = self._now
        axis = numpy.cross(self._start, there)
        if numpy.dot(axis, axis) < 1e-15:
            self._now = self._at_start
        else:
            turn = [*axis, numpy.dot(self._start, there)]
            self._now = quaternion_multiply(turn, self._at_start)

    def next(self, acceleration: float = 0.0) -> None:
        """Continue in the direction of the last `drag`."""
        following = quaternion_slerp(self._before, self._now, 2.0 + acceleration, False)
        self._before, self._now = self._now, following

    def matrix(self) -> Array:
        """Return the matrix of its rotation."""
        return quaternion_matrix(self._now)


def arcball_map_to_sphere(point: Sequence[float], center: Sequence[float], radius: float) -> Array:
    """Return the point of the unit sphere that is under a point of the screen."""
    x, y = (point[0] - center[0]) / radius, (center[1] - point[1]) / radius
    square = x * x + y * y
    if square > 1.0:
        length = math.sqrt(square)
        return numpy.array((x / length, y / length, 0.0))
    return numpy.array((x, y, math.sqrt(1.0 - square)))


def arcball_constrain_to_axis(point: Any, axis: Any) -> Array:
    """Return the point of the sphere next to ``point`` that is perpendicular to an axis."""
    along = numpy.array(axis, dtype=numpy.float64)
    across = numpy.array(point, dtype=numpy.float64)
    across -= along * numpy.dot(along, across)
    length = vector_norm(across)
    if length > 1e-12:
        across /= -length if across[2] < 0.0 else length
        return across
    if along[2] == 1.0:
        return numpy.array([1.0, 0.0, 0.0])
    result: Array = unit_vector([-along[1], along[0], 0.0])
    return result


def arcball_nearest_axis(point: Any, axes: Sequence[Any]) -> Any:
    """Return the axis that is nearest to a point of the sphere."""
    there = numpy.array(point, dtype=numpy.float64)
    return max(axes, key=lambda axis: numpy.dot(arcball_constrain_to_axis(there, axis), there))
