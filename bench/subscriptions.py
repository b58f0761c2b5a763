"""CPU of the hub per delivery on one topic, beside many subscriptions to other topics."""

from __future__ import annotations

from contextlib import ExitStack

from bench.client import Client, answer_pings, connect_all, operation
from bench.load import Load, load
from bench.measure import Plan, Repeated
from bench.report import Report
from bench.servers import running

TOPICS, SUBSCRIBERS = 100, 100
WINDOW = 64
LIMIT_AGAINST_ALONE = 1.2


def subscriptions(plan: Plan, report: Report) -> None:
    """Measure two hubs of each kind in turn, one of them with the other subscriptions."""
    rows = []
    for hub in plan.hubs:
        alone, crowded = _costs(hub, plan, report)
        ratio = crowded / alone
        what = f"{TOPICS * SUBSCRIBERS} subscriptions, against none"
        verdict = report.check(hub, what, ratio.median, LIMIT_AGAINST_ALONE)
        rows.append((hub, f"{alone}", f"{crowded}", f"{ratio}", verdict))
    report.table(
        f"{TOPICS * SUBSCRIBERS} subscriptions to {TOPICS} other topics: "
        f"CPU of the hub, µs per delivery, minimum (median) of {plan.reps}",
        ("server", "without them", "with them", "with : without", "limit"),
        rows,
    )


def _costs(hub: str, plan: Plan, report: Report) -> tuple[Repeated, Repeated]:
    """Return the costs without and with the other subscriptions."""
    loads: tuple[list[Load], list[Load]] = ([], [])
    with ExitStack() as stack:
        servers = [stack.enter_context(running(hub)) for _ in loads]
        listeners = stack.enter_context(connect_all(servers[1].port, SUBSCRIBERS, "listener"))
        for listener in listeners:
            _subscribe(listener)
        for rep in range(plan.reps):
            for server, found, crowded in zip(servers, loads, (False, True), strict=True):
                seen = load(server, plan, "--window", f"{WINDOW}")
                found.append(seen)
                facts = seen.model_dump()
                report.record("subscriptions", server=hub, crowded=crowded, rep=rep, **facts)
                report.fault(hub, f"subscriptions, {'with' if crowded else 'without'}", seen.fault)
                answer_pings(listeners)
    alone, crowded_ = (Repeated.of(each.cpu_us_per_delivery for each in found) for found in loads)
    return alone, crowded_


def _subscribe(listener: Client) -> None:
    frames = [
        operation("subscribe", topic=f"/bench/other_{n}", type="std_msgs/String")
        for n in range(TOPICS)
    ]
    listener.send(b"".join(frames))
    listener.settle()
