"""Checks of arguments."""

from __future__ import annotations

import math

import pytest

from fibws.node.checks import check_queue_size, check_timeout, without_surrogates


@pytest.mark.parametrize("timeout", [None, 1, 0.001])
def test_positive_timeout_or_none_is_valid(timeout: float | None) -> None:
    check_timeout(timeout)


@pytest.mark.parametrize("timeout", [0, -1, math.inf, math.nan])
def test_other_timeouts_are_refused(timeout: float) -> None:
    with pytest.raises(ValueError, match=rf"seconds above 0, got {timeout}"):
        check_timeout(timeout)


def test_queue_size_is_at_least_1() -> None:
    check_queue_size(1)
    with pytest.raises(ValueError, match="queue_size must be at least 1, got 0"):
        check_queue_size(0)


@pytest.mark.parametrize(
    ("text", "sent"), [("grün 🐢", "grün 🐢"), ("file \udcff", "file ?"), ("", "")]
)
def test_lone_surrogates_are_replaced(text: str, sent: str) -> None:
    assert without_surrogates(text) == sent
