"""CPU of the hub for web pages that poll the list of topics, as Lichtblick does."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence

from bench.client import Client, answer_pings, connect_all, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running
from fibws.interfaces import Interfaces

ROBOTS, TOPICS, PAGES = 20, 1000, 50
PERIOD_SECONDS = 3.0
"""The polling interval of a page."""
LIMIT_PERCENT = 1.0
PACKAGES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs")
SHARE = 0.5
"""The share of the planned seconds for each of two measurements."""

SERVICE, EXTRA, EXTRA_TYPE = "/rosapi/topics_and_raw_types", "/bench/extra", "std_msgs/Empty"
CALL = operation("call_service", service=SERVICE)
ADD = operation("advertise", topic=EXTRA, type=EXTRA_TYPE) + CALL
REMOVE = operation("unadvertise", topic=EXTRA) + CALL
UNCHANGED, CHANGED = "unchanged graph", "a topic added or removed before each call"
CASES = {UNCHANGED: (CALL,), CHANGED: (ADD, REMOVE)}


def rosapi(plan: Plan, report: Report) -> None:
    """Call from all pages in turn, with an unchanged graph and with a changing one."""
    rows = []
    for hub in plan.hubs:
        with on_load_cpu(), running(hub) as server:
            costs, size = _costs(server, plan, report)
        for case, found in costs.items():
            cost = Repeated.of(found)
            percent = cost.median * PAGES / PERIOD_SECONDS / 1e6 * 100
            limit = LIMIT_PERCENT if case == UNCHANGED else None
            verdict = report.check(hub, f"{SERVICE}, {case}", percent, limit, " %")
            rows.append((hub, case, f"{cost}", f"{percent:.2f}", verdict))
    report.table(
        f"{SERVICE} of {TOPICS} topics, {size / 1000:.0f} kB: CPU of the hub, "
        f"minimum (median) of {plan.reps}",
        (
            "server",
            "graph",
            "µs per call",
            f"{PAGES} pages every {PERIOD_SECONDS:g} s, % of a CPU",
            "limit",
        ),
        rows,
    )


def _costs(server: Server, plan: Plan, report: Report) -> tuple[dict[str, list[float]], int]:
    """Return the CPU time of the calls in µs, by case, and the bytes of a response."""
    costs: dict[str, list[float]] = {case: [] for case in CASES}
    with (
        connect_all(server.port, ROBOTS, "robot") as robots,
        connect_all(server.port, PAGES, "page") as pages,
    ):
        responses = _responses(pages[0], _advertise(robots), server, report)
        for rep in range(plan.reps):
            for case, operations in CASES.items():
                answer_pings([*robots, *pages])
                _cost(server, pages, operations, responses, plan.warm_seconds, report)
                cost = _cost(server, pages, operations, responses, plan.seconds, report)
                costs[case].append(cost)
                report.record("rosapi", server=server.name, case=case, rep=rep, cpu_us=cost)
    return costs, len(responses[CALL])


def _advertise(robots: Sequence[Client]) -> dict[str, str]:
    """Advertise the robots' topics; return their types by name."""
    interfaces = Interfaces()
    known_types = [name for package in PACKAGES for name in interfaces.messages(package)]
    some = known_types[::3]  # About thirty.
    types = {f"/robot_{n % ROBOTS}/topic_{n}": some[n % len(some)] for n in range(TOPICS)}
    for n, (topic, type_) in enumerate(types.items()):
        robots[n % ROBOTS].send(operation("advertise", topic=topic, type=type_))
    for robot in robots:
        robot.settle()
    return types


def _responses(
    page: Client, types: Mapping[str, str], server: Server, report: Report
) -> dict[bytes, bytes]:
    """Return the response to each call, after checking it."""
    interfaces = Interfaces()
    responses = {}
    for call, expected in (
        (CALL, types),
        (ADD, {**types, EXTRA: EXTRA_TYPE}),
        (REMOVE, types),
    ):
        page.send(call)
        (responses[call],) = page.receive()
        response = json.loads(responses[call])
        if not response["result"]:
            raise BenchError(f"{server.name}: {SERVICE} fails: {response['values']}")
        values = response["values"]
        lists = values["topics"], values["types"], values["typedefs_full_text"]
        # The hub adds topics of its own.
        listed = {each for each in zip(*lists, strict=True) if each[0] in types or each[0] == EXTRA}
        if listed != {
            (topic, type_, interfaces.full_text(type_)) for topic, type_ in expected.items()
        }:
            report.fault(server.name, SERVICE, f"{len(listed)} topics listed, not as advertised")
    return responses


def _cost(
    server: Server,
    pages: Sequence[Client],
    operations: Sequence[bytes],
    responses: Mapping[bytes, bytes],
    seconds: float,
    report: Report,
) -> float:
    """Call from one page after the other; return the CPU time of a call in µs."""
    calls, wrong = 0, 0
    cpu, end = server.cpu_seconds, time.perf_counter() + seconds * SHARE
    while not calls or time.perf_counter() < end:
        for page in pages:
            for frames in operations:
                page.send(frames)
                wrong += page.receive() != [responses[frames]]
                calls += 1
    cpu = server.cpu_seconds - cpu
    if wrong:
        report.fault(
            server.name, SERVICE, f"{wrong} of {calls} responses differ from the first one"
        )
    return cpu / calls * 1e6
