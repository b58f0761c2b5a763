"""CPU of fibws.Node for small messages, and CPU of the hub for large messages between two nodes."""

from __future__ import annotations

from collections.abc import Sequence

from bench.environments import Environment, Traffic, on_hub
from bench.measure import HUB, Plan, Repeated
from bench.report import Report

LIMIT_PUBLISH_US, LIMIT_RECEIVE_US = 8.0, 6.0
PUBLISH_PER_SECOND = 20_000
"""Messages of the publishing loop, for each of the planned seconds."""
RECEIVE_HZ = 10_000
"""A rate that the subscriber keeps up with."""

LARGE_BYTES, LARGE_HZ = 1_000_000, 10
FEW, MANY = SUBSCRIBERS = (1, 11)
LIMIT_ONE_MS, LIMIT_FURTHER_MS = 1.2, 0.4


def nodes(plan: Plan, report: Report) -> None:
    """Measure fibws.Node with std_msgs/Int32, then the hub with images of 1 MB."""
    with on_hub() as (_, environment):
        _measure_nodes(environment, plan, report)
        _measure_hub(environment, plan, report)


def _measure_nodes(environment: Environment, plan: Plan, report: Report) -> None:
    publish, receive = [], []
    for rep in range(plan.reps):
        publish.append(_publish(environment, plan))
        receive.append(_receive(environment, plan, report))
        report.record("node", rep=rep, publish_us=publish[-1], receive_us=receive[-1])
    report.table(
        f"fibws.Node, std_msgs/Int32: CPU µs per message, minimum (median) of {plan.reps}",
        ("what", "CPU", "limit"),
        [
            _row("publish in a loop", publish, LIMIT_PUBLISH_US, report),
            _row(f"receive at {RECEIVE_HZ:,} Hz", receive, LIMIT_RECEIVE_US, report),
        ],
    )


def _row(what: str, costs: Sequence[float], limit: float, report: Report) -> Sequence[str]:
    cost = Repeated.of(costs)
    verdict = report.check(HUB, f"fibws.Node, {what}", cost.median, limit, " µs")
    return (what, f"{cost}", verdict)


def _publish(environment: Environment, plan: Plan) -> float:
    """Return the publisher's CPU time per message, in µs."""
    count = round(PUBLISH_PER_SECOND * plan.seconds)
    with environment.script("number_publisher.py", str(count)) as publisher:
        return float(publisher.line()) / count * 1e6


def _receive(environment: Environment, plan: Plan, report: Report) -> float:
    """Return the subscriber's CPU time per message, in µs."""
    count = round(RECEIVE_HZ * plan.seconds)
    with environment.script("number_subscriber.py", str(count)) as subscriber:
        subscriber.line()
        with environment.script("number_publisher.py", str(count), str(RECEIVE_HZ)) as publisher:
            publisher.line()
            received, seconds = subscriber.line().split()
    if int(received) != count:
        report.fault(HUB, "fibws.Node", f"lost {count - int(received)} of {count}")
    return float(seconds) / count * 1e6


def _measure_hub(environment: Environment, plan: Plan, report: Report) -> None:
    costs: dict[int, list[float]] = {n: [] for n in SUBSCRIBERS}
    for rep in range(plan.reps):
        for n in SUBSCRIBERS:
            traffic = Traffic("sensor_msgs/Image", LARGE_BYTES, LARGE_HZ, subscribers=n)
            run = environment.run(traffic, plan)
            report.fault(HUB, f"1 MB to {n}", run.fault)
            report.record("hub alone", subscribers=n, rep=rep, hub_cpu_us=run.hub_cpu_us)
            costs[n].append(run.hub_cpu_us / 1000)
    one = Repeated.of(costs[FEW])
    further = Repeated.of(
        (many - few) / (MANY - FEW) for few, many in zip(costs[FEW], costs[MANY], strict=True)
    )
    report.table(
        f"A message of 1 MB from fibws.Node to fibws.Node: CPU of the hub, ms per message, "
        f"minimum (median) of {plan.reps}",
        ("subscribers", "CPU", "limit"),
        [
            ("1", f"{one}", report.check(HUB, "1 MB to 1", one.median, LIMIT_ONE_MS, " ms")),
            (
                f"each of {MANY - FEW} more",
                f"{further}",
                report.check(
                    HUB, "1 MB, each further one", further.median, LIMIT_FURTHER_MS, " ms"
                ),
            ),
        ],
    )
