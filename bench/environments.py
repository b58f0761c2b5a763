"""Environments of scripts (a real ROS, or the hub) and one run of a publisher and subscribers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Self

from bench.machine import cpu_seconds, free_port
from bench.measure import HUB, BenchError, Plan
from bench.servers import ROOT, Server, running

SCRIPTS = Path(__file__).parent / "scripts"
MODULES = ROOT / "fibws" / "ros1" / "python"
ROSCORE, ROS_PYTHON = Path("/usr/bin/roscore"), "/usr/bin/python3"
"""Debian's."""
ROS = "ros"
REAL_ROSPY = "real rospy"
RUN_SCRIPT = """
import os, runpy, sys
del sys.argv[0]
sys.path[0] = os.path.dirname(sys.argv[0])
runpy.run_path(sys.argv[0], run_name="__main__")
"""
TIMEOUT_SECONDS = 60.0
STOP_SECONDS = 5.0
FEWEST_MESSAGES = 5


@dataclass(frozen=True)
class Traffic:
    """A type of message, its size, its rate and the number of subscribers."""

    type: str
    size: int
    """Bytes of a string, an image or a point cloud; ranges of a scan; transforms."""
    hz: float
    subscribers: int = 1

    def count(self, seconds: float) -> int:
        """Return the number of messages in a time."""
        return max(FEWEST_MESSAGES, round(self.hz * seconds))


class Run(NamedTuple):
    """The result of one publisher and its subscribers."""

    took: list[float]
    """Microseconds from publish to callback, of the messages of all subscribers."""
    seconds: float
    """The seconds in which the publisher sent its messages."""
    hz: float
    cpu_us: float
    """CPU time of the publisher, the hub and the subscribers per message."""
    hub_cpu_us: float
    fault: str


@dataclass(frozen=True)
class Environment:
    """An interpreter and environment variables for scripts, and their hub or ROS master."""

    title: str
    name: str
    """The server's name in a report: the hub or the real ROS."""
    python: str
    publisher: str
    subscriber: str
    variables: dict[str, str]
    hub: Server | None = None
    prelude: str = ""
    """Python code that each script runs first."""

    def run(self, traffic: Traffic, plan: Plan) -> Run:
        """Publish for the planned time and return the result."""
        warm, count = traffic.count(plan.warm_seconds), traffic.count(plan.seconds)
        common = (traffic.type, str(traffic.size))
        numbers = (f"{traffic.hz:g}", str(warm), str(count), str(traffic.subscribers))
        with ExitStack() as stack:
            subscribers = [
                stack.enter_context(self.script(self.subscriber, *common, str(warm), str(count)))
                for _ in range(traffic.subscribers)
            ]
            for subscriber in subscribers:
                subscriber.line()
            publisher = stack.enter_context(self.script(self.publisher, *common, *numbers))
            scripts = [publisher, *subscribers]
            publisher.line()
            cpu, hub_cpu = self._cpu(scripts)
            seconds = float(publisher.line())
            reports = [json.loads(subscriber.line()) for subscriber in subscribers]
            cpu_after, hub_cpu_after = self._cpu(scripts)
            for script in scripts:  # All at once; leaving the block waits for each.
                script.terminate()
        return Run(
            took=[each for report in reports for each in report["took_us"]],
            seconds=seconds,
            hz=count / seconds,
            cpu_us=(cpu_after - cpu) / count * 1e6,
            hub_cpu_us=(hub_cpu_after - hub_cpu) / count * 1e6,
            fault=", ".join(filter(None, (_fault(each, warm + count) for each in reports))),
        )

    def script(self, name: str, *arguments: str) -> Script:
        """Start a script."""
        return Script(self, name, *arguments)

    def _cpu(self, scripts: Sequence[Script]) -> tuple[float, float]:
        """Return the CPU seconds used so far by the scripts and the hub, and by the hub alone."""
        hub = self.hub.cpu_seconds if self.hub else 0.0
        return hub + sum(cpu_seconds(script.pid) for script in scripts), hub


class Script:
    """A running script, stopped when its `with` block ends."""

    def __init__(self, environment: Environment, name: str, *arguments: str) -> None:
        """Start it."""
        self._name = f"{environment.title}: {name}"
        script = [str(SCRIPTS / name)]
        if environment.prelude:
            script = ["-c", f"{environment.prelude}\n{RUN_SCRIPT}", *script]
        self._process = subprocess.Popen(
            [environment.python, *script, *arguments],
            env=environment.variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
        )

    @property
    def pid(self) -> int:
        """Return the process's id."""
        return self._process.pid

    def line(self) -> str:
        """Wait for the next line that the script prints, and return it."""
        assert self._process.stdout is not None
        watchdog = threading.Timer(TIMEOUT_SECONDS, self._process.kill)
        watchdog.start()
        try:
            line = self._process.stdout.readline()
        finally:
            watchdog.cancel()
        if not line:
            raise BenchError(f"{self._name} exited, or printed nothing for {TIMEOUT_SECONDS:g} s")
        return line

    def terminate(self) -> None:
        """Ask the script to stop."""
        self._process.terminate()

    def __enter__(self) -> Self:
        """Do nothing; the script runs."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Stop the script."""
        self.terminate()
        try:
            self._process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._process.communicate()


def _fault(report: dict[str, int], expected: int) -> str:
    found = []
    if report["received"] != expected:
        found.append(f"lost {expected - report['received']} of {expected}")
    if report["disorder"]:
        found.append(f"{report['disorder']} out of order")
    if report["wrong"]:
        found.append("the content of the last message has changed")
    return ", ".join(found)


@contextmanager
def on_hub(*options: str) -> Iterator[tuple[Environment, Environment]]:
    """Start a hub; yield the environments of rospy scripts and of fibws.Node scripts on it.

    Args:
        options: further options of the hub's command line.
    """
    with running(HUB, pinned=False, options=options) as server:
        variables = {
            **{name: value for name, value in os.environ.items() if not name.startswith("ROS")},
            "FIBWS_HUB": f"ws://127.0.0.1:{server.port}",
            "PYTHONPATH": f"{MODULES}:{ROOT}",
        }
        rospy = Environment(
            "rospy on the hub",
            HUB,
            sys.executable,
            "publisher.py",
            "subscriber.py",
            variables,
            server,
        )
        node = Environment(
            "fibws.Node",
            HUB,
            sys.executable,
            "node_publisher.py",
            "node_subscriber.py",
            {**variables, "PYTHONPATH": str(ROOT)},
            server,
        )
        yield rospy, node


@contextmanager
def real_ros() -> Iterator[Environment | None]:
    """Start a real roscore; yield the environment of rospy scripts, or None without a ROS."""
    if not ROSCORE.exists():
        print(f"note: {ROSCORE} not found; no comparison with a real ROS", file=sys.stderr)
        yield None
        return
    with tempfile.TemporaryDirectory() as home:
        port = free_port()
        variables = {
            "PATH": "/usr/bin:/bin",
            "HOME": home,
            "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
            "ROS_IP": "127.0.0.1",
            "PYTHONUNBUFFERED": "1",
        }
        master = subprocess.Popen(
            [str(ROSCORE), "-p", str(port)],
            env=variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            assert master.stdout is not None
            if not any("started core service [/rosout]" in line for line in master.stdout):
                raise BenchError("roscore did not start")
            yield Environment(
                REAL_ROSPY, ROS, ROS_PYTHON, "publisher.py", "subscriber.py", variables
            )
        finally:
            master.terminate()
            master.communicate()
