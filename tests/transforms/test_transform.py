"""Translations and rotations, compared with numpy's matrices."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.tf.transform import (
    NO_ROTATION,
    Quaternion,
    Transform,
    Vector,
    along,
    angle,
    link_of,
    normalized,
    of_yaw_pitch_roll,
    product,
    roll_pitch_yaw,
    rotated,
    slerp,
    with_sign_of_matrix,
)

from .oracle import (
    angles,
    assert_same,
    axes,
    homogeneous,
    matrix_of,
    quaternion,
    ratios,
    rotation_matrix,
    rotations,
    transforms,
    vectors,
)

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@given(axes(), angles)
def test_quaternion_of_an_axis_and_an_angle(axis: Vector, turn: float) -> None:
    np.testing.assert_allclose(
        matrix_of(quaternion(axis, turn)), rotation_matrix(axis, turn), atol=1e-14
    )


@given(axes(), angles, vectors)
def test_vector_is_rotated(axis: Vector, turn: float, vector: Vector) -> None:
    turned = rotated(vector, quaternion(axis, turn))
    np.testing.assert_allclose(turned, rotation_matrix(axis, turn) @ vector, atol=1e-11)


@given(transforms, transforms)
def test_product_of_transforms(outer: Transform, inner: Transform) -> None:
    assert_same(outer @ inner, homogeneous(outer) @ homogeneous(inner), scale=10)


@given(transforms)
def test_inverse(transform: Transform) -> None:
    assert_same(transform.inverse(), np.linalg.inv(homogeneous(transform)), scale=10)
    assert_same(transform @ transform.inverse(), np.eye(4), scale=10)


@given(transforms)
def test_identity_changes_nothing(transform: Transform) -> None:
    assert transform @ Transform() == transform
    assert Transform() @ transform == transform


@given(rotations, axes(), angles)
def test_angle_between_rotations(start: Quaternion, axis: Vector, turn: float) -> None:
    end = product(start, quaternion(axis, turn))
    assert angle(start, end) == pytest.approx(abs(turn), abs=1e-14)
    assert angle(end, start) == angle(start, end)


@given(rotations, rotations)
def test_quaternion_and_its_negative_are_the_same_rotation(
    first: Quaternion, second: Quaternion
) -> None:
    x, y, z, w = second
    assert angle(first, (-x, -y, -z, -w)) == angle(first, second)


def test_tiny_angles_are_exact() -> None:
    assert angle(NO_ROTATION, quaternion(X, 1e-12)) == pytest.approx(1e-12, rel=1e-3)


@given(rotations, axes(), st.floats(-3.14, 3.14) | st.floats(-1e-5, 1e-5), ratios)
def test_rotations_are_interpolated_along_the_shortest_arc(
    start: Quaternion, axis: Vector, turn: float, ratio: float
) -> None:
    end = product(start, quaternion(axis, turn))
    expected = matrix_of(start) @ rotation_matrix(axis, ratio * turn)
    np.testing.assert_allclose(matrix_of(slerp(start, end, ratio)), expected, atol=1e-12)
    x, y, z, w = end
    other = slerp(start, (-x, -y, -z, -w), ratio)
    np.testing.assert_allclose(matrix_of(other), expected, atol=1e-12)


@given(transforms, transforms, ratios)
def test_translations_are_interpolated_linearly(
    start: Transform, end: Transform, ratio: float
) -> None:
    between = start.interpolated(end, ratio)
    line = np.array(start.translation) * (1 - ratio) + np.array(end.translation) * ratio
    np.testing.assert_allclose(between.translation, line, atol=1e-10)
    assert between.rotation == slerp(start.rotation, end.rotation, ratio)


@given(transforms, transforms)
def test_ends_of_an_interpolation(start: Transform, end: Transform) -> None:
    assert_same(start.interpolated(end, 0), homogeneous(start))
    assert_same(start.interpolated(end, 1), homogeneous(end))


@given(transforms, transforms)
def test_distance_of_translations(first: Transform, second: Transform) -> None:
    difference = np.array(first.translation) - np.array(second.translation)
    assert first.distance(second) == pytest.approx(np.linalg.norm(difference))
    assert first.angle(second) == angle(first.rotation, second.rotation)


@given(angles, angles, angles)
def test_yaw_pitch_roll_are_about_fixed_axes(yaw: float, pitch: float, roll: float) -> None:
    expected = rotation_matrix(Z, yaw) @ rotation_matrix(Y, pitch) @ rotation_matrix(X, roll)
    actual = matrix_of(of_yaw_pitch_roll(yaw, pitch, roll))
    np.testing.assert_allclose(actual, expected, atol=1e-14)


@given(rotations, st.floats(1e-150, 1e150))
def test_quaternion_is_normalized(rotation: Quaternion, length: float) -> None:
    x, y, z, w = rotation
    long = (x * length, y * length, z * length, w * length)
    np.testing.assert_allclose(normalized(long), rotation, atol=1e-14)


def test_zero_quaternion_cannot_be_normalized() -> None:
    with pytest.raises(ZeroDivisionError):
        normalized((0.0, 0.0, 0.0, 0.0))


def test_integers_are_accepted() -> None:
    """Handwritten transforms often omit the decimal points."""
    quarter = Transform((1, 2, 3), (0, 0, 1, 0))
    assert quarter.angle(Transform()) == pytest.approx(math.pi)
    assert quarter.interpolated(Transform(), 0.5).translation == (0.5, 1.0, 1.5)
    assert (quarter @ Transform((1, 0, 0))).translation == (0, 2, 3)


@given(st.lists(transforms, max_size=6))
def test_product_along_a_path(links: list[Transform]) -> None:
    expected = np.eye(4)
    for link in links:
        expected = homogeneous(link) @ expected
    assert_same(along(link_of("", link) for link in links), expected, scale=1000)


@given(angles, st.floats(-1.5, 1.5), angles)
def test_angles_of_a_rotation(yaw: float, pitch: float, roll: float) -> None:
    found = roll_pitch_yaw(of_yaw_pitch_roll(yaw, pitch, roll))
    turned = np.subtract(found, (roll, pitch, yaw)) / 2
    np.testing.assert_allclose(np.sin(turned), 0, atol=1e-9)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_angles_of_a_vertical_rotation_have_no_yaw(pitch: float) -> None:
    rotation = of_yaw_pitch_roll(0.3, pitch, 0.1)
    roll, found, yaw = roll_pitch_yaw(rotation)
    assert found == pytest.approx(pitch)
    assert yaw == 0
    again = of_yaw_pitch_roll(yaw, found, roll)
    np.testing.assert_allclose(matrix_of(again), matrix_of(rotation), atol=1e-9)


@given(rotations)
def test_sign_of_matrix(rotation: Quaternion) -> None:
    signed = with_sign_of_matrix(rotation)
    x, y, z, w = rotation
    assert signed in (rotation, (-x, -y, -z, -w))
    assert signed[3] > 0.5 or max(signed[:3], key=abs) > 0
    assert with_sign_of_matrix(signed) == signed
