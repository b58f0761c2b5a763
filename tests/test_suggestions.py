"""Similar names."""

from __future__ import annotations

import pytest

from fibws.suggestions import misspelled, nearest, suggestion, suggestion_or_known

TOPICS = ["/fibonacci", "/robot/scan", "/cmd_vel", "/camera_1/image", "/odom"]


def test_most_similar_name_is_nearest() -> None:
    assert nearest("/chater", ["/chatter", "/charter_flight"]) == "/chatter"
    assert nearest("/chater", iter(["/rosout"])) is None


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("my_msgs/Batt", "geometry_msgs/Twist"),
        ("/robot/scan", "/robot/odom"),
        ("/robot/arm/joint_1", "/robot/arm/position"),
    ],
)
def test_names_in_one_namespace_are_not_similar_for_that(name: str, known: str) -> None:
    assert nearest(name, [known]) is None


def test_name_in_another_namespace_is_suggested() -> None:
    known = ["/robot/odometry", "/robot/scan", "/robots/scam"]
    assert nearest("/robt/scan", known) == "/robot/scan"
    assert nearest("geometry_msg/Twist", ["std_msgs/Twine", "geometry_msgs/Twist"]) == (
        "geometry_msgs/Twist"
    )


def test_nearest_ignores_case() -> None:
    assert nearest("int", ["STRING", "INT"]) == "INT"


def test_name_that_has_become_known_needs_no_suggestion() -> None:
    assert suggestion("/number", ["/number", "/numbers"]) == ""


def test_cutoff_excludes_names_that_are_less_similar() -> None:
    assert nearest("std_msg", ["std_srvs"]) == "std_srvs"
    assert nearest("std_msg", ["std_srvs"], cutoff=0.8) is None


def test_suggestion_names_the_nearest_or_is_empty() -> None:
    assert suggestion("/chater", ["/chatter"]) == "; did you mean /chatter?"
    assert suggestion("/chater", []) == ""


def test_all_known_names_are_listed_if_none_is_similar() -> None:
    assert suggestion_or_known("ag", ["arg", "node"]) == "; did you mean arg?"
    assert suggestion_or_known("qwertz", iter(["arg", "node"])) == "; known are arg, node"
    assert suggestion_or_known("qwertz", []) == ""


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
def test_typo_or_other_namespace_is_a_misspelling(name: str, expected: str) -> None:
    assert misspelled(name, TOPICS) == expected


@pytest.mark.parametrize("name", ["/chatter", "/numbers", "/camera_2/image", "/odometry/filtered"])
def test_different_names_are_not_misspellings(name: str) -> None:
    assert misspelled(name, TOPICS) is None


@pytest.mark.parametrize(("name", "other"), [("/arm_l", "/arm_r"), ("/odom1", "/odomX")])
def test_short_names_that_differ_in_a_letter_are_not_misspellings(name: str, other: str) -> None:
    assert misspelled(name, [other]) is None


def test_shortest_name_is_chosen_among_several_namespaces() -> None:
    assert misspelled("/scan", ["/robot/front/scan", "/robot/scan"]) == "/robot/scan"


def test_nothing_is_misspelled_without_other_names() -> None:
    assert misspelled("/scan", []) is None
