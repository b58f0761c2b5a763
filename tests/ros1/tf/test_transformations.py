"""The identities of tf.transformations, as its author publishes them in its documentation."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from itertools import permutations
from pathlib import Path
from zlib import crc32

import numpy as np
import pytest
from numpy.typing import NDArray
from tf import transformations as t

PYTHON = Path(t.__file__).parents[1]
Chance = np.random.Generator
AXES = list(t._AXES2TUPLE)


@pytest.fixture(autouse=True)
def chance(request: pytest.FixtureRequest) -> Iterator[Chance]:
    """A random generator of the test's own, and the same seed for numpy's, which tf uses."""
    seed = crc32(request.node.nodeid.encode())
    state = np.random.get_state()
    np.random.seed(seed)
    yield np.random.default_rng(seed)
    np.random.set_state(state)


def vector(chance: Chance, count: int = 3) -> NDArray[np.float64]:
    return chance.random(count) - 0.5


@pytest.fixture(params=range(5))
def angle(chance: Chance) -> float:
    return float((chance.random() - 0.5) * 2 * math.pi)


# Matrices


def test_identity_and_translation(chance: Chance) -> None:
    identity = t.identity_matrix()
    assert np.allclose(identity @ identity, np.identity(4))
    moved = vector(chance)
    assert np.allclose(t.translation_matrix(moved) @ [0, 0, 0, 1], [*moved, 1])
    assert np.allclose(t.translation_from_matrix(t.translation_matrix(moved)), moved)


def test_reflection(chance: Chance) -> None:
    for _ in range(5):
        point, normal = vector(chance, 4), vector(chance)
        point[3] = 1.0
        matrix = t.reflection_matrix(point, normal)
        assert np.trace(matrix) == pytest.approx(2)
        assert np.allclose(matrix @ point, point)
        other = point.copy()
        other[:3] += normal
        mirrored = point.copy()
        mirrored[:3] -= normal
        assert np.allclose(matrix @ other, mirrored)
        assert t.is_same_transform(matrix, t.reflection_matrix(*t.reflection_from_matrix(matrix)))
    with pytest.raises(ValueError, match="eigenvalue -1"):
        t.reflection_from_matrix(np.identity(4))


def test_rotation(angle: float, chance: Chance) -> None:
    turned = t.rotation_matrix(math.pi / 2, [0, 0, 1], [1, 0, 0])
    assert np.allclose(turned @ [0, 0, 0, 1], [1, -1, 0, 1])
    axis, point = vector(chance), vector(chance)
    matrix = t.rotation_matrix(angle, axis, point)
    assert t.is_same_transform(matrix, t.rotation_matrix(angle - 2 * math.pi, axis, point))
    assert t.is_same_transform(matrix, t.rotation_matrix(-angle, -axis, point))
    assert np.trace(t.rotation_matrix(math.pi / 2, axis, point)) == pytest.approx(2)
    assert t.is_same_transform(matrix, t.rotation_matrix(*t.rotation_from_matrix(matrix)))
    with pytest.raises(ValueError, match="eigenvalue 1"):
        t.rotation_from_matrix(t.scale_matrix(2))


def test_scale(chance: Chance) -> None:
    points = (chance.random((4, 5)) - 0.5) * 20
    points[3] = 1.0
    assert np.allclose((t.scale_matrix(-1.234) @ points)[:3], -1.234 * points[:3])
    for factor, origin in ((-3.0, vector(chance)), (5.0, None)):
        for direction in (None, vector(chance)):
            matrix = t.scale_matrix(factor, origin, direction)
            again = t.scale_matrix(*t.scale_from_matrix(matrix))
            assert t.is_same_transform(matrix, again)


def test_projection(chance: Chance) -> None:
    point, normal, direction, eye = vector(chance), vector(chance), vector(chance), vector(chance)
    flat = t.projection_matrix(point, normal)
    assert t.is_same_transform(flat @ flat, flat)
    along = t.projection_matrix(point, normal, direction)
    assert t.is_same_transform(along, t.projection_matrix(*t.projection_from_matrix(along)))
    for pseudo in (False, True):
        matrix = t.projection_matrix(point, normal, perspective=eye, pseudo=pseudo)
        found = t.projection_from_matrix(matrix, pseudo)
        assert t.is_same_transform(matrix, t.projection_matrix(*found))
    there = t.projection_matrix((3, 0, 0), (1, 1, 0), (1, 0, 0)) @ [4.0, 5.0, 6.0, 1.0]
    assert np.allclose(there, [3 - 5, 5, 6, 1])
    with pytest.raises(ValueError, match="eigenvalue 0"):
        t.projection_from_matrix(np.zeros((4, 4)))


def test_clipping() -> None:
    left, right, bottom, top, near, far = 1.0, 4.0, 2.0, 3.0, 5.0, 9.0
    box = t.clip_matrix(left, right, bottom, top, near, far)
    assert np.allclose(box @ [left, bottom, near, 1], [-1, -1, -1, 1])
    assert np.allclose(box @ [right, top, far, 1], [1, 1, 1, 1])
    frustum = t.clip_matrix(left, right, bottom, top, near, far, perspective=True)
    corner = frustum @ [left, bottom, near, 1]
    assert np.allclose(corner / corner[3], [-1, -1, -1, 1])
    for wrong in ((2, 1, 0, 1, 1, 2), (0, 1, 0, 1, 0, 1)):
        with pytest.raises(ValueError, match="invalid frustrum"):
            t.clip_matrix(*wrong, perspective=True)


def test_shear(chance: Chance) -> None:
    for _ in range(5):
        direction, point = vector(chance), vector(chance)
        normal = np.cross(direction, vector(chance))
        matrix = t.shear_matrix(0.4, direction, point, normal)
        assert np.linalg.det(matrix) == pytest.approx(1)
        assert t.is_same_transform(matrix, t.shear_matrix(*t.shear_from_matrix(matrix)))
    with pytest.raises(ValueError, match="not orthogonal"):
        t.shear_matrix(0.4, [1, 0, 0], [0, 0, 0], [1, 0, 0])
    with pytest.raises(ValueError, match="No two linear independent"):
        t.shear_from_matrix(t.scale_matrix(2))


def test_composition_and_decomposition(chance: Chance) -> None:
    translation = t.translation_matrix((1, 2, 3))
    assert np.allclose(t.decompose_matrix(translation)[3], (1, 2, 3))
    assert t.decompose_matrix(t.scale_matrix(0.123))[0][0] == pytest.approx(0.123)
    rotation = t.euler_matrix(1, 2, 3)
    roll, pitch, yaw = t.decompose_matrix(rotation)[2]
    assert np.allclose(t.euler_matrix(roll, pitch, yaw), rotation)
    for sign in (1, -1):
        matrix = t.compose_matrix(
            sign * (vector(chance) + 1),
            vector(chance),
            vector(chance),
            vector(chance),
            [0.1, 0.02, 0.003, 1.0],
        )
        assert t.is_same_transform(matrix, t.compose_matrix(*t.decompose_matrix(matrix)))
    vertical = t.euler_matrix(0.3, math.pi / 2, 0)
    assert t.is_same_transform(vertical, t.compose_matrix(*t.decompose_matrix(vertical)))
    with pytest.raises(ValueError, match="zero"):
        t.decompose_matrix(np.zeros((4, 4)))
    with pytest.raises(ValueError, match="singular"):
        t.decompose_matrix(np.diag([0, 1, 1, 1]))


def test_orthogonalization() -> None:
    assert np.allclose(
        t.orthogonalization_matrix((10.0, 10.0, 10.0), (90.0, 90.0, 90.0))[:3, :3],
        np.identity(3) * 10,
    )
    matrix = t.orthogonalization_matrix([9.8, 12.0, 15.5], [87.2, 80.7, 69.7])
    assert np.allclose(matrix.sum(), 43.063229)


@pytest.mark.parametrize("usesvd", [True, False])
def test_superimposition(usesvd: bool, chance: Chance) -> None:
    points = chance.random((3, 10)) - 0.5
    assert np.allclose(t.superimposition_matrix(points, points, usesvd=usesvd), np.identity(4))
    turn = t.random_rotation_matrix()
    corners = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float).T
    corners = np.vstack([corners, np.ones(4)])
    turned = turn @ corners
    found = t.superimposition_matrix(corners, turned, usesvd=usesvd)
    assert np.allclose(turned, found @ corners)
    scaled = t.concatenate_matrices(t.translation_matrix(vector(chance)), t.scale_matrix(1.7), turn)
    points = np.vstack([points, np.ones(10)])
    found = t.superimposition_matrix(points, scaled @ points, scaling=True, usesvd=usesvd)
    assert np.allclose(scaled @ points, found @ points)
    mirrored = np.diag([1.0, 1.0, -1.0, 1.0]) @ points
    rotation = t.superimposition_matrix(points, mirrored, usesvd=usesvd)
    assert np.linalg.det(rotation) == pytest.approx(1)
    with pytest.raises(ValueError, match="wrong shape"):
        t.superimposition_matrix(points, points[:, :5])


def test_products_and_inverses(chance: Chance) -> None:
    first, second = chance.random((4, 4)), chance.random((4, 4))
    assert np.allclose(t.concatenate_matrices(first, second), first @ second)
    for size in range(1, 5):
        matrix = chance.random((size, size))
        assert np.allclose(t.inverse_matrix(matrix), np.linalg.inv(matrix))
    assert t.is_same_transform(np.identity(4), 2 * np.identity(4))
    assert not t.is_same_transform(np.identity(4), t.rotation_matrix(1, [1, 0, 0]))


# Euler angles


def test_all_conventions_are_there() -> None:
    letters = {"".join(each) for each in permutations("xyz")}
    letters |= {f"{a}{b}{a}" for a, b in permutations("xyz", 2)}
    assert {axes[1:] for axes in AXES} == letters
    assert len(AXES) == 24
    assert all(t._TUPLE2AXES[t._AXES2TUPLE[axes]] == axes for axes in AXES)
    assert t._AXES2TUPLE["sxyz"] == (0, 0, 0, 0)
    assert t._AXES2TUPLE["rzyx"] == (0, 0, 0, 1)
    assert t._AXES2TUPLE["rzxz"] == (2, 0, 1, 1)


def test_published_values() -> None:
    assert np.allclose(t.euler_matrix(1, 2, 3, "syxz")[0].sum(), -1.34786452)
    assert np.allclose(t.euler_matrix(1, 2, 3, (0, 1, 0, 1))[0].sum(), -0.383436184)
    quaternion = t.quaternion_from_euler(1, 2, 3, "ryxz")
    assert np.allclose(quaternion, [0.310622, -0.718287, 0.444435, 0.435953])
    assert np.allclose(t.quaternion_about_axis(0.123, (1, 0, 0)), [0.06146124, 0, 0, 0.99810947])
    assert np.allclose(
        t.quaternion_matrix([0.06146124, 0, 0, 0.99810947]), t.rotation_matrix(0.123, (1, 0, 0))
    )
    assert np.allclose(t.euler_from_quaternion([0.06146124, 0, 0, 0.99810947]), [0.123, 0, 0])
    product = t.quaternion_multiply([1, -2, 3, 4], [-5, 6, 7, 8])
    assert np.allclose(product, [-44, -14, 48, 28])
    assert np.allclose(
        t.quaternion_from_matrix(t.rotation_matrix(0.123, (1, 2, 3))),
        [0.0164262, 0.0328524, 0.0492786, 0.9981095],
    )


@pytest.mark.parametrize("axes", AXES)
def test_angles_and_matrices_agree(axes: str, chance: Chance) -> None:
    about = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    for _ in range(3):
        a, b, c = (chance.uniform(-math.pi, math.pi) for _ in range(3))
        pairs = zip((a, b, c), axes[1:], strict=True)
        turns = [t.rotation_matrix(angle, about[letter]) for angle, letter in pairs]
        if axes[0] == "s":
            turns.reverse()
        matrix = t.euler_matrix(a, b, c, axes)
        assert np.allclose(matrix, t.concatenate_matrices(*turns))
        assert np.allclose(t.euler_matrix(*t.euler_from_matrix(matrix, axes), axes), matrix)
        quaternion = t.quaternion_from_euler(a, b, c, t._AXES2TUPLE[axes])
        again = t.euler_from_quaternion(quaternion, axes.upper())
        assert np.allclose(t.euler_matrix(*again, axes), matrix)


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("middle", [0, math.pi / 2, -math.pi / 2, math.pi])
def test_angles_at_gimbal_lock(axes: str, middle: float) -> None:
    matrix = t.euler_matrix(0.3, middle, 0.1, axes)
    assert np.allclose(t.euler_matrix(*t.euler_from_matrix(matrix, axes), axes), matrix)


def test_unknown_convention_is_an_error() -> None:
    with pytest.raises(KeyError):
        t.euler_matrix(1, 2, 3, "xyzs")
    with pytest.raises(KeyError):
        t.euler_matrix(1, 2, 3, (3, 0, 0, 0))


# Quaternions and vectors


def test_quaternions_and_matrices_agree() -> None:
    for _ in range(20):
        first, second = t.random_quaternion(), t.random_quaternion()
        assert t.vector_norm(first) == pytest.approx(1)
        matrix = t.quaternion_matrix(first)
        again = t.quaternion_from_matrix(matrix)
        assert np.allclose(again, first) or np.allclose(again, -first)
        product = t.quaternion_multiply(first, second)
        assert np.allclose(t.quaternion_matrix(product), matrix @ t.quaternion_matrix(second))
        unit = t.quaternion_multiply(2 * first, t.quaternion_inverse(2 * first))
        assert np.allclose(unit, [0, 0, 0, 1])
        conjugate = t.quaternion_conjugate(first)
        assert np.allclose(conjugate, [*-first[:3], first[3]])
    assert np.allclose(t.quaternion_matrix([0, 0, 0, 0]), np.identity(4))
    assert np.allclose(t.quaternion_about_axis(1, [0, 0, 0])[:3], 0)


def test_half_turns_have_quaternions() -> None:
    for axis in np.identity(3):
        quaternion = t.quaternion_from_matrix(t.rotation_matrix(math.pi, axis))
        assert np.allclose(quaternion, [*axis, 0])


def test_slerp() -> None:
    first, second = t.random_quaternion(), t.random_quaternion()
    assert np.allclose(t.quaternion_slerp(first, second, 0.0), first)
    assert np.allclose(t.quaternion_slerp(first, second, 1.0, 1), second)
    assert np.allclose(t.quaternion_slerp(first, first, 0.4), first)
    between = t.quaternion_slerp(first, second, 0.5)
    whole = math.acos(abs(np.dot(first, second)))
    assert math.acos(abs(np.dot(first, between))) == pytest.approx(whole / 2)
    long = t.quaternion_slerp([0, 0, 0, 1], -t.quaternion_about_axis(0.2, [1, 0, 0]), 0.5, 0, False)
    assert t.euler_from_quaternion(long)[0] == pytest.approx(0.1 - math.pi)


def test_random_rotations() -> None:
    assert np.allclose(t.random_quaternion([0, 0, 0]), [0, 1, 0, 0])
    matrix = t.random_rotation_matrix()
    assert np.allclose(matrix @ matrix.T, np.identity(4))
    assert t.random_vector((2, 3)).shape == (2, 3)


def test_lengths_of_vectors(chance: Chance) -> None:
    vectors = chance.random((5, 4, 3))
    for axis in (None, 0, 1, -1):
        lengths = np.linalg.norm(vectors if axis is not None else vectors.ravel(), axis=axis)
        assert np.allclose(t.vector_norm(vectors, axis=axis), lengths)
        unit = t.unit_vector(vectors, axis=axis)
        assert np.allclose(t.vector_norm(unit, axis=axis), 1)
    out = np.empty((5, 3))
    assert t.vector_norm(vectors, axis=1, out=out) is None
    assert np.allclose(out, np.linalg.norm(vectors, axis=1))
    same = vectors.copy()
    assert t.unit_vector(same, axis=1, out=same) is None
    assert np.allclose(same, t.unit_vector(vectors, axis=1))
    assert list(t.unit_vector([1, 0, 0])) == [1.0, 0.0, 0.0]
    assert t.vector_norm([]) == 0.0


# The ball


def test_ball_turns_as_published() -> None:
    ball = t.Arcball()
    ball.place([320, 320], 320)
    ball.down([500, 250])
    ball.drag([475, 275])
    assert np.allclose(ball.matrix().sum(), 3.90583455)
    ball = t.Arcball(initial=[0, 0, 0, 1])
    ball.place([320, 320], 320)
    ball.setaxes([1, 1, 0], [-1, 1, 0])
    ball.setconstrain(True)
    assert ball.getconstrain()
    ball.down([400, 200])
    ball.drag([200, 400])
    assert np.allclose(ball.matrix().sum(), 0.2055924)
    ball.next()
    assert np.allclose(np.linalg.det(ball.matrix()), 1)


def test_ball_may_begin_anywhere() -> None:
    matrix = t.random_rotation_matrix()
    assert np.allclose(t.Arcball(matrix).matrix(), matrix)
    with pytest.raises(ValueError, match="not a quaternion or matrix"):
        t.Arcball([1, 2])
    ball = t.Arcball()
    ball.down([0, 0])
    ball.drag([0, 0])
    assert np.allclose(ball.matrix(), np.identity(4))
    ball.setaxes()


def test_points_on_the_ball() -> None:
    assert np.allclose(t.arcball_map_to_sphere([9, 0], [0, 0], 3), [1, 0, 0])
    assert np.allclose(t.arcball_constrain_to_axis([0, 0, 1], [0, 0, 1]), [1, 0, 0])
    assert np.allclose(t.arcball_constrain_to_axis([1, 0, 0], [1, 0, 0]), [0, 1, 0])
    assert np.allclose(t.arcball_constrain_to_axis([1, 0, -1], [1, 0, 0]), [0, 0, 1])
    axes = [np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])]
    assert t.arcball_nearest_axis([1, 0, 0], axes) is axes[1]


def test_missing_numpy_is_reported() -> None:
    program = (
        "import sys; sys.modules['numpy'] = None\n"
        "from fibws.ros1 import finder; finder.install()\n"
        "import tf, tf2_geometry_msgs, tf2_sensor_msgs\n"
        "try: tf.transformations.quaternion_from_euler(0, 0, 0)\n"
        "except ImportError as error: print(error.name, error)\n"
    )
    found = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONPATH": f"{PYTHON}:{PYTHON.parents[2]}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.stdout == (
        "numpy No module named 'numpy', which tf.transformations needs: pip install numpy\n"
    ), found.stderr
