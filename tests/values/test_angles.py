"""Angles as parameter files may have them."""

from __future__ import annotations

import math

import pytest

from fibws.values import angles


@pytest.mark.parametrize("text", ["deg(180)", "180", " deg( 180 ) ", "1.8e2"])
def test_degrees(text: str) -> None:
    assert angles.degrees(text) == math.pi


@pytest.mark.parametrize("text", ["deg(x)", "deg()", "", "deg(90*2)"])
def test_what_is_no_number_is_no_angle_in_degrees(text: str) -> None:
    with pytest.raises(ValueError, match=r"write deg\(180\)"):
        angles.degrees(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("rad(pi)", math.pi),
        ("rad(pi/2)", math.pi / 2),
        ("2*pi", 2 * math.pi),
        ("rad(-pi + 1)", 1 - math.pi),
        ("rad(pi**2)", math.pi**2),
        ("rad(1.5)", 1.5),
        ("rad(1 - 3)", -2.0),
    ],
)
def test_radians(text: str, value: float) -> None:
    assert angles.radians(text) == value


@pytest.mark.parametrize(
    "text",
    [
        "rad()",
        "rad(x)",
        "rad(pi",
        "rad(__import__('os'))",
        "rad('1')",
        "rad(pi // 2)",
        "rad(1/0)",
        "rad(9**9**9**9)",
        f"rad({'-' * 100_000}1)",
    ],
)
def test_what_is_no_sum_is_no_angle_in_radians(text: str) -> None:
    with pytest.raises(ValueError, match=r"write rad\(pi/2\)"):
        angles.radians(text)
