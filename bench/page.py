"""CPU of the hub for one open page: beside a busy topic, and in a large graph."""

from __future__ import annotations

import json
import selectors
import time
from collections.abc import Sequence
from contextlib import ExitStack

from bench.client import Client, answer_pings, crowd, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, all_running, running

RATE = 1000
"""Messages a second on the busy topic."""
LIMIT_PERCENT = 10.0
"""Of the hub's CPU, for the page."""
NODES, TOPICS, SUBSCRIBERS = 200, 300, 2
ASK_SECONDS = 1.0
"""How often a page asks for statistics."""
SHARE = 0.2
"""Of the planned seconds, for each of three kinds of calls in the large graph."""

BUSY, EXTRA, TYPE = "/bench/busy", "/bench/extra", "std_msgs/Int32"
GRAPH, STATISTICS = "/rosapi/graph", "/rosapi/statistics"
ASK_GRAPH = operation("call_service", service=GRAPH)
ASK_STATISTICS = operation("call_service", service=STATISTICS)
COME = operation("advertise", topic=EXTRA, type=TYPE) + ASK_GRAPH
GO = operation("unadvertise", topic=EXTRA) + ASK_GRAPH
UNCHANGED, CHANGED = f"{GRAPH}, unchanged", f"{GRAPH}, made anew"
CASES = {UNCHANGED: (ASK_GRAPH,), CHANGED: (COME, GO), STATISTICS: (ASK_STATISTICS,)}


def page(plan: Plan, report: Report) -> None:
    """Measure a page beside a busy topic, then the answers that it gets in a large graph."""
    _measure_share(plan, report)
    _measure_answers(plan, report)


class Page:
    """What the hub's page does: it asks for statistics, and for the graph when that has changed."""

    def __init__(self, client: Client) -> None:
        """Open it, with the busy topic echoed."""
        self.client = client
        self.answers = 0
        self._revision = -1
        self._asks_at = 0.0
        echo = {"throttle_rate": 100, "queue_length": 1}
        client.send(operation("subscribe", topic=BUSY, type=TYPE, **echo))
        client.send(operation("subscribe", topic="/rosout_agg", queue_length=200))

    def tick(self, now: float) -> None:
        """Ask if it is time to."""
        if now >= self._asks_at:
            self._asks_at = now + ASK_SECONDS
            self.client.send(ASK_STATISTICS)

    def receive(self, messages: Sequence[bytes]) -> None:
        """Take what the hub says."""
        for message in messages:
            fields = json.loads(message)
            if fields["op"] == "service_response":
                self.answers += 1
                revision = fields["values"]["revision"]
                if fields["service"] == STATISTICS and revision != self._revision:
                    self._revision = revision
                    self.client.send(ASK_GRAPH)


# Beside a busy topic.


class Pair:
    """Two clients of one hub, of which one publishes to the other, and maybe a page."""

    def __init__(self, server: Server, talker: Client, listener: Client, shown: Page | None):
        """Have them register."""
        self.server = server
        self.shown = shown
        self.received = 0
        self._talker, self._listener = talker, listener
        talker.send(operation("advertise", topic=BUSY, type=TYPE))
        listener.send(operation("subscribe", topic=BUSY, type=TYPE))
        listener.settle()

    @property
    def clients(self) -> list[Client]:
        """Return all of them."""
        shown = [] if self.shown is None else [self.shown.client]
        return [self._talker, self._listener, *shown]

    def tick(self, now: float, number: int) -> None:
        """Publish a number."""
        if self.shown is not None:
            self.shown.tick(now)
        self._talker.send(operation("publish", topic=BUSY, msg={"data": number}))

    def receive(self, client: Client, messages: Sequence[bytes]) -> None:
        """Take what came for one of them."""
        if client is self._listener:
            self.received += len(messages)
        elif self.shown is not None and client is self.shown.client:
            self.shown.receive(messages)

    def settle(self) -> None:
        """Wait until all has come."""
        self._talker.settle()
        self.receive(self._listener, self._listener.settle())


def _measure_share(plan: Plan, report: Report) -> None:
    rows = []
    for hub in plan.hubs:
        without, with_ = _costs(hub, plan, report)
        ratio = without / with_
        percent = 100 * (1 - ratio.median)
        what = f"a page beside {RATE} messages/s"
        verdict = report.check(hub, what, percent, LIMIT_PERCENT, " %")
        rows.append((hub, f"{without}", f"{with_}", f"{percent:.1f}", verdict))
    report.table(
        f"One open page beside {RATE} messages/s to one subscriber: CPU of the hub, "
        f"ms per second, minimum (median) of {plan.reps}",
        ("server", "without it", "with it", "the page's share, %", "limit"),
        rows,
    )


def _costs(hub: str, plan: Plan, report: Report) -> tuple[Repeated, Repeated]:
    """Return the CPU time in ms per second of a hub without a page, and of one with it.

    They run at once: whatever else the machine does befalls both.
    """
    costs: tuple[list[float], list[float]] = ([], [])
    with ExitStack() as stack:
        stack.enter_context(on_load_cpu())
        servers = stack.enter_context(all_running([hub, hub]))
        crowds = [stack.enter_context(crowd(server.port, 3, "peer")) for server in servers]
        pairs = [
            Pair(server, talker, listener, Page(reader) if opened else None)
            for server, (talker, listener, reader), opened in zip(
                servers, crowds, (False, True), strict=True
            )
        ]
        _publish(pairs, plan.warm_seconds, report)
        for rep in range(plan.reps):
            found = _publish(pairs, plan.seconds, report)
            for pair, cost, kept in zip(pairs, found, costs, strict=True):
                kept.append(cost)
                opened = pair.shown is not None
                report.record("page", server=hub, opened=opened, rep=rep, cpu_ms_per_s=cost)
    return Repeated.of(costs[0]), Repeated.of(costs[1])


def _publish(pairs: Sequence[Pair], seconds: float, report: Report) -> list[float]:
    """Publish everywhere at the rate for so long; return the CPU of each hub in ms per second."""
    for pair in pairs:
        pair.received = 0
    sent = 0
    cpu = [pair.server.cpu_seconds for pair in pairs]
    start = time.perf_counter()
    with selectors.DefaultSelector() as selector:
        for pair in pairs:
            for client in pair.clients:
                selector.register(client, selectors.EVENT_READ, (pair, client))
        while (now := time.perf_counter()) < start + seconds:
            if now >= start + sent / RATE:
                for pair in pairs if sent % 2 else pairs[::-1]:
                    pair.tick(now, sent)
                sent += 1
            for key, _ in selector.select(max(0.0, start + sent / RATE - time.perf_counter())):
                pair, client = key.data
                pair.receive(client, client.read())
    for pair in pairs:
        pair.settle()
        if pair.received != sent:
            report.fault(pair.server.name, "page", f"{pair.received} of {sent} messages came")
        if pair.shown is not None and pair.shown.answers < 2:
            report.fault(pair.server.name, "page", "the page was not answered")
    taken = time.perf_counter() - start
    return [
        (pair.server.cpu_seconds - before) / taken * 1000
        for pair, before in zip(pairs, cpu, strict=True)
    ]


# In a large graph.


def _measure_answers(plan: Plan, report: Report) -> None:
    rows = []
    for hub in plan.hubs:
        with on_load_cpu(), running(hub) as server:
            found, sizes = _answers(server, plan, report)
        for case, costs in found.items():
            rows.append((hub, case, f"{Repeated.of(costs)}", f"{sizes[case] / 1000:.0f}"))
    report.table(
        f"{NODES} nodes and {TOPICS} topics with {SUBSCRIBERS} subscribers each: CPU of the hub, "
        f"ms per call, minimum (median) of {plan.reps}",
        ("server", "service", "ms per call", "kB"),
        rows,
    )


def _answers(
    server: Server, plan: Plan, report: Report
) -> tuple[dict[str, list[float]], dict[str, int]]:
    """Return the CPU time of the calls in ms, and the bytes of an answer, by case."""
    costs: dict[str, list[float]] = {case: [] for case in CASES}
    sizes: dict[str, int] = {}
    with crowd(server.port, NODES, "node") as nodes, crowd(server.port, 1, "page") as (asker,):
        _register(nodes)
        for rep in range(plan.reps):
            for case, asked in CASES.items():
                answer_pings([*nodes, asker])
                cost, sizes[case] = _call(server, asker, asked, plan.seconds * SHARE)
                costs[case].append(cost)
                report.record("page", server=server.name, case=case, rep=rep, cpu_ms=cost)
    return costs, sizes


def _register(nodes: Sequence[Client]) -> None:
    for n in range(TOPICS):
        fields = {"topic": f"/robot/topic_{n}", "type": TYPE}
        nodes[n % NODES].send(operation("advertise", **fields))
        for m in range(1, SUBSCRIBERS + 1):
            nodes[(n + m) % NODES].send(operation("subscribe", **fields))
    for node in nodes:
        node.settle()


def _call(
    server: Server, asker: Client, asked: Sequence[bytes], seconds: float
) -> tuple[float, int]:
    """Ask again and again; return the CPU time of a call in ms, and the bytes of an answer."""
    calls, answer = 0, b""
    cpu, end = server.cpu_seconds, time.perf_counter() + seconds
    while not calls or time.perf_counter() < end:
        for frames in asked:
            asker.send(frames)
            (answer,) = asker.receive()
            calls += 1
    cpu = server.cpu_seconds - cpu
    values = json.loads(answer)["values"]
    nodes = values["nodes"] if "nodes" in values else values["clients"]
    if len(values["topics"]) < TOPICS or len(nodes) < NODES:
        raise BenchError(f"{server.name} tells only a part of the graph")
    return cpu / calls * 1000, len(answer)
