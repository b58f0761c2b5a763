"""CPU of the hub for pages that ask for all topics again and again, as Lichtblick's do."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence

from bench.client import Client, answer_pings, crowd, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running
from fibws.interfaces import Interfaces

ROBOTS, TOPICS, PAGES = 20, 1000, 50
PERIOD_SECONDS = 3.0
"""How often a page asks."""
LIMIT_PERCENT = 1.0
PACKAGES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs")
SHARE = 0.5
"""Of the planned seconds, for each of two measurements."""

SERVICE, EXTRA, EXTRA_TYPE = "/rosapi/topics_and_raw_types", "/bench/extra", "std_msgs/Empty"
CALL = operation("call_service", service=SERVICE)
COME = operation("advertise", topic=EXTRA, type=EXTRA_TYPE) + CALL
GO = operation("unadvertise", topic=EXTRA) + CALL
UNCHANGED, CHANGED = "nothing changes", "a topic comes or goes before each call"
CASES = {UNCHANGED: (CALL,), CHANGED: (COME, GO)}


def rosapi(plan: Plan, report: Report) -> None:
    """Have all pages ask in turn, while nothing changes and while a topic comes and goes."""
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
            "while",
            "µs per call",
            f"{PAGES} pages every {PERIOD_SECONDS:g} s, % of a CPU",
            "limit",
        ),
        rows,
    )


def _costs(server: Server, plan: Plan, report: Report) -> tuple[dict[str, list[float]], int]:
    """Return the CPU time of the calls in µs, by case, and the bytes of an answer."""
    costs: dict[str, list[float]] = {case: [] for case in CASES}
    with crowd(server.port, ROBOTS, "robot") as robots, crowd(server.port, PAGES, "page") as pages:
        answers = _answers(pages[0], _advertise(robots), server, report)
        for rep in range(plan.reps):
            for case, asked in CASES.items():
                answer_pings([*robots, *pages])
                _cost(server, pages, asked, answers, plan.warm_seconds, report)
                cost = _cost(server, pages, asked, answers, plan.seconds, report)
                costs[case].append(cost)
                report.record("rosapi", server=server.name, case=case, rep=rep, cpu_us=cost)
    return costs, len(answers[CALL])


def _advertise(robots: Sequence[Client]) -> dict[str, str]:
    """Have the robots advertise their topics; return the types of these by name."""
    interfaces = Interfaces()
    known = [name for package in PACKAGES for name in interfaces.messages(package)]
    some = known[::3]  # about thirty
    types = {f"/robot_{n % ROBOTS}/topic_{n}": some[n % len(some)] for n in range(TOPICS)}
    for n, (topic, type_) in enumerate(types.items()):
        robots[n % ROBOTS].send(operation("advertise", topic=topic, type=type_))
    for robot in robots:
        robot.settle()
    return types


def _answers(
    page: Client, types: Mapping[str, str], server: Server, report: Report
) -> dict[bytes, bytes]:
    """Return the answer to each way of asking, after a look at whether it is right."""
    interfaces = Interfaces()
    answers = {}
    for asked, expected in ((CALL, types), (COME, {**types, EXTRA: EXTRA_TYPE}), (GO, types)):
        page.send(asked)
        (answers[asked],) = page.receive()
        response = json.loads(answers[asked])
        if not response["result"]:
            raise BenchError(f"{server.name}: {SERVICE} fails: {response['values']}")
        values = response["values"]
        lists = values["topics"], values["types"], values["typedefs_full_text"]
        # The hub has topics of its own beside these.
        told = {each for each in zip(*lists, strict=True) if each[0] in types or each[0] == EXTRA}
        if told != {
            (topic, type_, interfaces.full_text(type_)) for topic, type_ in expected.items()
        }:
            report.fault(server.name, SERVICE, f"{len(told)} topics are told, not as advertised")
    return answers


def _cost(
    server: Server,
    pages: Sequence[Client],
    asked: Sequence[bytes],
    answers: Mapping[bytes, bytes],
    seconds: float,
    report: Report,
) -> float:
    """Have the pages ask one after the other; return the CPU time of a call in µs."""
    calls, wrong = 0, 0
    cpu, end = server.cpu_seconds, time.perf_counter() + seconds * SHARE
    while not calls or time.perf_counter() < end:
        for page in pages:
            for frames in asked:
                page.send(frames)
                wrong += page.receive() != [answers[frames]]
                calls += 1
    cpu = server.cpu_seconds - cpu
    if wrong:
        report.fault(server.name, SERVICE, f"{wrong} of {calls} answers are not as before")
    return cpu / calls * 1e6
