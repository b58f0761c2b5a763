"""Providers that take their time, and timeouts."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("promises")


def test_a_service_may_answer_later(seen: Any) -> None:
    assert seen == {"success": True, "message": "at last"}


def test_a_service_that_rejects_tells_the_reason(seen: Any) -> None:
    assert "out of paper" in seen


def test_a_call_fails_when_its_time_is_over(seen: Any) -> None:
    assert "/slow/trigger" in seen


def test_a_call_fails_when_the_provider_leaves(seen: Any) -> None:
    assert "/leaving/trigger" in seen


def test_a_call_fails_when_the_provider_unadvertises(seen: Any) -> None:
    assert "/ending/trigger" in seen
