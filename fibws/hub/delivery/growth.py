"""Growth: when to count what is kept for all clients together."""

from __future__ import annotations

import math
from collections.abc import Callable


class Growth:
    """The bytes that may still be kept before somebody has to count them.

    A running sum would have to follow every message that is kept, sent or dropped. Instead whoever
    keeps bytes takes them off ``left`` and calls `check` below 0: no more can have come.

    Args:
        on_check: counts what is kept and says by `allow` how much more may be.
    """

    __slots__ = ("_on_check", "left")

    def __init__(self, on_check: Callable[[], object] = lambda: None) -> None:
        self._on_check = on_check
        self.left = math.inf

    def allow(self, size: float) -> None:
        """Have the next check after so many more bytes."""
        self.left = size

    def check(self) -> None:
        """Ask for a check, once; it may come later."""
        self.left = math.inf
        self._on_check()
