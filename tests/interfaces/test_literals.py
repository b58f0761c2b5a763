"""Values of ROS 2 are read as rosidl reads them."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.errors import DefinitionError
from fibws.interfaces.parser import parse_message

from .rosidl_values import ANSWERS, LINES

ROSIDL: dict[str, Any] = json.loads(ANSWERS.read_text())
MORE: dict[str, Any] = {
    r'string[] x ["say \"hi\""]': [['say "hi"']],
    **{f"byte {name}{value}": [value] for name in ("x ", "X=") for value in (-1, -5, -128)},
    **{f"byte {name}-0x1F": [-31] for name in ("x ", "X=")},
}
"""What fibws reads although rosidl does not: ROS 1's byte has a sign, and two escaped quotes."""


def values(line: str) -> list[Any] | None:
    """Return the value that a line has; None if it is refused."""
    try:
        found = parse_message(line, "my_msgs", "Mine", ros2=True)
    except DefinitionError:
        return None
    default = [each.default for each in found.fields]
    return [*default, *(each.value for each in found.constants)]


def unsigned(line: str, found: list[Any] | None) -> Any:
    """Return the values as JSON has them, with a byte as ROS 2 counts."""
    if found is None or not line.startswith("byte") or line in MORE:
        return json.loads(json.dumps(found))
    return json.loads(json.dumps([_unsigned(each) for each in found]))


def _unsigned(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_unsigned(each) for each in value]
    return value % 256 if isinstance(value, int) else value


def test_every_line_has_an_answer() -> None:
    assert list(ROSIDL) == list(dict.fromkeys(LINES))


def test_values_are_those_of_rosidl() -> None:
    wrong = {}
    for line, expected in (ROSIDL | MORE).items():
        found = unsigned(line, values(line))
        if repr(found) != repr(expected):
            wrong[line] = (found, expected)
    assert wrong == {}


@pytest.mark.parametrize(
    ("line", "ros1", "ros2"),
    [
        ('string X="abc" # x', '"abc" # x', "abc"),
        ("string X=''", "''", ""),
        ("string X=a # b", "a # b", "a"),
        (r"string X='it\'s'", r"'it\'s'", "it's"),
    ],
)
def test_quotes_around_a_constant_are_part_of_it_in_ros_1(line: str, ros1: str, ros2: str) -> None:
    [constant] = parse_message(line, "my_msgs", "Mine").constants
    assert constant.value == ros1
    for text, is_ros2 in (
        (line, True),
        (f"{line}\nint32 x 5", False),
        (f"{line}\nint8[<=3] x", False),
    ):
        found = parse_message(text, "my_msgs", "Mine", ros2=is_ros2)
        assert (found.constants[0].value, found.constants[0].text) == (ros2, ros2)
        assert found.text.split("\n")[0] == f"string X={ros2}"


@pytest.mark.parametrize(
    ("line", "text"), [("byte X=200", "byte X=-56"), ("uint8 X=0XFF", "uint8 X=255")]
)
def test_number_that_ros_1_cannot_read_is_spelled_for_it(line: str, text: str) -> None:
    assert parse_message(line, "my_msgs", "Mine").text == text
