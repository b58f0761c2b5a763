"""The bytes that may be kept for all clients before they must be counted."""

from __future__ import annotations

import math
from collections.abc import Callable


class ByteAllowance:
    """The bytes that may still be kept before they must be counted.

    A running sum would have to follow every message that is kept, sent or dropped. Instead, code
    that keeps bytes subtracts them from ``left`` and calls `check` below 0.

    Args:
        on_check: counts the bytes that are kept, and calls `allow` with the bytes that may follow.
    """

    __slots__ = ("_on_check", "left")

    def __init__(self, on_check: Callable[[], object] = lambda: None) -> None:
        self._on_check = on_check
        self.left = math.inf

    def allow(self, size: float) -> None:
        """Let ``size`` more bytes come before the next check."""
        self.left = size

    def check(self) -> None:
        """Ask for one check, which may come later."""
        self.left = math.inf
        self._on_check()
