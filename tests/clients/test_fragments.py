"""Messages in fragments, with the one client that puts them together."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("fragments")


def test_a_message_comes_in_fragments_when_that_was_asked_for(seen: Any) -> None:
    assert seen == {"equal": True, "ops": ["fragment"], "many": True}
