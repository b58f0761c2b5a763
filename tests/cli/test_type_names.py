"""Names of types with and without their package."""

from __future__ import annotations

import click
import pytest

from fibws.cli.type_names import full_name


@pytest.mark.parametrize("name", ["std_msgs/String", "std_msgs/msg/String", "nobody/Knows"])
def test_name_with_a_package_is_returned(name: str) -> None:
    assert full_name(name) == name


@pytest.mark.parametrize(
    ("name", "suggestion"),
    [
        ("String", "std_msgs/String"),
        ("Pose", "geometry_msgs/Pose or turtlesim/Pose"),
        ("Twst", "geometry_msgs/Twist"),
        ("Qqqqqqqq", "std_msgs/String"),
    ],
)
def test_name_without_a_package_is_an_error_with_a_suggestion(name: str, suggestion: str) -> None:
    with pytest.raises(click.UsageError) as error:
        full_name(name)
    assert repr(name) in str(error.value) and suggestion in str(error.value)
