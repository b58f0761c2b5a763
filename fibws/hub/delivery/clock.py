"""The clock and the threads that the hub's synchronous parts are given; a loop is a clock."""

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


class Workers(Protocol):
    """Threads for work that takes long."""

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        """Call ``work`` in a thread and then ``done`` in the event loop; neither may raise."""
