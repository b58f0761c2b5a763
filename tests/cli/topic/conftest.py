"""Reports come at once instead of every second."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def short_period(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.cli.topic.rates.PERIOD", 0.05)
