"""Measure the hub and its references, print tables, compare with the limits."""

from __future__ import annotations

import argparse
import resource
import sys
from dataclasses import replace

from bench.codecs import codecs
from bench.encodings import encodings
from bench.fanout import fanout
from bench.flood import flood
from bench.idle import idle
from bench.latency import latency
from bench.machine import require_linux
from bench.measure import QUICK, BenchError, Plan
from bench.page import page
from bench.report import Report
from bench.rosapi import rosapi
from bench.rospy import rospy
from bench.servers import binary
from bench.services import services
from bench.startup import startup
from bench.subscriptions import subscriptions

SCENARIOS = {
    "fanout": fanout,
    "latency": latency,
    "flood": flood,
    "idle": idle,
    "start": startup,
    "codecs": codecs,
    "services": services,
    "encodings": encodings,
    "rosapi": rosapi,
    "page": page,
    "subscriptions": subscriptions,
    "rospy": rospy,
}
OPEN_FILES = 8192


def main() -> int:
    """Run what the command line asks for and return the exit status."""
    options = _options()
    plan = QUICK if options.quick else Plan()
    plan = replace(plan, reps=options.reps or plan.reps, uvloop=options.uvloop)
    try:
        require_linux()
        _raise_open_files()
        for name in ("wsload", "relay"):
            binary(name)
        report = Report()
        for name in options.scenario or SCENARIOS:
            SCENARIOS[name](plan, report)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    return report.close(report_only=options.report_only or options.quick)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("scenario", nargs="*", help=f"{', '.join(SCENARIOS)}; all by default")
    parser.add_argument("--reps", type=int, help="repetitions, the servers taking turns")
    parser.add_argument(
        "--quick", action="store_true", help="one short repetition, limits only reported"
    )
    parser.add_argument("--uvloop", action="store_true", help="measure the hub on uvloop too")
    parser.add_argument("--report-only", action="store_true", help="fail on loss, not on limits")
    options = parser.parse_args()
    if unknown := set(options.scenario) - set(SCENARIOS):
        parser.error(f"no scenario {', '.join(sorted(unknown))}; there are {', '.join(SCENARIOS)}")
    if options.reps is not None and options.reps < 1:
        parser.error("--reps starts at 1")
    return options


def _raise_open_files() -> None:
    # A server inherits this; a thousand idle connections pass the usual 1024.
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OPEN_FILES if hard == resource.RLIM_INFINITY else min(OPEN_FILES, hard)
    if soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


if __name__ == "__main__":
    sys.exit(main())
