"""rospy scripts on the hub and on a real ROS: latency, throughput, import time."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from statistics import median, quantiles

from bench.environments import REAL_ROSPY, Environment, Traffic, on_hub, real_ros
from bench.measure import Plan, Repeated, minimum_and_median
from bench.report import Report

LOW = Traffic("std_msgs/String", 32, 100)
HIGH = Traffic("std_msgs/String", 32, 10_000)
LIMIT_AGAINST_ROS = 3.0
"""For the median of the latency at the low rate."""
LIMIT_IMPORT_SECONDS = 0.2
WAKE_LOOP = """
from rospy.background import LoopLock
LoopLock.try_acquire = lambda self: False
"""
"""Makes publishers wake the event loop for each message; see `LoopLock`."""


def rospy(plan: Plan, report: Report) -> None:
    """Run the scripts in both environments in turn; without a real ROS, only on the hub."""
    with ExitStack() as stack:
        on_the_hub, _ = stack.enter_context(on_hub())
        ros = stack.enter_context(real_ros())
        environments = [on_the_hub, *([ros] if ros else [])]
        waking = replace(on_the_hub, title="rospy, waking the loop", prelude=WAKE_LOOP)
        _measure_latency([*environments, waking], plan, report)
        _measure_throughput(environments, plan, report)
        _measure_import(environments, plan, report)


def _measure_latency(environments: Sequence[Environment], plan: Plan, report: Report) -> None:
    medians: dict[str, list[float]] = {each.title: [] for each in environments}
    cpu: dict[str, list[float]] = {each.title: [] for each in environments}
    last: dict[str, list[float]] = {}
    for rep in range(plan.reps):
        for environment in environments if rep % 2 else environments[::-1]:
            run = environment.run(LOW, plan)
            title = environment.title
            report.fault(environment.name, title, run.fault)
            medians[title].append(median(run.took))
            cpu[title].append(run.cpu_us)
            last[title] = run.took
            report.record(
                "rospy latency", scripts=title, rep=rep, p50=median(run.took), cpu=run.cpu_us
            )
    rows = []
    ours = environments[0]
    for environment in environments:
        title = environment.title
        against_ros = verdict = ""
        if REAL_ROSPY in medians and title != REAL_ROSPY:
            ratio = Repeated.ratio(medians[title], medians[REAL_ROSPY])
            against_ros = f"{ratio}"
            if environment is ours:
                what = "rospy, p50 against real ROS"
                verdict = report.check(
                    environment.name, what, ratio.median, LIMIT_AGAINST_ROS, " x"
                )
        rows.append(
            (
                title,
                minimum_and_median(medians[title]),
                f"{quantiles(last[title], n=100)[-1]:.0f}",
                against_ros,
                verdict,
                minimum_and_median(cpu[title]),
                f"{Repeated.ratio(medians[title], medians[ours.title])}",
                f"{Repeated.ratio(cpu[title], cpu[ours.title])}",
            )
        )
    report.table(
        f"rospy to rospy, {LOW.hz:g} messages/s of std_msgs/String: µs from publish to callback, "
        f"and CPU µs per message, minimum (median) of {plan.reps}",
        (
            "scripts",
            "p50",
            "p99 of the last run",
            "p50 : real ROS",
            "limit",
            "CPU",
            f"p50 : {ours.title}",
            f"CPU : {ours.title}",
        ),
        rows,
    )


def _measure_throughput(environments: Sequence[Environment], plan: Plan, report: Report) -> None:
    rows = []
    for environment in environments:
        run = environment.run(HIGH, plan)
        report.fault(environment.name, "rospy", run.fault)
        rate = len(run.took) / run.seconds
        report.record("rospy throughput", environment=environment.name, rate=rate, fault=run.fault)
        rows.append(
            (environment.name, f"{rate:.0f}", f"{median(run.took):.0f}", run.fault or "none")
        )
    report.table(
        f"rospy to rospy, {HIGH.hz:g} messages/s for {plan.seconds:g} s",
        ("server", "received per second", "p50, µs", "lost or out of order"),
        rows,
    )


def _measure_import(environments: Sequence[Environment], plan: Plan, report: Report) -> None:
    rows = []
    for environment in environments:
        _import_seconds(environment)  # The first import compiles modules and fills the page cache.
        seconds = median(_import_seconds(environment) for _ in range(max(3, plan.reps)))
        name = environment.name
        verdict = report.check(name, "import rospy", seconds, LIMIT_IMPORT_SECONDS, " s")
        report.record("rospy import", environment=name, seconds=seconds)
        rows.append((name, f"{seconds * 1000:.0f}", verdict))
    report.table("import rospy: ms, median", ("server", "ms", "limit"), rows)


def _import_seconds(environment: Environment) -> float:
    """Return the time of `import rospy`, less the time of a Python that imports nothing."""
    times = []
    for source in ("import rospy", ""):
        start = time.perf_counter()
        command = [environment.python, "-c", source]
        subprocess.run(command, env=environment.variables, check=True)
        times.append(time.perf_counter() - start)
    return times[0] - times[1]
