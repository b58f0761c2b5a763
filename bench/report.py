"""Tables for readers, JSON lines for programs, missed limits and faults."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from bench.machine import Disturbance, describe
from bench.measure import HUBS

RESULTS = Path(__file__).parent / "results"


class Report:
    """Prints tables, and collects missed limits and faults."""

    def __init__(self) -> None:
        """Open a new results file and print the machine's description."""
        RESULTS.mkdir(exist_ok=True)
        self.path = RESULTS / time.strftime("%Y%m%d-%H%M%S.jsonl")
        self.missed: list[str] = []
        self.faults: list[str] = []
        self.machine = describe()
        self._disturbance = Disturbance()
        self.record("machine", text=self.machine)
        print(f"Machine: {self.machine}.")

    def record(self, kind: str, **facts: Any) -> None:
        """Append one line to the results file."""
        with self.path.open("a") as results:
            results.write(json.dumps({"kind": kind, "time": time.time(), **facts}) + "\n")

    def table(self, title: str, header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        """Print a Markdown table."""
        print(f"\n**{title}**\n")
        print(f"| {' | '.join(header)} |")
        print(f"|{' --- |' * len(header)}")
        for row in rows:
            print(f"| {' | '.join(row)} |", flush=True)

    def check(
        self, server: str, what: str, value: float, limit: float | None, unit: str = ""
    ) -> str:
        """Return the verdict on a hub's value; references have no limits."""
        if server not in HUBS or limit is None:
            return ""
        if value <= limit:
            return f"≤ {limit:g}{unit} ✓"
        self.missed.append(f"{server}, {what}: {value:.3g}{unit}, limit {limit:g}{unit}")
        return f"≤ {limit:g}{unit} ✗"

    def fault(self, server: str, what: str, text: str) -> None:
        """Record a fault of a hub (loss, duplicates, disorder); only print that of a reference."""
        if not text:
            return
        self.record("fault", server=server, what=what, text=text)
        if server in HUBS:
            self.faults.append(f"{server}, {what}: {text}")
        else:
            print(f"note: {server}, {what}: {text}", file=sys.stderr)

    def close(self, report_only: bool) -> int:
        """Print missed limits and faults, and return the exit status."""
        others = self._disturbance.percent()
        print(f"\nOther processes used {others:.0f} % of the CPUs.")
        for each in self.missed:
            print(f"missed: {each}")
        for each in self.faults:
            print(f"fault: {each}")
        print(f"Raw results: {self.path.relative_to(RESULTS.parents[1])}")
        self.record("verdict", others_percent=others, missed=self.missed, faults=self.faults)
        return 1 if self.faults or (self.missed and not report_only) else 0
