"""Homogeneous matrices, quaternions and Euler angles: http://wiki.ros.org/geometry/RotationMethods.

Functions have the names, arguments and results of Christoph Gohlke's module that ROS contains.
Matrices are 4x4 arrays, which are multiplied with column vectors; quaternions are arrays of x, y, z
and w. Angles are in radians. Of tf, this module alone needs numpy.

Axes of Euler angles are four letters, such as ``sxyz``: about the static axes (or ``r``, those that
turn along) x, y and z, in this order; or a tuple (first axis, parity, repetition, frame).
"""

import math

try:
    import numpy
except ModuleNotFoundError as error:
    if error.name != "numpy":
        raise
    raise ModuleNotFoundError(
        "No module named 'numpy', which tf.transformations needs: pip install numpy", name="numpy"
    ) from None

from tf.arcball import (
    Arcball,
    arcball_constrain_to_axis,
    arcball_map_to_sphere,
    arcball_nearest_axis,
)
from tf.homogeneous import (
    clip_matrix,
    compose_matrix,
    concatenate_matrices,
    decompose_matrix,
    identity_matrix,
    inverse_matrix,
    is_same_transform,
    orthogonalization_matrix,
    projection_from_matrix,
    projection_matrix,
    reflection_from_matrix,
    reflection_matrix,
    rotation_from_matrix,
    rotation_matrix,
    scale_from_matrix,
    scale_matrix,
    shear_from_matrix,
    shear_matrix,
    superimposition_matrix,
    translation_from_matrix,
    translation_matrix,
)
from tf.rotations import (
    _AXES2TUPLE as _AXES2TUPLE,
)
from tf.rotations import (
    _EPS as _EPS,
)
from tf.rotations import (
    _NEXT_AXIS as _NEXT_AXIS,
)
from tf.rotations import (
    _TUPLE2AXES as _TUPLE2AXES,
)
from tf.rotations import (
    euler_from_matrix,
    euler_from_quaternion,
    euler_matrix,
    quaternion_about_axis,
    quaternion_conjugate,
    quaternion_from_euler,
    quaternion_from_matrix,
    quaternion_inverse,
    quaternion_matrix,
    quaternion_multiply,
    quaternion_slerp,
    random_quaternion,
    random_rotation_matrix,
    random_vector,
    unit_vector,
    vector_norm,
)

__all__ = [
    "Arcball",
    "arcball_constrain_to_axis",
    "arcball_map_to_sphere",
    "arcball_nearest_axis",
    "clip_matrix",
    "compose_matrix",
    "concatenate_matrices",
    "decompose_matrix",
    "euler_from_matrix",
    "euler_from_quaternion",
    "euler_matrix",
    "identity_matrix",
    "inverse_matrix",
    "is_same_transform",
    "math",
    "numpy",
    "orthogonalization_matrix",
    "projection_from_matrix",
    "projection_matrix",
    "quaternion_about_axis",
    "quaternion_conjugate",
    "quaternion_from_euler",
    "quaternion_from_matrix",
    "quaternion_inverse",
    "quaternion_matrix",
    "quaternion_multiply",
    "quaternion_slerp",
    "random_quaternion",
    "random_rotation_matrix",
    "random_vector",
    "reflection_from_matrix",
    "reflection_matrix",
    "rotation_from_matrix",
    "rotation_matrix",
    "scale_from_matrix",
    "scale_matrix",
    "shear_from_matrix",
    "shear_matrix",
    "superimposition_matrix",
    "translation_from_matrix",
    "translation_matrix",
    "unit_vector",
    "vector_norm",
]
