"""A budget is exceeded by the byte that is one too many."""

from __future__ import annotations

import pytest

from fibws.hub.budget import Budget


@pytest.mark.parametrize(("used", "exceeded"), [(0, False), (10, False), (11, True)])
def test_a_budget_is_exceeded_above_its_limit(used: int, exceeded: bool) -> None:
    budget = Budget(10)
    budget.used += used
    assert budget.exceeded is exceeded
