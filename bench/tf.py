"""tf2 of rospy scripts on the hub and on a real ROS: CPU of a listener, and lookups per second."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from contextlib import ExitStack

from bench.environments import Environment, on_hub, real_ros
from bench.machine import cpu_seconds
from bench.measure import HUB, Plan, Repeated
from bench.report import Report

FRAMES, HZ = 100, 100
PARTS = (1, 10, 100)
"""Messages in which the frames are sent; a robot_state_publisher sends one."""
LIMITED_PARTS = 10
LINKS = 5
"""The length of the chain, such as map, odom, base_link, torso, arm, hand."""
LIMIT_CPU_PERCENT = 15.0
LIMIT_MICROSECONDS = 50.0
"""20,000 lookups per second."""


def tf(plan: Plan, report: Report) -> None:
    """Run the scripts in both environments in turn; without a real ROS, only on the hub."""
    with ExitStack() as stack:
        on_the_hub, _ = stack.enter_context(on_hub())
        ros = None if plan.quick else stack.enter_context(real_ros())
        environments = [on_the_hub, *([ros] if ros else [])]
        _measure_listener(environments, plan, report)
        _measure_lookups(environments, plan, report)


def _measure_listener(environments: Sequence[Environment], plan: Plan, report: Report) -> None:
    rows = []
    for parts in PARTS[:1] if plan.quick else PARTS:
        for environment in environments:
            found = [_listen(environment, parts, plan) for _ in range(1 if plan.quick else 3)]
            cpu = Repeated.of(cpu for cpu, _ in found)
            rate = sum(rate for _, rate in found) / len(found)
            report.record("tf listener", environment=environment.name, parts=parts, cpu=cpu.median)
            verdict = ""
            if environment.name == HUB and parts <= LIMITED_PARTS:
                what = f"listener, {FRAMES} frames at {HZ} Hz in {parts} messages"
                verdict = report.check(HUB, what, cpu.median, LIMIT_CPU_PERCENT, " %")
            rows.append((environment.name, str(parts), f"{rate:.0f}", f"{cpu} %", verdict))
    report.table(
        f"{FRAMES} frames at {HZ} Hz to a rospy tf2 listener: CPU of the listener, percent of a "
        "core, minimum (median)",
        ("server", "messages", "transforms per second", "CPU", "limit"),
        rows,
    )


def _listen(environment: Environment, parts: int, plan: Plan) -> tuple[float, float]:
    """Return the listener's CPU in percent of a core, and the transforms it got per second."""
    seconds = max(plan.seconds / 2, 0.6)
    numbers = (str(FRAMES), str(parts), str(HZ), f"{seconds + 0.3:g}")
    with environment.script("tf_listener.py") as listener:
        listener.line()
        with environment.script("tf_broadcaster.py", *numbers) as broadcaster:
            broadcaster.line()
            listener.line()
            before, first = cpu_seconds(listener.pid), int(listener.line())
            start = time.perf_counter()
            last = first
            while time.perf_counter() < start + seconds:
                last = int(listener.line())
            took = time.perf_counter() - start
            cpu = cpu_seconds(listener.pid) - before
            broadcaster.line()
    return cpu / took * 100, (last - first) * FRAMES / parts / took


def _measure_lookups(environments: Sequence[Environment], plan: Plan, report: Report) -> None:
    rows = []
    for environment in environments:
        runs = []
        for _ in range(1 if plan.quick else 3):
            seconds = f"{plan.seconds / 2:g}"
            with environment.script("tf_lookups.py", str(LINKS), seconds) as script:
                runs.append(json.loads(script.line()))
        for kind in runs[0]:
            took = Repeated.of(1e6 / run[kind] for run in runs)
            rate = 1e6 / took.median
            report.record("tf lookups", environment=environment.name, time=kind, rate=rate)
            verdict = ""
            if environment.name == HUB:
                what = f"lookup over {LINKS} links, {kind}"
                verdict = report.check(HUB, what, took.median, LIMIT_MICROSECONDS, " µs")
            rows.append((environment.name, kind, f"{rate:.0f}", f"{took}", verdict))
    report.table(
        f"tf2_ros.Buffer.lookup_transform over {LINKS} moving links",
        ("server", "time", "lookups per second", "µs, minimum (median)", "limit"),
        rows,
    )
