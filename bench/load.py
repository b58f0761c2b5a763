"""The load generator (wsload.c): start it and read its report."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Mapping, Sequence
from itertools import count
from statistics import quantiles
from typing import Protocol, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from bench.machine import cpus
from bench.measure import BASE, HUB, NAIVE, RELAY, BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, all_running, binary

TOPICS = count(1)
Result = TypeVar("Result", bound=BaseModel)


class Setting(Protocol):
    """The load that each server is measured at."""

    @property
    def name(self) -> str:
        """Return the name in the table."""

    @property
    def options(self) -> tuple[str, ...]:
        """Return the options of the load generator."""


At = TypeVar("At", bound=Setting)


class Latency(BaseModel):
    """One-way latency, publisher to subscriber, in µs."""

    p50: float
    p99: float
    max: float


class Load(BaseModel):
    """The report of one run with publishers and subscribers."""

    model_config = ConfigDict(extra="allow")

    cpu_us_per_delivery: float
    client_cpu_percent: float
    server_cpu_percent: float
    deliveries: int
    deliveries_per_s: float
    publishes_per_s: float
    lat_us: Latency
    loss: int
    dups: int
    out_of_order: int
    conn_errors: int
    masked_frames: int
    first_error: str = ""

    @property
    def fault(self) -> str:
        """Return the server's faults; empty if there are none."""
        wrong = ("loss", "dups", "out_of_order", "conn_errors", "masked_frames")
        found = [f"{name} {n}" for name in wrong if (n := getattr(self, name))]
        return ", ".join([*found, *filter(None, [self.first_error])])


class Idle(BaseModel):
    """The report of one run with idle connections."""

    model_config = ConfigDict(extra="allow")

    open: int
    server_rss_kb_per_conn: float
    server_cpu_us_per_connect: float
    connects_per_s: float
    server_cpu_percent: float
    conn_errors: int
    first_error: str = ""


def load(server: Server, plan: Plan, *options: str) -> Load:
    """Publish and subscribe on a new topic for the planned time."""
    timing = ("--warm", f"{plan.warm_seconds}", "--dur", f"{plan.seconds}")
    return _parsed(Load, server, _finished(server, *timing, *options))


def measured(
    kind: str, settings: Sequence[At], plan: Plan, report: Report
) -> dict[tuple[At, str], list[Load]]:
    """Measure at each setting all servers in turn; return the loads by setting and server."""
    names = (HUB, BASE) if plan.against else (*plan.hubs, RELAY, NAIVE)
    loads: dict[tuple[At, str], list[Load]] = {(at, name): [] for at in settings for name in names}
    for rep in range(plan.reps):
        # Started again for each repetition: two processes of one program differ by a few per cent.
        with all_running(names, against=plan.against) as servers:
            for at in settings:
                for server in servers[::-1] if rep % 2 else servers:
                    seen = load(server, plan, *at.options)
                    loads[at, server.name].append(seen)
                    facts = seen.model_dump()
                    report.record(kind, server=server.name, cell=at.name, rep=rep, **facts)
                    report.fault(server.name, at.name, seen.fault)
    return loads


def compare(
    kind: str,
    title: str,
    settings: Sequence[At],
    figures: Mapping[str, Callable[[Load], float]],
    plan: Plan,
    report: Report,
) -> None:
    """Measure this hub and the hub of another checkout in turn, and print the ratios."""
    loads = measured(kind, settings, plan, report)
    rows = []
    for at in settings:
        for name, figure in figures.items():
            new, base = ([figure(each) for each in loads[at, hub]] for hub in (HUB, BASE))
            ratio = Repeated.ratio(new, base)
            report.record(f"{kind} against", cell=at.name, figure=name, **vars(ratio))
            values = (f"{Repeated.of(new)}", f"{Repeated.of(base)}")
            low, high = _quartiles([value / other for value, other in zip(new, base, strict=True)])
            ratios = (f"{ratio.median:.3f}", f"{low:.3f} to {high:.3f}", f"{ratio.least:.3f}")
            rows.append((at.name, name, *values, *ratios))
    report.table(
        f"{title}: this hub against the hub of {plan.against}, minimum (median) of {plan.reps}",
        ("cell", "figure", "new", "base", "new : base, median", "quartiles", "of the minima"),
        rows,
    )


def _quartiles(values: Sequence[float]) -> tuple[float, float]:
    if len(values) < 2:
        return values[0], values[0]
    low, _, high = quantiles(values, n=4, method="inclusive")
    return low, high


def idle(server: Server, connections: int, hold_seconds: float) -> Idle:
    """Hold idle connections with one subscription each."""
    options = ("--idle", f"{connections}", "--hold", f"{hold_seconds}")
    return _parsed(Idle, server, _finished(server, *options))


class Flood:
    """One publisher that sends as fast as TCP allows, and one subscriber."""

    def __init__(self, server: Server, longest_seconds: float) -> None:
        """Start to flood."""
        self._server = server
        options = ("--window", "1", "--window-at", "none", "--drain", "0")
        timing = ("--warm", "0", "--dur", f"{longest_seconds}")
        self._generator = _start(server, *timing, *options)
        if chosen := cpus():
            os.sched_setaffinity(self._generator.pid, {chosen.flood})
        # If both generators share a CPU, the measuring one has priority.
        os.setpriority(os.PRIO_PROCESS, self._generator.pid, 19)

    def stop(self) -> Load:
        """Stop the flood and return its report; messages that it lost are not a fault."""
        if self._generator.poll() is not None:
            raise BenchError(f"the flood on {self._server.name} stopped early")
        self._generator.terminate()
        return _parsed(Load, self._server, _output(self._generator, self._server))

    def __enter__(self) -> Self:
        """Do nothing; the flood has started."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Stop the flood."""
        self._generator.kill()
        self._generator.communicate()


def _start(server: Server, *options: str) -> subprocess.Popen[str]:
    topic = f"/bench/t{next(TOPICS)}"
    address = ("--port", f"{server.port}", "--pid", f"{server.pid}", "--topic", topic)
    generator = subprocess.Popen(
        [binary("wsload"), *address, *options],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    if chosen := cpus():
        os.sched_setaffinity(generator.pid, {chosen.load})
    return generator


def _finished(server: Server, *options: str) -> str:
    return _output(_start(server, *options), server)


def _output(generator: subprocess.Popen[str], server: Server) -> str:
    try:
        output, errors = generator.communicate()
    finally:
        generator.kill()
    if not output:
        raise BenchError(f"{server.name}: {errors.strip() or 'the load generator died'}")
    return output


def _parsed(model: type[Result], server: Server, output: str) -> Result:
    try:
        return model.model_validate_json(output)
    except ValidationError as error:
        raise BenchError(f"{server.name}: unreadable report: {output[:200]}") from error
