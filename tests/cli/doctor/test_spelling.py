"""Which name was meant."""

from __future__ import annotations

import pytest

from fibws.cli.doctor.spelling import meant

OTHERS = ["/fibonacci", "/robot/scan", "/cmd_vel", "/camera_1/image", "/odom"]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("/fibonaci", "/fibonacci"),
        ("/Fibonacci", "/fibonacci"),
        ("/fibonnaci", "/fibonacci"),
        ("/cmdvel", "/cmd_vel"),
        ("/cmd_val", "/cmd_vel"),
        ("/scan", "/robot/scan"),
        ("/robt/scan", "/robot/scan"),
        ("/elsewhere/odom", "/odom"),
    ],
)
def test_a_slip_of_a_letter_or_a_namespace_is_seen(name: str, expected: str) -> None:
    assert meant(name, OTHERS) == expected


@pytest.mark.parametrize("name", ["/chatter", "/numbers", "/camera_2/image", "/odometry/filtered"])
def test_what_was_meant_to_differ_is_left_alone(name: str) -> None:
    assert meant(name, OTHERS) is None


def test_of_several_namespaces_the_shortest_is_guessed() -> None:
    assert meant("/scan", ["/robot/front/scan", "/robot/scan"]) == "/robot/scan"


def test_where_there_is_nothing_nothing_was_meant() -> None:
    assert meant("/scan", []) is None
