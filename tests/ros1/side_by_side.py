"""Plays the same rospy scripts under a real ROS and under fibws."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from difflib import unified_diff
from pathlib import Path
from typing import NamedTuple

from running_programs import free_port

import fibws
from fibws.hub import Hub, Settings

PATIENCE = 120
IDLE = 0.03
"""Seconds after which a program that has just said something waits for its next turn."""
TRIES = 2
"""On a busy machine the threads of a program, the real rospy's too, may overtake each other or lose
what a queue of one had: a difference counts if it comes each time."""
AT_RANDOM = re.compile(
    r"Got a transition callback on a goal handle that we're not tracking$"
    r"|Received comm state PREEMPTING when in simple state DONE with SimpleActionClient in NS "
    r"|TCPServer\[\d+\] shutting down$"
)
"""What the real ROS logs at random, depending on which of its threads is faster."""
SCRIPTS = Path(__file__).parent / "scripts"
PYTHON = "/usr/bin/python3"
"""Debian's, which its ROS packages are installed for."""
ROSCORE = "/usr/bin/roscore"
GENERATORS = Path("/usr/lib/genpy")
DEFINITIONS = Path(fibws.__file__).parent / "interfaces" / "definitions"

MODULES = (
    "numpy, rospy, std_msgs, sensor_msgs, actionlib, message_filters, genpy, dynamic_reconfigure, "
    "tf2_ros, tf2_geometry_msgs, tf2_sensor_msgs, cv_bridge, diagnostic_updater, rosbag, "
    "interactive_markers.interactive_marker_server, roslaunch"
)


@dataclass(frozen=True)
class Part:
    """One program of a scenario."""

    script: str
    arguments: tuple[str, ...] = ()
    until: str | None = None
    """The next one is started once a line of this one's standard output holds this."""
    count: int = 1
    """How many such lines are waited for."""
    after: str | None = None
    """Only what it prints after the line that holds this counts."""
    lines: int | None = None
    """How many lines of its output count; None if all do."""
    errors: bool = True
    """Whether what it logs on standard error counts."""
    interrupted: bool = True
    """Whether Ctrl-C ends it, or it ends by itself."""
    hears: tuple[str, int] | None = None
    """None is ended before so many lines of this one's standard output hold this."""
    last: str | None = None
    """Ctrl-C comes once a line of its standard output holds this."""
    environment: dict[str, str] = field(default_factory=dict)


class Outcome(NamedTuple):
    """What a program printed, without what no two runs have in common, and its exit code."""

    out: list[str]
    err: list[str]
    code: int

    def lines(self) -> list[str]:
        return [*self.out, "on stderr:", *self.err, f"exit code {self.code}"]


class Stuck(AssertionError):
    """A program does not say what it is waited for, or does not end."""


class World:
    """One of the two: how it starts a script, and what it has it know."""

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        self._command = command
        self._environment = environment

    async def play(self, *parts: Part) -> list[Outcome]:
        """Run the programs of a scenario; each outcome is that of the part in the same place."""
        running: list[_Program] = []
        try:
            for part in parts:
                program = await self._start(part)
                running.append(program)
                if part.until is not None:
                    await program.said(part.until, part.count)
            for part, program in zip(parts, running, strict=True):
                if part.hears is not None:
                    await program.said(*part.hears)
            for part, program in zip(reversed(parts), reversed(running), strict=True):
                if not part.interrupted:
                    await program.ended()
            for part, program in zip(reversed(parts), reversed(running), strict=True):
                if part.interrupted:
                    if part.last is not None:
                        await program.said(part.last, 1)
                    # The real rospy deadlocks if it is interrupted while it publishes.
                    await asyncio.sleep(IDLE)
                    program.interrupt()
                    await program.ended()
            return [program.outcome(part) for part, program in zip(parts, running, strict=True)]
        finally:
            for program in running:
                program.kill()

    async def _start(self, part: Part) -> _Program:
        process = await asyncio.create_subprocess_exec(
            *self._command,
            str(SCRIPTS / part.script),
            *part.arguments,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            env={**self._environment, "PYTHONUNBUFFERED": "1", **part.environment},
            cwd=SCRIPTS.parent,
        )
        return _Program(part.script, process)


class _Program:
    def __init__(self, name: str, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None
        assert process.stderr is not None
        self._name = name
        self._process = process
        self._out: list[str] = []
        self._err: list[str] = []
        self._news = asyncio.Condition()
        self._reading = asyncio.gather(
            self._read(process.stdout, self._out), self._read(process.stderr, self._err)
        )

    async def said(self, text: str, count: int) -> None:
        """Wait until so many lines of standard output hold the text."""
        try:
            async with asyncio.timeout(PATIENCE), self._news:
                await self._news.wait_for(
                    lambda: sum(text in line for line in self._out) >= count or self._reading.done()
                )
        except TimeoutError:
            raise Stuck(f"{self._name} never said {text!r}: {self}") from None

    def interrupt(self) -> None:
        if self._process.returncode is None:
            self._process.send_signal(signal.SIGINT)

    async def ended(self) -> None:
        try:
            async with asyncio.timeout(PATIENCE):
                await self._process.wait()
                await self._reading
        except TimeoutError:
            raise Stuck(f"{self._name} did not end: {self}") from None

    def kill(self) -> None:
        if self._process.returncode is None:
            self._process.kill()

    def outcome(self, part: Part) -> Outcome:
        assert self._process.returncode is not None
        out = [line for line in plain(self._out) if not AT_RANDOM.search(line)]
        if part.after is not None:
            out = out[next(number for number, line in enumerate(out) if part.after in line) :]
        # Tracebacks show the insides of rospy.
        logged = [line for line in plain(self._err) if part.errors and line.startswith("[")]
        err = [line for line in logged if not AT_RANDOM.search(line)]
        return Outcome(out[: part.lines], err, self._process.returncode)

    def __str__(self) -> str:
        return "\n".join(("it said", *self._out, "and on stderr", *self._err))

    async def _read(self, stream: asyncio.StreamReader, lines: list[str]) -> None:
        while line := await stream.readline():
            async with self._news:
                lines.append(line.decode().rstrip("\n"))
                self._news.notify_all()


_DIFFERENT = [
    (re.compile(r"\[\d+\.\d+\]"), "[TIME]"),
    (re.compile(r"\b\d{10}\.\d+"), "TIME"),
    (re.compile(r"_\d+_\d{13}"), "_PID_MS"),
    (re.compile(r"0x[0-9a-f]{6,}"), "0xADDRESS"),
    (re.compile(r"\bgenpy\.Time\[\d{10,}\]"), "genpy.Time[NOW]"),
    (re.compile(r"rospy\.Time\[\d{10,}\]"), "rospy.Time[NOW]"),
    (re.compile(r'File ".*/([^/]+)", line \d+'), r'File "\1", line N'),
]


def plain(lines: list[str]) -> list[str]:
    """Lines without times, process ids, addresses and paths."""
    for pattern, stand_in in _DIFFERENT:
        lines = [pattern.sub(stand_in, line) for line in lines]
    return lines


@dataclass
class _Said:
    """What a program has said under fibws, and under the real ROS, each time that it was played."""

    found: list[Outcome] = field(default_factory=list)
    expected: list[Outcome] = field(default_factory=list)

    def agrees(self) -> bool:
        return any(outcome in self.expected for outcome in self.found)

    def diff(self, script: str) -> str:
        """Return how the last outcomes differ."""
        found, expected = self.found[-1].lines(), self.expected[-1].lines()
        return "\n".join(
            unified_diff(expected, found, f"{script} in ROS", f"{script} here", lineterm="")
        )


async def say_the_same(ros: World, *parts: Part) -> None:
    """Play a scenario in both worlds, until each program has said what it once said in the other.

    Raises:
        AssertionError: one never did.
    """
    said = [_Said() for _ in parts]
    for left in reversed(range(TRIES)):
        async with our_ros() as ours:
            try:
                plays = await asyncio.gather(ours.play(*parts), ros.play(*parts))
            except Stuck:  # The real rospy, too, loses messages and has deadlocks.
                if not left:
                    raise
                continue
        for so_far, found, expected in zip(said, *plays, strict=True):
            so_far.found.append(found)
            so_far.expected.append(expected)
        if all(each.agrees() for each in said):
            return
    differences = [
        each.diff(part.script) for part, each in zip(parts, said, strict=True) if not each.agrees()
    ]
    assert not differences, "\n".join(differences)


def missing_ros() -> str | None:
    """Why the real ROS cannot be asked, if it cannot."""
    if not Path(ROSCORE).exists() or not GENERATORS.is_dir():
        return "there is no roscore, or no genpy: see the packages in .ci/run"
    tried = subprocess.run(
        [PYTHON, "-I", "-c", f"import {MODULES}"], capture_output=True, text=True
    )
    if tried.returncode:
        return f"{PYTHON} cannot import all of {MODULES}: {tried.stderr.splitlines()[-1]}"
    return None


@contextmanager
def real_ros(folder: Path) -> Iterator[World]:
    """A roscore on a free port, and the messages of packages that Debian has not."""
    _generate(folder, "rospy_tutorials", "std_srvs", "trajectory_msgs", "turtlesim")
    port = free_port()
    environment = {
        "PATH": "/usr/bin:/bin",
        "HOME": str(folder),
        "ROS_HOME": str(folder / "ros"),
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_IP": "127.0.0.1",
        "PYTHONPATH": str(folder),
        "LANG": "C.UTF-8",
        "PYTHONUNBUFFERED": "1",
    }
    roscore = subprocess.Popen(
        [ROSCORE, "-p", str(port)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        assert roscore.stdout is not None
        for line in roscore.stdout:
            if "started core service [/rosout]" in line:
                break
        yield World([PYTHON], environment)
    finally:
        roscore.send_signal(signal.SIGINT)
        roscore.communicate(timeout=PATIENCE)


@asynccontextmanager
async def our_ros() -> AsyncIterator[World]:
    """A hub on a free port."""
    async with Hub(Settings(port=0, close_timeout=0.1)) as hub:
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
        environment = {**kept, "FIBWS_HUB": hub.url, "LANG": "C.UTF-8"}
        yield World([sys.executable, "-m", "fibws.rospy"], environment)


def _generate(folder: Path, *packages: str) -> None:
    """Have ROS's own generator write the Python modules of packages."""
    search = [f"-I{each.name}:{each / 'msg'}" for each in DEFINITIONS.iterdir() if each.is_dir()]
    for package in packages:
        (folder / package).mkdir()
        (folder / package / "__init__.py").touch()
        for kind in ("msg", "srv"):
            files = sorted((DEFINITIONS / package / kind).glob(f"*.{kind}"))
            if not files:
                continue
            output = folder / package / kind
            generator = [PYTHON, "-I", str(GENERATORS / f"gen{kind}_py.py")]
            for file in files:
                subprocess.run(
                    [*generator, "-p", package, "-o", str(output), *search, str(file)],
                    check=True,
                    capture_output=True,
                )
            subprocess.run(
                [*generator, "--initpy", "-p", package, "-o", str(output)],
                check=True,
                capture_output=True,
            )
