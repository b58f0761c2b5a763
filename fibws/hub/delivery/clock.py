"""The clock that the hub's synchronous parts are given; every asyncio loop is one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Timer(Protocol):
    """A call that is due later."""

    def cancel(self) -> None:
        """Cancel the call."""


class Clock(Protocol):
    """Gives a steady time in seconds, and calls back later."""

    def time(self) -> float:
        """Return the seconds since some moment in the past."""

    def call_later(self, delay: float, callback: Callable[[], Any], /) -> Timer:
        """Call ``callback`` in ``delay`` seconds."""


class Loop(Clock, Protocol):
    """An event loop."""

    def call_soon(self, callback: Callable[[], object], /) -> object:
        """Call a function in the next turn."""
