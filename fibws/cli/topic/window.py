"""The newest of many measurements, and what they are like together."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

MOST = 50_000
"""Measurements that are kept unless told otherwise, as in rostopic."""


class Summary(NamedTuple):
    """What several measurements are like."""

    mean: float
    least: float
    most: float
    deviation: float
    """The standard deviation."""


class Window:
    """The newest measurements, ``size`` many at most.

    Args:
        size: how many.
    """

    def __init__(self, size: int = MOST) -> None:
        self._values: deque[float] = deque(maxlen=size)

    def __len__(self) -> int:
        return len(self._values)

    def add(self, value: float) -> None:
        """Take a measurement in; the oldest one goes if there is no room."""
        self._values.append(value)

    @property
    def oldest(self) -> float:
        """The oldest measurement that is kept; it raises `IndexError` if there is none."""
        return self._values[0]

    @property
    def total(self) -> float:
        """All together."""
        return math.fsum(self._values)

    def summary(self) -> Summary:
        """What they are like; it raises `ValueError` if there are none."""
        if not self._values:
            raise ValueError("nothing was measured")
        mean = self.total / len(self._values)
        variance = math.fsum((each - mean) ** 2 for each in self._values) / len(self._values)
        return Summary(mean, min(self._values), max(self._values), math.sqrt(variance))


def in_seconds(what: Summary) -> str:
    """Seconds, as rostopic hz and rostopic delay print what they are like."""
    return f"min: {what.least:.3f}s max: {what.most:.3f}s std dev: {what.deviation:.5f}s"


def as_object(what: Summary) -> dict[str, float]:
    """What measurements are like, for JSON."""
    return {"min": what.least, "max": what.most, "std_dev": what.deviation}
