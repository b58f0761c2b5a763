"""Memory of an idle connection."""

from __future__ import annotations

from bench import load
from bench.measure import NAIVE, RELAY, Plan
from bench.report import Report
from bench.servers import running

CONNECTIONS = 1000
LIMIT_KIB = 9.0


def idle(plan: Plan, report: Report) -> None:
    """Hold idle connections with one subscription on each server, started for this."""
    rows = []
    for name in (*plan.hubs, RELAY, NAIVE):
        with running(name) as server:
            seen = load.idle(server, CONNECTIONS, plan.seconds)
        report.record("idle", server=name, **seen.model_dump())
        report.fault(name, "idle", seen.first_error)
        if seen.open != CONNECTIONS:
            report.fault(name, "idle", f"{seen.open} of {CONNECTIONS} connections were open")
        size = seen.server_rss_kb_per_conn
        rows.append(
            (
                name,
                f"{size:.1f}",
                report.check(name, "idle", size, LIMIT_KIB, " KiB"),
                f"{seen.server_cpu_us_per_connect:.0f}",
                f"{seen.server_cpu_percent:.1f}",
            )
        )
    report.table(
        f"{CONNECTIONS} idle connections, each with one subscription",
        ("server", "KiB per connection", "limit", "CPU µs per connect", "idle CPU, %"),
        rows,
    )
