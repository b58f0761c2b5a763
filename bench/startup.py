"""Seconds from exec to the response to the first WebSocket handshake."""

from __future__ import annotations

import statistics

from bench.measure import NAIVE, Plan
from bench.report import Report
from bench.servers import running

LIMIT_SECONDS = 0.5


def startup(plan: Plan, report: Report) -> None:
    """Start each server several times."""
    names = (*plan.hubs, NAIVE)
    times: dict[str, list[float]] = {name: [] for name in names}
    for name in names:
        with running(name):
            pass  # The first start compiles modules and fills the page cache.
    for _ in range(plan.reps):
        for name in names:
            with running(name) as server:
                times[name].append(server.start_seconds)
            report.record("start", server=name, seconds=server.start_seconds)
    rows = []
    for name, found in times.items():
        median = statistics.median(found)
        limit = report.check(name, "start", median, LIMIT_SECONDS, " s")
        rows.append((name, f"{median:.2f}", f"{min(found):.2f}", limit))
    report.table(
        f"Start: exec to first handshake, of {plan.reps}",
        ("server", "median, s", "minimum, s", "limit"),
        rows,
    )
