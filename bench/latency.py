"""One-way latency at a given rate, whatever the server can keep up with."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from bench.load import Load, measured
from bench.measure import NAIVE, RELAY, Plan, Repeated
from bench.report import Report

SUBSCRIBERS = 100
UNSUSTAINED_PERCENT = 1


@dataclass(frozen=True)
class Pace:
    """Messages offered per second, by how many publishers."""

    rate: int
    publishers: int

    @property
    def name(self) -> str:
        """Return what the table calls it."""
        return f"{self.rate} msg/s → {SUBSCRIBERS}"

    @property
    def options(self) -> tuple[str, ...]:
        """Return the arguments of the load generator."""
        crowd = ("--subs", f"{SUBSCRIBERS}", "--pubs", f"{self.publishers}")
        return ("--rate", f"{self.rate}", *crowd)


HIGH = Pace(3000, publishers=20)
LOW = Pace(100, publishers=1)


@dataclass(frozen=True)
class Pulse:
    """Latencies in ms, CPU in percent, and the percentage of the offered rate that got through."""

    p50: Repeated
    p99: Repeated
    cpu: float
    sustained: float

    @classmethod
    def of(cls, pace: Pace, loads: Sequence[Load]) -> Pulse:
        """Summarise the repetitions."""
        offered = pace.rate * SUBSCRIBERS
        return cls(
            p50=Repeated.of(each.lat_us.p50 / 1000 for each in loads),
            p99=Repeated.of(each.lat_us.p99 / 1000 for each in loads),
            cpu=statistics.median(each.server_cpu_percent for each in loads),
            sustained=100 * statistics.median(each.deliveries_per_s for each in loads) / offered,
        )


def latency(plan: Plan, report: Report) -> None:
    """Measure both paces on all servers in turn."""
    loads = measured("latency", (HIGH, LOW), plan, report)
    pulses = {(p, n): Pulse.of(p, each) for (p, n), each in loads.items()}
    report.table(
        f"Latency, open loop, minimum (median) of {plan.reps}",
        ("offered", "server", "p50, ms", "p99, ms", "CPU, %", "sustained, %", "limit"),
        [
            (
                pace.name,
                name,
                f"{pulse.p50}",
                f"{pulse.p99}",
                f"{pulse.cpu:.0f}",
                f"{pulse.sustained:.0f}",
                _verdict(pace, name, pulses, report) if name in plan.hubs else "",
            )
            for (pace, name), pulse in pulses.items()
        ],
    )


def _verdict(pace: Pace, hub: str, pulses: dict[tuple[Pace, str], Pulse], report: Report) -> str:
    pulse, what = pulses[pace, hub], pace.name
    if pace is HIGH:
        p99 = report.check(hub, f"{what}, p99", pulse.p99.median, 5, " ms")
        missing = 100 - pulse.sustained
        late = report.check(hub, f"{what}, not sustained", missing, UNSUSTAINED_PERCENT, " %")
        return f"p99 {p99}, not sustained {late}"
    relay, naive = (pulse.p50 / pulses[pace, name].p50 for name in (RELAY, NAIVE))
    to_relay = report.check(hub, f"{what}, p50 against the relay", relay.median, 2)
    to_naive = report.check(hub, f"{what}, p50 against naive", naive.median, 1)
    return f"p50: {relay} of relay {to_relay}, {naive} of naive {to_naive}"
