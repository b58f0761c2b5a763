"""The bounds that a program gives."""

from __future__ import annotations

import math

import pytest

from fibws.node.limits import check_queue_size, check_timeout


@pytest.mark.parametrize("timeout", [None, 1, 0.001])
def test_a_timeout_is_a_time_to_come_or_none(timeout: float | None) -> None:
    check_timeout(timeout)


@pytest.mark.parametrize("timeout", [0, -1, math.inf, math.nan])
def test_others_are_refused(timeout: float) -> None:
    with pytest.raises(ValueError, match=rf"seconds above 0, or None, not {timeout}"):
        check_timeout(timeout)


def test_a_queue_holds_something() -> None:
    check_queue_size(1)
    with pytest.raises(ValueError, match="queue_size is at least 1, not 0"):
        check_queue_size(0)
