"""Messages of robots from script to script: rospy and fibws.Node on the hub, real rospy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from statistics import median

from bench.environments import REAL_ROSPY, ROS, Environment, Run, Traffic, on_hub, real_ros
from bench.measure import Plan, Repeated, minimum_and_median
from bench.report import Report

UNSUSTAINED_PERCENT = 5.0
"""The most by which a publisher may fall short of its rate."""


@dataclass(frozen=True)
class Cell:
    """One kind of message, and the limits of latency and CPU as ratios to real rospy."""

    name: str
    """The name on the command line (--cells)."""
    title: str
    traffic: Traffic
    latency: float
    cpu: float
    quick: bool = False
    """Whether --quick includes it."""


IMAGE = Traffic("sensor_msgs/Image", 921_600, 30)
CELLS = (
    Cell(
        "string",
        "String, 32 B, 1 kHz",
        Traffic("std_msgs/String", 32, 1000),
        latency=2.5,
        cpu=3,
        quick=True,
    ),
    Cell(
        "laserscan",
        "LaserScan, 720 ranges, 40 Hz",
        Traffic("sensor_msgs/LaserScan", 720, 40),
        latency=2,
        cpu=2,
    ),
    Cell(
        "tf",
        "TFMessage, 20 transforms, 50 Hz",
        Traffic("tf2_msgs/TFMessage", 20, 50),
        latency=2,
        cpu=2,
    ),
    Cell(
        "pointcloud",
        "PointCloud2, 320 kB, 10 Hz",
        Traffic("sensor_msgs/PointCloud2", 320_000, 10),
        latency=2,
        cpu=2,
    ),
    Cell("image", "Image, 640x480, 30 Hz", IMAGE, latency=2, cpu=2, quick=True),
    Cell(
        "image10",
        "Image, 640x480, 30 Hz, 10 subscribers",
        Traffic(IMAGE.type, IMAGE.size, IMAGE.hz, subscribers=10),
        latency=1.5,
        cpu=1.3,
    ),
    Cell(
        "1080p",
        "Image, 1920x1080, 10 Hz",
        Traffic("sensor_msgs/Image", 6_220_800, 10),
        latency=2.5,
        cpu=2,
    ),
)
NAMES = tuple(cell.name for cell in CELLS)


def robots(plan: Plan, report: Report) -> None:
    """Measure each cell in all environments in turn; without a real ROS, only on the hub."""
    cells = [
        cell
        for cell in CELLS
        if (cell.name in plan.cells if plan.cells else cell.quick or not plan.quick)
    ]
    with ExitStack() as stack:
        environments = [*stack.enter_context(on_hub())]
        if ros := stack.enter_context(real_ros()):
            environments.append(ros)
        report.table(
            f"Robots: µs from publish to callback, and CPU µs per message of publisher, hub and "
            f"subscribers, minimum (median) of {plan.reps}",
            (
                "message",
                "scripts",
                "p50",
                "p50 : real",
                "limit",
                "CPU",
                "of which hub",
                "CPU : real",
                "limit",
                "lost or late",
            ),
            _rows(cells, environments, plan, report),
        )


def _rows(
    cells: Sequence[Cell], environments: Sequence[Environment], plan: Plan, report: Report
) -> Iterator[Sequence[str]]:
    for cell in cells:
        runs = _runs(cell, environments, plan, report)
        for environment in environments:
            yield _row(cell, environment, runs, report)


def _runs(
    cell: Cell, environments: Sequence[Environment], plan: Plan, report: Report
) -> dict[str, list[Run]]:
    runs: dict[str, list[Run]] = {each.title: [] for each in environments}
    for rep in range(plan.reps):
        for environment in environments if rep % 2 else environments[::-1]:
            run = environment.run(cell.traffic, plan)
            runs[environment.title].append(run)
            report.record(
                "robots",
                cell=cell.name,
                scripts=environment.title,
                rep=rep,
                p50_us=p50(run),
                cpu_us=run.cpu_us,
                hub_cpu_us=run.hub_cpu_us,
                hz=run.hz,
                fault=run.fault,
            )
    return runs


def _row(
    cell: Cell, environment: Environment, runs: dict[str, list[Run]], report: Report
) -> Sequence[str]:
    ours = runs[environment.title]
    real = runs.get(REAL_ROSPY)
    what = f"{cell.title}, {environment.title}"
    latency, cpu = [p50(run) for run in ours], [run.cpu_us for run in ours]
    hub = [run.hub_cpu_us for run in ours]
    ratios = ["", "", "", ""]
    if real and environment.name != ROS:
        to_real = Repeated.ratio(latency, [p50(run) for run in real])
        cpu_to_real = Repeated.ratio(cpu, [run.cpu_us for run in real])
        ratios = [
            f"{to_real}",
            report.check(environment.name, f"{what}, p50", to_real.median, cell.latency, " x"),
            f"{cpu_to_real}",
            report.check(environment.name, f"{what}, CPU", cpu_to_real.median, cell.cpu, " x"),
        ]
    return (
        cell.title,
        environment.title,
        minimum_and_median(latency),
        *ratios[:2],
        minimum_and_median(cpu),
        minimum_and_median(hub) if environment.hub else "",
        *ratios[2:],
        _problems(cell, environment, ours, real or (), report),
    )


def _problems(
    cell: Cell, environment: Environment, ours: Sequence[Run], real: Sequence[Run], report: Report
) -> str:
    """Report lost messages; return them, and the rate of a publisher that was too slow.

    They are a fault only if the real ROS, if installed, lost none.
    """
    what = f"{cell.title}, {environment.title}"
    faults = sorted({run.fault for run in ours if run.fault})
    if not any(run.fault for run in real) or environment.name == ROS:
        for fault in faults:
            report.fault(environment.name, what, fault)
    late = 100 * (1 - median(run.hz for run in ours) / cell.traffic.hz)
    if late > UNSUSTAINED_PERCENT:
        faults.append(f"{median(run.hz for run in ours):.1f} of {cell.traffic.hz:g} Hz")
        report.check(environment.name, f"{what}, below its rate", late, UNSUSTAINED_PERCENT, " %")
    return ", ".join(faults) or "none"


def p50(run: Run) -> float:
    """Return the median latency of a run, in µs; infinite if no message arrived."""
    return median(run.took) if run.took else math.inf
