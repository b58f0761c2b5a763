"""The clock that the hub's pure core is given; every asyncio loop is one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Timer(Protocol):
    """Something that will happen unless it is cancelled."""

    def cancel(self) -> None:
        """Let it not happen."""


class Clock(Protocol):
    """Tells a steady time in seconds, and calls back later."""

    def time(self) -> float:
        """Seconds since some moment in the past."""

    def call_later(self, delay: float, callback: Callable[[], Any], /) -> Timer:
        """Call ``callback`` in ``delay`` seconds."""
