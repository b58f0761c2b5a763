"""A clock that only work advances."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any


class WorkClock:
    """A clock that only work advances: it counts calls of functions, and notes the longest time
    between two looks at it.
    """

    def __init__(self) -> None:
        self.longest = 0
        """The most work between two looks."""
        self._now = self._looked = 0

    def __call__(self) -> float:
        self.longest = max(self.longest, self._now - self._looked)
        self._looked = self._now
        return self._now

    def measure(self, function: Callable[[], object]) -> None:
        def count(frame: FrameType, event: str, arg: Any) -> None:
            self._now += event in ("call", "c_call")

        before = sys.getprofile()
        sys.setprofile(count)
        try:
            function()
        finally:
            sys.setprofile(before)
        self()
