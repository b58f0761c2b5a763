"""The plan of a run, values measured several times, and CPU time of calls in this process."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

HUB = "hub"
HUB_UVLOOP = "hub+uvloop"
HUBS = (HUB, HUB_UVLOOP)
RELAY = "relay"
NAIVE = "naive"
BASE = "base"
"""The hub of another checkout (--against)."""


class BenchError(Exception):
    """The benchmark cannot continue; the text is one line for the user."""


@dataclass(frozen=True)
class Plan:
    """The options of a run."""

    reps: int = 5
    seconds: float = 3.0
    warm_seconds: float = 1.0
    quick: bool = False
    uvloop: bool = False
    cells: tuple[str, ...] = ()
    """The cells of `robots` to measure; the default cells if empty."""
    minutes: float | None = None
    """The duration of `stuck`."""
    against: Path | None = None
    """Another checkout, whose hub `fanout` and `latency` compare with this one's."""

    @property
    def hubs(self) -> tuple[str, ...]:
        """Return the names of the hubs to measure."""
        return HUBS if self.uvloop else (HUB,)


COMPARISON = Plan(reps=20, seconds=0.75, warm_seconds=0.25)
"""Many short turns: what one hub measures right after the other shares most of the noise."""
QUICK = Plan(reps=1, seconds=0.3, warm_seconds=0.15, quick=True)


@dataclass(frozen=True)
class Repeated:
    """The minimum and the median of a value measured several times.

    For servers the median decides: other load on the machine costs CPU, but it also makes messages
    queue up and leave together, which saves some, so the minimum may be luck.
    """

    least: float
    median: float

    @classmethod
    def of(cls, values: Iterable[float]) -> Repeated:
        """Summarise the repetitions."""
        found = list(values)
        return cls(min(found), statistics.median(found))

    @classmethod
    def ratio(cls, values: Sequence[float], references: Sequence[float]) -> Repeated:
        """Return the ratio of the minima, and the median of the repetitions' ratios.

        Value and reference of one repetition are measured one after the other, so they share most
        of the machine's noise.
        """
        ratios = [_quotient(*each) for each in zip(values, references, strict=True)]
        return cls(_quotient(min(values), min(references)), statistics.median(ratios))

    def __truediv__(self, other: Repeated) -> Repeated:
        """Return the ratio of the minima and the ratio of the medians."""
        return Repeated(_quotient(self.least, other.least), _quotient(self.median, other.median))

    def __str__(self) -> str:
        """Return the text of a table's cell."""
        return f"{self.least:.2f} ({self.median:.2f})"


def _quotient(value: float, reference: float) -> float:
    """Return the ratio of two values; infinity if the reference took too little to be measured."""
    return value / reference if reference else math.inf


def minimum_and_median(values: Sequence[float]) -> str:
    """Write the minimum and the median of values as whole numbers."""
    return f"{min(values):,.0f} ({statistics.median(values):,.0f})"


def microseconds(
    calls: Sequence[Callable[[], object]], rounds: int, round_seconds: float = 0.005
) -> list[list[float]]:
    """Return the CPU time per call in each round; the calls take turns."""
    repeats = []
    for call in calls:
        start = time.process_time()
        call()
        once = max(time.process_time() - start, 1e-6)
        repeats.append(max(1, int(round_seconds / once)))
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(rounds):
        for call, repeat, found in zip(calls, repeats, times, strict=True):
            start = time.process_time()
            for _ in range(repeat):
                call()
            found.append((time.process_time() - start) / repeat * 1e6)
    return times
