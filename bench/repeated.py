"""A figure measured several times."""

from __future__ import annotations

import statistics
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Repeated:
    """The minimum and the median.

    On servers the median decides: other load on the machine costs CPU, but it also makes messages
    wait for each other and leave together, which saves some, so that the minimum may be luck.
    """

    least: float
    median: float

    @classmethod
    def of(cls, values: Iterable[float]) -> Repeated:
        """Summarise the repetitions."""
        found = list(values)
        return cls(min(found), statistics.median(found))

    def __truediv__(self, other: Repeated) -> Repeated:
        """Return the ratio of the minima and that of the medians."""
        return Repeated(self.least / other.least, self.median / other.median)

    def __str__(self) -> str:
        """Return what a table shows."""
        return f"{self.least:.2f} ({self.median:.2f})"
