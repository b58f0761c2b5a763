"""A budget: what several things of one client may take together."""

from __future__ import annotations


class Budget:
    """Counts what is used of a limit.

    Args:
        limit: bytes.
    """

    __slots__ = ("limit", "used")

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.used = 0

    @property
    def exceeded(self) -> bool:
        """Whether something must be dropped."""
        return self.used > self.limit
