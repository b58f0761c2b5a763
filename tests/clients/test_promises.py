"""Providers that take their time, and timeouts."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("promises")


def test_service_may_answer_later(seen: Any) -> None:
    assert seen == {"success": True, "message": "at last"}


def test_rejected_promise_fails_the_call_with_its_reason(seen: Any) -> None:
    assert "out of paper" in seen


def test_call_times_out(seen: Any) -> None:
    assert "/slow/trigger" in seen


def test_call_fails_when_its_server_leaves(seen: Any) -> None:
    assert "/leaving/trigger" in seen


def test_call_fails_when_its_server_unadvertises(seen: Any) -> None:
    assert "/ending/trigger" in seen
