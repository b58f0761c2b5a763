"""CPU of the server per delivery, closed loop, at several numbers of subscribers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bench.load import Load, compare, measured
from bench.measure import NAIVE, RELAY, Plan, Repeated
from bench.report import Report


@dataclass(frozen=True)
class Cell:
    """One row of the table; the limits are ratios of CPU per delivery, None for no limit."""

    subscribers: int
    payload: int
    window: int
    against_relay: float | None = None
    against_naive: float | None = None

    @property
    def name(self) -> str:
        """Return the name in the table."""
        size = f"{self.payload >> 10} KiB" if self.payload >= 1024 else f"{self.payload} B"
        return f"1 → {self.subscribers}, {size}, window {self.window}"

    @property
    def options(self) -> tuple[str, ...]:
        """Return the options of the load generator."""
        window = ("--window", f"{self.window}")
        return ("--subs", f"{self.subscribers}", "--size", f"{self.payload}", *window)


CELLS = (
    Cell(1, 32, 64, against_relay=2.5, against_naive=0.25),
    Cell(10, 32, 64, against_relay=2.0, against_naive=0.12),
    Cell(100, 32, 64, against_relay=1.7, against_naive=0.07),
    Cell(100, 32, 16),
    Cell(10, 65536, 16, against_relay=2.0, against_naive=0.65),
)
FIGURES: dict[str, Callable[[Load], float]] = {
    "CPU, µs per delivery": lambda each: each.cpu_us_per_delivery
}
"""The figures that two hubs are compared by."""


def fanout(plan: Plan, report: Report) -> None:
    """Measure each cell on all servers in turn."""
    if plan.against:
        compare("fanout", "Fan-out", CELLS, FIGURES, plan, report)
        return
    loads = measured("fanout", CELLS, plan, report)
    for hub in plan.hubs:
        rows = [
            _row(cell, hub, report, *(loads[cell, n] for n in (hub, RELAY, NAIVE)))
            for cell in CELLS
        ]
        report.table(
            f"Fan-out: CPU of the {hub}, µs per delivery, minimum (median) of {plan.reps}",
            (
                "publisher → subscribers",
                hub,
                "C relay",
                "naive",
                f"{hub} : relay",
                "limit",
                f"{hub} : naive",
                "limit",
                f"{hub}, deliveries/s",
            ),
            rows,
        )


def _row(
    cell: Cell,
    hub: str,
    report: Report,
    ours: Sequence[Load],
    relay: Sequence[Load],
    naive: Sequence[Load],
) -> Sequence[str]:
    cost, floor, reference = (
        Repeated.of(each.cpu_us_per_delivery for each in loads) for loads in (ours, relay, naive)
    )
    to_relay, to_naive = cost / floor, cost / reference
    return (
        cell.name,
        f"{cost}",
        f"{floor}",
        f"{reference}",
        f"{to_relay}",
        report.check(hub, f"{cell.name}, against the relay", to_relay.median, cell.against_relay),
        f"{to_naive}",
        report.check(hub, f"{cell.name}, against naive", to_naive.median, cell.against_naive),
        f"{max(each.deliveries_per_s for each in ours):,.0f}",
    )
