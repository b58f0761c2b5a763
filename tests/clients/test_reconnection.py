"""A hub that goes away, and another one in its place."""

from __future__ import annotations

from typing import Any

import pytest

from .casts import playing

pytestmark = playing("reconnection")


@pytest.mark.long
def test_client_reconnects_when_the_hub_returns(seen: Any) -> None:
    assert seen[:2] == [{"data": "before"}, {"data": "after"}]
    # A page that provides a service; the scenario of roslibpy has none.
    assert seen[2:] in ([], [{"success": True, "message": ""}])
