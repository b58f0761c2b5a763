"""Transforms by way of tf2_web_republisher's service."""

from __future__ import annotations

from typing import Any

import pytest

from .casts import playing

pytestmark = playing("tf_service")


@pytest.mark.long
def test_transforms_arrive_by_service(seen: Any) -> None:
    rotation = {"x": 0, "y": 0, "z": pytest.approx(0.5**0.5), "w": pytest.approx(0.5**0.5)}
    assert seen == [
        {"translation": {"x": 1, "y": 2, "z": 3}, "rotation": rotation},
        {"translation": {"x": 4, "y": 5, "z": 6}, "rotation": rotation},
    ]
