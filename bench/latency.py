"""One-way latency in an open loop: at a given rate, whether or not the server keeps up."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bench.load import Load, compare, measured
from bench.measure import NAIVE, RELAY, Plan, Repeated
from bench.report import Report

SUBSCRIBERS = 100
UNSUSTAINED_PERCENT = 1


@dataclass(frozen=True)
class Rate:
    """Messages sent per second, and the number of publishers."""

    hz: int
    publishers: int

    @property
    def name(self) -> str:
        """Return the name in the table."""
        return f"{self.hz} msg/s → {SUBSCRIBERS}"

    @property
    def options(self) -> tuple[str, ...]:
        """Return the options of the load generator."""
        counts = ("--subs", f"{SUBSCRIBERS}", "--pubs", f"{self.publishers}")
        return ("--rate", f"{self.hz}", *counts)


HIGH = Rate(3000, publishers=20)
LOW = Rate(100, publishers=1)
FIGURES: dict[str, Callable[[Load], float]] = {
    "p50, ms": lambda each: each.lat_us.p50 / 1000,
    "p99, ms": lambda each: each.lat_us.p99 / 1000,
    "CPU, µs per delivery": lambda each: each.cpu_us_per_delivery,
}
"""The figures that two hubs are compared by."""


@dataclass(frozen=True)
class LatencyStats:
    """Latencies in ms, CPU in per cent, and the per cent of the rate that was delivered."""

    p50: Repeated
    p99: Repeated
    cpu: float
    sustained: float

    @classmethod
    def of(cls, rate: Rate, loads: Sequence[Load]) -> LatencyStats:
        """Summarise the repetitions."""
        offered = rate.hz * SUBSCRIBERS
        return cls(
            p50=Repeated.of(each.lat_us.p50 / 1000 for each in loads),
            p99=Repeated.of(each.lat_us.p99 / 1000 for each in loads),
            cpu=statistics.median(each.server_cpu_percent for each in loads),
            sustained=100 * statistics.median(each.deliveries_per_s for each in loads) / offered,
        )


def latency(plan: Plan, report: Report) -> None:
    """Measure both rates on all servers in turn."""
    if plan.against:
        compare("latency", "Latency, open loop", (HIGH, LOW), FIGURES, plan, report)
        return
    loads = measured("latency", (HIGH, LOW), plan, report)
    stats = {(p, n): LatencyStats.of(p, each) for (p, n), each in loads.items()}
    report.table(
        f"Latency, open loop, minimum (median) of {plan.reps}",
        ("rate", "server", "p50, ms", "p99, ms", "CPU, %", "sustained, %", "limit"),
        [
            (
                rate.name,
                name,
                f"{stat.p50}",
                f"{stat.p99}",
                f"{stat.cpu:.0f}",
                f"{stat.sustained:.0f}",
                _verdict(rate, name, stats, report) if name in plan.hubs else "",
            )
            for (rate, name), stat in stats.items()
        ],
    )


def _verdict(
    rate: Rate, hub: str, stats: dict[tuple[Rate, str], LatencyStats], report: Report
) -> str:
    stat, what = stats[rate, hub], rate.name
    if rate is HIGH:
        p99 = report.check(hub, f"{what}, p99", stat.p99.median, 5, " ms")
        missing = 100 - stat.sustained
        late = report.check(hub, f"{what}, not sustained", missing, UNSUSTAINED_PERCENT, " %")
        return f"p99 {p99}, not sustained {late}"
    relay, naive = (stat.p50 / stats[rate, name].p50 for name in (RELAY, NAIVE))
    to_relay = report.check(hub, f"{what}, p50 against the relay", relay.median, 2)
    to_naive = report.check(hub, f"{what}, p50 against naive", naive.median, 1)
    return f"p50: {relay} of relay {to_relay}, {naive} of naive {to_naive}"
