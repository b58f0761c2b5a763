"""Statistics of the latest measurements."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

MOST = 50_000
"""Default number of measurements that are kept, as in rostopic."""


class Summary(NamedTuple):
    """Statistics of measurements."""

    mean: float
    least: float
    most: float
    deviation: float
    """The standard deviation."""


class Window:
    """The latest measurements.

    Args:
        size: maximum number of measurements.
    """

    def __init__(self, size: int = MOST) -> None:
        self._values: deque[float] = deque(maxlen=size)

    def __len__(self) -> int:
        return len(self._values)

    def add(self, value: float) -> None:
        """Add a measurement; a full window drops the oldest one."""
        self._values.append(value)

    @property
    def oldest(self) -> float:
        """The oldest measurement; raises `IndexError` if there is none."""
        return self._values[0]

    @property
    def total(self) -> float:
        """The sum of the measurements."""
        return math.fsum(self._values)

    def summary(self) -> Summary:
        """Return the statistics; raise `ValueError` if there are no measurements."""
        if not self._values:
            raise ValueError("no measurements")
        mean = self.total / len(self._values)
        variance = math.fsum((each - mean) ** 2 for each in self._values) / len(self._values)
        return Summary(mean, min(self._values), max(self._values), math.sqrt(variance))


def in_seconds(summary: Summary) -> str:
    """Return statistics of seconds in the format of rostopic hz and rostopic delay."""
    least, most, deviation = summary[1:]
    return f"min: {least:.3f}s max: {most:.3f}s std dev: {deviation:.5f}s"


def as_object(summary: Summary) -> dict[str, float]:
    """Return statistics for JSON."""
    return {"min": summary.least, "max": summary.most, "std_dev": summary.deviation}
