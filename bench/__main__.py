"""Measure the hub and its references, print tables, and compare with the limits."""

from __future__ import annotations

import argparse
import resource
import sys
from dataclasses import replace
from pathlib import Path

from bench import robots
from bench.access import access
from bench.bags import bags
from bench.codecs import codecs
from bench.encodings import encodings
from bench.fanout import fanout
from bench.flood import flood
from bench.foxglove import foxglove
from bench.growth import growth
from bench.hubs import hubs
from bench.idle import idle
from bench.isolation import isolation
from bench.latency import latency
from bench.machine import require_linux
from bench.measure import COMPARISON, QUICK, BenchError, Plan
from bench.metrics import metrics
from bench.mjpeg import mjpeg
from bench.nodes import nodes
from bench.page import page
from bench.recording import recording
from bench.report import Report
from bench.ros1 import ros1
from bench.rosapi import rosapi
from bench.rospy import rospy
from bench.servers import binary
from bench.services import services
from bench.soak import soak
from bench.soak_hubs import soak_hubs
from bench.startup import startup
from bench.stuck import stuck
from bench.subscriptions import subscriptions
from bench.tf import tf
from bench.tls import tls

SCENARIOS = {
    "fanout": fanout,
    "latency": latency,
    "flood": flood,
    "idle": idle,
    "start": startup,
    "codecs": codecs,
    "bags": bags,
    "recording": recording,
    "services": services,
    "tls": tls,
    "encodings": encodings,
    "foxglove": foxglove,
    "rosapi": rosapi,
    "metrics": metrics,
    "page": page,
    "subscriptions": subscriptions,
    "growth": growth,
    "rospy": rospy,
    "tf": tf,
    "ros1": ros1,
    "robots": robots.robots,
    "nodes": nodes,
    "mjpeg": mjpeg,
    "stuck": stuck,
    "isolation": isolation,
    "access": access,
    "hubs": hubs,
    "soak": soak,
    "soak-hubs": soak_hubs,
}
COMPARABLE = ("fanout", "latency")
"""The scenarios that --against runs."""
OPEN_FILES = 8192


def main() -> int:
    """Run the scenarios that the command line names and return the exit status."""
    options = _options()
    plan = QUICK if options.quick else COMPARISON if options.against else Plan()
    plan = replace(
        plan,
        reps=options.reps or plan.reps,
        uvloop=options.uvloop,
        cells=options.cells,
        minutes=options.minutes,
        against=options.against,
    )
    try:
        require_linux()
        _raise_open_files()
        for name in ("wsload", "relay"):
            binary(name)
        report = Report()
        for name in options.scenario:
            SCENARIOS[name](plan, report)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    return report.close(report_only=options.report_only or options.quick)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("scenario", nargs="*", help=f"{', '.join(SCENARIOS)}; default: all")
    parser.add_argument("--reps", type=int, help="number of repetitions; servers take turns")
    parser.add_argument(
        "--quick", action="store_true", help="one short repetition; limits are only reported"
    )
    parser.add_argument("--uvloop", action="store_true", help="also measure the hub on uvloop")
    parser.add_argument(
        "--report-only", action="store_true", help="exit with 0 even if limits are missed"
    )
    parser.add_argument(
        "--against",
        type=Path,
        metavar="DIR",
        help="compare with the hub of another checkout (fanout, latency only)",
    )
    parser.add_argument(
        "--cells",
        type=lambda text: tuple(text.split(",")),
        default=(),
        metavar="NAME,...",
        help=f"cells of robots to measure: {', '.join(robots.NAMES)}; default: all",
    )
    parser.add_argument("--minutes", type=float, help="duration of stuck and soak")
    options = parser.parse_args()
    if unknown := set(options.scenario) - set(SCENARIOS):
        parser.error(
            f"unknown scenario {', '.join(sorted(unknown))}; expected {', '.join(SCENARIOS)}"
        )
    if unknown := set(options.cells) - set(robots.NAMES):
        parser.error(
            f"unknown cell {', '.join(sorted(unknown))}; expected {', '.join(robots.NAMES)}"
        )
    if options.reps is not None and options.reps < 1:
        parser.error(f"--reps must be >= 1, got {options.reps}")
    if options.minutes is not None and options.minutes <= 0:
        parser.error(f"--minutes must be > 0, got {options.minutes:g}")
    if options.against is not None:
        options.against = options.against.resolve()
        if not (options.against / "fibws" / "hub").is_dir():
            parser.error(f"--against: fibws/hub not found in {options.against}")
        if other := set(options.scenario) - set(COMPARABLE):
            parser.error(
                f"--against cannot compare {', '.join(sorted(other))}; "
                f"expected {', '.join(COMPARABLE)}"
            )
        options.scenario = options.scenario or list(COMPARABLE)
    options.scenario = options.scenario or list(SCENARIOS)
    return options


def _raise_open_files() -> None:
    # The servers inherit this; a thousand idle connections exceed the usual 1024.
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OPEN_FILES if hard == resource.RLIM_INFINITY else min(OPEN_FILES, hard)
    if soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


if __name__ == "__main__":
    sys.exit(main())
