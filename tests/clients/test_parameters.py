"""Parameters, with each client."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("parameters")


def test_parameter_can_be_set_read_listed_and_deleted(seen: Any) -> None:
    names = ["blue", "label", "on", "red"]
    assert sorted(seen["listed"]) == [f"/camera/gains/{name}" for name in names]
    assert seen["value"] == {"red": 1.5, "blue": [1, 2], "label": "wörld", "on": True}
    assert seen["after"] == []


def test_parameter_inside_another_one_can_be_read_alone(seen: Any) -> None:
    assert seen == 3


def test_missing_parameter_is_null(seen: Any) -> None:
    assert seen is None


def test_parameters_of_the_hub_exist(seen: Any) -> None:
    assert seen.strip() == "noetic"


def test_parameter_is_read_by_another_client(seen: Any) -> None:
    assert seen == 0.8
