"""Latency of other clients while one publisher floods the hub."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass

from bench.handshake import handshake
from bench.load import Flood, load
from bench.machine import on_load_cpu
from bench.measure import NAIVE, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running

RATE = 200
HANDSHAKES = 50
HANDSHAKES_SECONDS = 4.0
LEAD_SECONDS = 0.8
LIMIT_P99_MS = 10
LIMIT_HANDSHAKE_MS = 50


@dataclass(frozen=True)
class FloodResult:
    """Latencies, in ms, of another topic and of new connections during a flood."""

    p50: float
    p99: float
    handshake_median: float
    handshake_max: float
    flood_per_s: float


def flood(plan: Plan, report: Report) -> None:
    """Flood one topic of each server but the relay, which has only one topic."""
    results: dict[str, list[FloodResult]] = {name: [] for name in (*plan.hubs, NAIVE)}
    for rep in range(plan.reps):
        for name, found in results.items():
            with running(name) as server:
                result = _measure(server, plan, report)
            found.append(result)
            report.record("flood", server=name, rep=rep, **vars(result))
    rows = []
    for name, found in results.items():
        p99 = Repeated.of(each.p99 for each in found)
        slowest = Repeated.of(each.handshake_max for each in found)
        rows.append(
            (
                name,
                f"{Repeated.of(each.p50 for each in found)}",
                f"{p99}",
                report.check(name, "beside a flood, p99", p99.median, LIMIT_P99_MS, " ms"),
                f"{Repeated.of(each.handshake_median for each in found)}",
                f"{slowest}",
                report.check(
                    name, "beside a flood, handshake", slowest.median, LIMIT_HANDSHAKE_MS, " ms"
                ),
                f"{statistics.median(each.flood_per_s for each in found):,.0f}",
            )
        )
    report.table(
        f"Flood on one topic, {RATE} msg/s on another, minimum (median) of {plan.reps}",
        (
            "server",
            "p50, ms",
            "p99, ms",
            "limit",
            "handshake, ms",
            "slowest, ms",
            "limit",
            "flood, msg/s",
        ),
        rows,
    )


def _measure(server: Server, plan: Plan, report: Report) -> FloodResult:
    with Flood(server, longest_seconds=plan.warm_seconds + plan.seconds + 60) as flooder:
        time.sleep(LEAD_SECONDS)
        seen = load(server, plan, "--rate", f"{RATE}")
        with on_load_cpu():
            shakes = _handshakes(server)
        flooded = flooder.stop()
    report.fault(server.name, "beside a flood", seen.fault)
    return FloodResult(
        p50=seen.lat_us.p50 / 1000,
        p99=seen.lat_us.p99 / 1000,
        handshake_median=statistics.median(shakes),
        handshake_max=max(shakes),
        flood_per_s=flooded.publishes_per_s,
    )


def _handshakes(server: Server) -> list[float]:
    found: list[float] = []
    deadline = time.monotonic() + HANDSHAKES_SECONDS
    while len(found) < HANDSHAKES and time.monotonic() < deadline:
        found.append(handshake(server.port) * 1000)
    return found
