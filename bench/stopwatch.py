"""CPU time of calls within this process."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence


def microseconds(
    calls: Sequence[Callable[[], object]], rounds: int, round_seconds: float = 0.005
) -> list[list[float]]:
    """Return the CPU time per call of each round, the calls taking turns."""
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
