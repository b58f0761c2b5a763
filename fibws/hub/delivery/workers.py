"""The threads that the hub's synchronous parts are given, for work that takes long."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol


class Workers(Protocol):
    """Threads for work that takes long."""

    def run(self, work: Callable[[], object], done: Callable[[], object], /) -> None:
        """Call ``work`` in a thread and then ``done`` in the event loop; neither may raise."""
