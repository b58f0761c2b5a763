"""A hub that goes away, and another one in its place."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("reconnection")


def test_a_client_comes_back_with_the_hub(seen: Any) -> None:
    assert seen == [{"data": "before"}, {"data": "after"}]
