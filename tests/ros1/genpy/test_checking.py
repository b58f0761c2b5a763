"""Checks of values against the types of fields."""

from __future__ import annotations

import array

import pytest
from genpy import SerializationError
from genpy.message import check_type

from .conftest import Agree
from .test_message import TYPES, make

VALUES = [
    *("5", "-5", "300", "2**40", "1.5", "'text'", "b'ab'", "None", "[1, 2]", "(1.5,)", "['a']"),
    *("Time(1)", "Duration(1)", "[Time(1)]", "M('std_msgs/Header')", "M('std_msgs/String')"),
    *("M('geometry_msgs/Point', 1, 2, 'z')", "[M('geometry_msgs/Point')]", "{}", "[-1]", "[None]"),
    "M('geometry_msgs/PoseStamped', pose=5)",
]
FIELDS = [
    *("int8", "uint8", "int64", "uint64", "float32", "float64", "bool", "string", "time"),
    *("duration", "int32[]", "uint8[]", "char[4]", "float64[3]", "string[]", "time[]"),
    *("std_msgs/Header", "Header", "geometry_msgs/Point", "geometry_msgs/Point[]"),
    "geometry_msgs/PoseStamped",
]


@pytest.mark.parametrize("field_type", FIELDS)
def test_values_are_checked_as_in_genpy(agree: Agree, field_type: str) -> None:
    for value in VALUES:
        agree(f"check_type('field', {field_type!r}, {value})", *TYPES)


@pytest.mark.parametrize(
    ("field_type", "value"),
    [
        ("string", "grüße"),
        ("int32", True),
        ("float64", True),
        ("int32[]", array.array("i", [1])),
        ("uint8[]", bytearray(b"a")),
        ("uint8[]", memoryview(b"a")),
    ],
)
def test_values_that_can_be_sent_are_valid(field_type: str, value: object) -> None:
    check_type("field", field_type, value)


def test_error_names_the_path_of_the_field() -> None:
    message = make("geometry_msgs/PoseArray", poses=[make("geometry_msgs/Pose")])
    message.poses[0].position.x = "far"
    with pytest.raises(SerializationError, match=r"^field poses\[\].position.x must be float type"):
        message._check_types()
