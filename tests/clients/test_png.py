"""Messages as PNG pictures, with each client that knows them."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("png")


def test_message_arrives_as_png(seen: Any) -> None:
    assert seen == {"data": "hello, wörld 🌍"}


def test_long_message_arrives_as_png(seen: Any) -> None:
    assert seen == {"equal": True, "length": 100_000}
