"""Names of types with and without their package."""

from __future__ import annotations

import click
import pytest

from fibws.cli.type_names import full_name


@pytest.mark.parametrize("name", ["std_msgs/String", "std_msgs/msg/String", "nobody/Knows"])
def test_a_name_with_a_package_is_returned(name: str) -> None:
    assert full_name(name) == name


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("String", "; did you mean std_msgs/String?"),
        ("Pose", "; did you mean geometry_msgs/Pose or turtlesim/Pose?"),
        ("Twst", "; did you mean geometry_msgs/Twist?"),
        ("Qqqqqqqq", ", as in std_msgs/String."),
    ],
)
def test_without_one_the_error_says_what_was_meant(name: str, meant: str) -> None:
    with pytest.raises(click.UsageError) as error:
        full_name(name)
    assert str(error.value) == f"{name!r} lacks its package{meant}"
