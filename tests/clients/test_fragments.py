"""Messages in fragments, with the one client that puts them together."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("fragments")


def test_message_arrives_in_fragments_on_request(seen: Any) -> None:
    assert seen == {"equal": True, "ops": ["fragment"], "many": True}
