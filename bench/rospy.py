"""rospy scripts on the hub beside the same scripts on a real ROS: latency, throughput, import."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles
from typing import NamedTuple

from bench.measure import HUB, BenchError, Plan
from bench.report import Report
from bench.servers import running

SCRIPTS = Path(__file__).parent / "scripts"
ROS = "ros"
ROSCORE, PYTHON = Path("/usr/bin/roscore"), "/usr/bin/python3"
"""Debian's."""
MODULES = Path("fibws/ros1/python").resolve()

CALM, BUSY = 100.0, 10_000.0
"""Messages a second."""
LIMIT_AGAINST_ROS = 3.0
"""For the median of the latency at the calm rate."""
LIMIT_IMPORT_SECONDS = 0.2
PATIENCE = 60.0


class Course(NamedTuple):
    """What became of the messages of one run: microseconds that each took, and what went wrong."""

    took: list[float]
    fault: str
    seconds: float
    """For which the publisher published."""


@dataclass(frozen=True)
class World:
    """Where scripts run: which Python runs them, and how they find each other."""

    name: str
    command: Sequence[str]
    environment: dict[str, str]

    def run(self, hz: float, count: int) -> Course:
        """Publish so many messages at the rate."""
        subscriber = self._start("subscriber.py", str(count))
        try:
            assert subscriber.stdout is not None
            if subscriber.stdout.readline() != "ready\n":
                raise BenchError(f"{self.name}: the subscriber did not start")
            publisher = self._start("publisher.py", str(hz), str(count))
            try:
                published, _ = publisher.communicate(timeout=PATIENCE)
                verdict, took = subscriber.communicate(timeout=PATIENCE)[0].splitlines()
            finally:
                publisher.kill()
        finally:
            subscriber.kill()
        expected = f"{count} of {count}, 0 out of order"
        fault = "" if verdict == expected else f"{hz:g} messages/s: {verdict}"
        return Course([float(each) for each in took.split()], fault, float(published))

    def import_seconds(self) -> float:
        """Return how long ``import rospy`` takes, above a Python that imports nothing."""
        times = []
        for source in ("import rospy", ""):
            start = time.perf_counter()
            interpreter = self.command[0]
            subprocess.run([interpreter, "-c", source], env=self.environment, check=True)
            times.append(time.perf_counter() - start)
        return times[0] - times[1]

    def _start(self, script: str, *arguments: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [*self.command, str(SCRIPTS / script), *arguments],
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
        )


def rospy(plan: Plan, report: Report) -> None:
    """Run the scripts in both worlds by turns; without a real ROS, only on the hub."""
    with ExitStack() as stack:
        worlds = [stack.enter_context(_fibws())]
        if ROSCORE.exists():
            worlds.append(stack.enter_context(_ros()))
        else:
            print("note: there is no real ROS here to compare rospy with", file=sys.stderr)
        _measure_latency(worlds, plan, report)
        _measure_throughput(worlds, plan, report)
        _measure_import(worlds, plan, report)


def _measure_latency(worlds: Sequence[World], plan: Plan, report: Report) -> None:
    found: dict[str, list[float]] = {world.name: [] for world in worlds}
    last: dict[str, list[float]] = {}
    for rep in range(plan.reps):
        for world in worlds:
            course = world.run(CALM, int(CALM * plan.seconds))
            report.fault(world.name, "rospy", course.fault)
            found[world.name].append(median(course.took))
            last[world.name] = course.took
            report.record("rospy latency", world=world.name, rep=rep, p50=median(course.took))
    rows = []
    for name, medians in found.items():
        ratio = min(medians) / min(found[ROS]) if ROS in found else 0.0
        verdict = report.check(name, "rospy, p50 against ros", ratio, LIMIT_AGAINST_ROS, " x")
        p99 = quantiles(last[name], n=100)[-1]
        p50 = f"{min(medians):.0f} ({median(medians):.0f})"
        rows.append((name, p50, f"{p99:.0f}", f"{ratio:.2f}", verdict))
    report.table(
        f"rospy to rospy, {CALM:g} messages/s of std_msgs/String: µs from publish to callback, "
        f"minimum (median) of the p50 of {plan.reps}",
        ("world", "p50", "p99 of the last", "p50 against ros", "limit"),
        rows,
    )


def _measure_throughput(worlds: Sequence[World], plan: Plan, report: Report) -> None:
    rows = []
    for world in worlds:
        course = world.run(BUSY, int(BUSY * plan.seconds))
        report.fault(world.name, "rospy", course.fault)
        rate = len(course.took) / course.seconds
        report.record("rospy throughput", world=world.name, rate=rate, fault=course.fault)
        rows.append(
            (world.name, f"{rate:.0f}", f"{median(course.took):.0f}", course.fault or "none")
        )
    report.table(
        f"rospy to rospy, {BUSY:g} messages/s for {plan.seconds:g} s",
        ("world", "heard a second", "p50, µs", "lost or out of order"),
        rows,
    )


def _measure_import(worlds: Sequence[World], plan: Plan, report: Report) -> None:
    rows = []
    for world in worlds:
        world.import_seconds()  # The first one compiles modules and fills the page cache.
        seconds = median(world.import_seconds() for _ in range(max(3, plan.reps)))
        verdict = report.check(world.name, "import rospy", seconds, LIMIT_IMPORT_SECONDS, " s")
        report.record("rospy import", world=world.name, seconds=seconds)
        rows.append((world.name, f"{seconds * 1000:.0f}", verdict))
    report.table("import rospy: ms, median", ("world", "ms", "limit"), rows)


@contextmanager
def _fibws() -> Iterator[World]:
    with running(HUB) as server:
        # Nobody ties a ROS's processes to CPUs, either.
        os.sched_setaffinity(server.pid, os.sched_getaffinity(0))
        environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("ROS")},
            "FIBWS_HUB": f"ws://127.0.0.1:{server.port}",
            "PYTHONPATH": str(MODULES),
        }
        yield World(HUB, (sys.executable,), environment)


@contextmanager
def _ros() -> Iterator[World]:
    with tempfile.TemporaryDirectory() as home:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        environment = {
            "PATH": "/usr/bin:/bin",
            "HOME": home,
            "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
            "ROS_IP": "127.0.0.1",
            "PYTHONUNBUFFERED": "1",
        }
        master = subprocess.Popen(
            [str(ROSCORE), "-p", str(port)],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            assert master.stdout is not None
            if not any("started core service [/rosout]" in line for line in master.stdout):
                raise BenchError("roscore did not start")
            yield World(ROS, (PYTHON,), environment)
        finally:
            master.terminate()
            master.communicate()
