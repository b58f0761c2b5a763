"""CPU of the hub for one open page of its own: beside a busy topic, and in a large graph."""

from __future__ import annotations

import json
import selectors
import time
from collections.abc import Sequence
from contextlib import ExitStack

from bench.client import Client, answer_pings, connect_all, operation
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, all_running, running

RATE = 1000
"""Messages per second on the busy topic."""
LIMIT_PERCENT = 10.0
"""Of the hub's CPU time, for the page."""
NODES, TOPICS, SUBSCRIBERS = 200, 300, 2
POLL_SECONDS = 1.0
"""The interval at which a page asks for statistics."""
SHARE = 0.2
"""The share of the planned seconds for each of three kinds of calls in the large graph."""

BUSY, EXTRA, TYPE = "/bench/busy", "/bench/extra", "std_msgs/Int32"
GRAPH, STATISTICS = "/rosapi/graph", "/rosapi/statistics"
ASK_GRAPH = operation("call_service", service=GRAPH)
ASK_STATISTICS = operation("call_service", service=STATISTICS)
ADD = operation("advertise", topic=EXTRA, type=TYPE) + ASK_GRAPH
REMOVE = operation("unadvertise", topic=EXTRA) + ASK_GRAPH
UNCHANGED, CHANGED = f"{GRAPH}, unchanged", f"{GRAPH}, changed"
CASES = {UNCHANGED: (ASK_GRAPH,), CHANGED: (ADD, REMOVE), STATISTICS: (ASK_STATISTICS,)}


def page(plan: Plan, report: Report) -> None:
    """Measure a page beside a busy topic, then its service calls in a large graph."""
    _measure_share(plan, report)
    _measure_answers(plan, report)


class Page:
    """The hub's page: it polls statistics, and asks for the graph when that has changed."""

    def __init__(self, client: Client) -> None:
        """Open the page and echo the busy topic on it."""
        self.client = client
        self.responses = 0
        self._revision = -1
        self._next_poll = 0.0
        echo = {"throttle_rate": 100, "queue_length": 1}
        client.send(operation("subscribe", topic=BUSY, type=TYPE, **echo))
        client.send(operation("subscribe", topic="/rosout_agg", queue_length=200))

    def tick(self, now: float) -> None:
        """Ask for statistics if the interval has passed."""
        if now >= self._next_poll:
            self._next_poll = now + POLL_SECONDS
            self.client.send(ASK_STATISTICS)

    def receive(self, messages: Sequence[bytes]) -> None:
        """Process messages from the hub."""
        for message in messages:
            fields = json.loads(message)
            if fields["op"] == "service_response":
                self.responses += 1
                revision = fields["values"]["revision"]
                if fields["service"] == STATISTICS and revision != self._revision:
                    self._revision = revision
                    self.client.send(ASK_GRAPH)


# Beside a busy topic.


class Pair:
    """A publisher and a subscriber on one hub, with or without a page."""

    def __init__(self, server: Server, talker: Client, listener: Client, page: Page | None):
        """Register both."""
        self.server = server
        self.page = page
        self.received = 0
        self._talker, self._listener = talker, listener
        talker.send(operation("advertise", topic=BUSY, type=TYPE))
        listener.send(operation("subscribe", topic=BUSY, type=TYPE))
        listener.settle()

    @property
    def clients(self) -> list[Client]:
        """Return all clients."""
        shown = [] if self.page is None else [self.page.client]
        return [self._talker, self._listener, *shown]

    def tick(self, now: float, number: int) -> None:
        """Publish a number."""
        if self.page is not None:
            self.page.tick(now)
        self._talker.send(operation("publish", topic=BUSY, msg={"data": number}))

    def receive(self, client: Client, messages: Sequence[bytes]) -> None:
        """Process messages for one of the clients."""
        if client is self._listener:
            self.received += len(messages)
        elif self.page is not None and client is self.page.client:
            self.page.receive(messages)

    def settle(self) -> None:
        """Wait until all messages have arrived."""
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
        ("server", "without the page", "with the page", "share of the page, %", "limit"),
        rows,
    )


def _costs(hub: str, plan: Plan, report: Report) -> tuple[Repeated, Repeated]:
    """Return the CPU time in ms per second of a hub without a page and of a hub with one.

    Both run at once, so other load on the machine affects both.
    """
    costs: tuple[list[float], list[float]] = ([], [])
    with ExitStack() as stack:
        stack.enter_context(on_load_cpu())
        servers = stack.enter_context(all_running([hub, hub]))
        crowds = [stack.enter_context(connect_all(server.port, 3, "peer")) for server in servers]
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
                opened = pair.page is not None
                report.record("page", server=hub, opened=opened, rep=rep, cpu_ms_per_s=cost)
    return Repeated.of(costs[0]), Repeated.of(costs[1])


def _publish(pairs: Sequence[Pair], seconds: float, report: Report) -> list[float]:
    """Publish on all hubs for some time; return the CPU of each hub in ms per second."""
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
        _check(pair, sent, report)
    taken = time.perf_counter() - start
    return [
        (pair.server.cpu_seconds - before) / taken * 1000
        for pair, before in zip(pairs, cpu, strict=True)
    ]


def _check(pair: Pair, sent: int, report: Report) -> None:
    """Report messages and responses that did not arrive."""
    if pair.received != sent:
        report.fault(pair.server.name, "page", f"{pair.received} of {sent} messages arrived")
    if pair.page is not None and pair.page.responses < 2:
        report.fault(pair.server.name, "page", "the page received no response")


# In a large graph.


def _measure_answers(plan: Plan, report: Report) -> None:
    rows = []
    for hub in plan.hubs:
        with on_load_cpu(), running(hub) as server:
            found, sizes = _responses(server, plan, report)
        for case, costs in found.items():
            rows.append((hub, case, f"{Repeated.of(costs)}", f"{sizes[case] / 1000:.0f}"))
    report.table(
        f"{NODES} nodes and {TOPICS} topics with {SUBSCRIBERS} subscribers each: CPU of the hub, "
        f"ms per call, minimum (median) of {plan.reps}",
        ("server", "service", "ms per call", "kB"),
        rows,
    )


def _responses(
    server: Server, plan: Plan, report: Report
) -> tuple[dict[str, list[float]], dict[str, int]]:
    """Return the CPU time of the calls in ms, and the bytes of a response, by case."""
    costs: dict[str, list[float]] = {case: [] for case in CASES}
    sizes: dict[str, int] = {}
    with (
        connect_all(server.port, NODES, "node") as nodes,
        connect_all(server.port, 1, "page") as (caller,),
    ):
        _register(nodes)
        for rep in range(plan.reps):
            for case, operations in CASES.items():
                answer_pings([*nodes, caller])
                cost, sizes[case] = _call(server, caller, operations, plan.seconds * SHARE)
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
    server: Server, caller: Client, operations: Sequence[bytes], seconds: float
) -> tuple[float, int]:
    """Repeat calls; return the CPU time of a call in ms, and the bytes of a response."""
    calls, response = 0, b""
    cpu, end = server.cpu_seconds, time.perf_counter() + seconds
    while not calls or time.perf_counter() < end:
        for frames in operations:
            caller.send(frames)
            (response,) = caller.receive()
            calls += 1
    cpu = server.cpu_seconds - cpu
    values = json.loads(response)["values"]
    nodes = values["nodes"] if "nodes" in values else values["clients"]
    if len(values["topics"]) < TOPICS or len(nodes) < NODES:
        raise BenchError(f"{server.name} returned only a part of the graph")
    return cpu / calls * 1000, len(response)
