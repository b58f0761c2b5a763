"""Plays rospy scripts under fibws, and compares them with what they did under a real ROS."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from difflib import unified_diff
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple, TypeAlias

import fork_server
import pytest
from recorded_answers import Answers
from ros_masters import PYTHON, roscore

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer

PATIENCE = 120
IDLE = 0.03
"""Seconds to wait before Ctrl-C under the real rospy, which deadlocks if it comes in `publish`."""
TRIES = 5
"""How often a scenario is played to record it: the threads of the real rospy overtake each other,
lose what a queue of one had, and deadlock."""
AT_RANDOM = re.compile(
    r"Got a transition callback on a goal handle that we're not tracking$"
    r"|Received comm state PREEMPTING when in simple state DONE with SimpleActionClient in NS "
    r"|TCPServer\[\d+\] shutting down$"
)
"""What the real ROS logs at random, depending on which of its threads is faster."""
SCRIPTS = Path(__file__).parent / "scripts"
GENERATORS = Path("/usr/lib/genpy")
DEFINITIONS = Path(fibws.__file__).parent / "interfaces" / "definitions"


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
    """One of the two: how it starts a script, and what it has it know.

    Args:
        start: starts a script; else as `asyncio.create_subprocess_exec`.
        environment: the environment variables of all scripts.
        idle: seconds to wait before Ctrl-C.
    """

    def __init__(
        self,
        start: Callable[..., Awaitable[asyncio.subprocess.Process]],
        environment: dict[str, str],
        *,
        idle: float = 0,
    ) -> None:
        self._start_program = start
        self._environment = environment
        self._idle = idle

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
                    if self._idle:
                        await asyncio.sleep(self._idle)
                    program.interrupt()
                    await program.ended()
            return [program.outcome(part) for part, program in zip(parts, running, strict=True)]
        finally:
            for program in running:
                program.kill()

    async def _start(self, part: Part) -> _Program:
        process = await self._start_program(
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


async def compare(answers: Answers, ros: RealRos, *parts: Part) -> None:
    """Play a scenario under fibws; each program must say what it said under the real ROS.

    Raises:
        AssertionError: one did not.
    """

    async def ask() -> list[Outcome]:
        for left in reversed(range(TRIES)):
            try:
                return await ros().play(*parts)
            except Stuck:
                if not left:
                    raise
        raise AssertionError

    recorded = await answers.once("outcomes", ask, TRIES)
    async with our_ros() as ours:
        found = await ours.play(*parts)
    differences = [
        "\n".join(
            unified_diff(
                Outcome(*expected).lines(),
                outcome.lines(),
                f"{part.script} in ROS",
                f"{part.script} here",
                lineterm="",
            )
        )
        for part, expected, outcome in zip(parts, recorded, found, strict=True)
    ]
    assert not any(differences), "\n".join(differences)


RealRos: TypeAlias = Callable[[], World]
"""Gives the real ROS, which runs from then on."""


@pytest.fixture(scope="module")
def ros(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RealRos]:
    """A roscore, started when it is first needed, which it is for recording only."""
    with ExitStack() as stack:

        @cache
        def started() -> World:
            return stack.enter_context(real_ros(tmp_path_factory.mktemp("ros")))

        yield started


@contextmanager
def real_ros(folder: Path) -> Iterator[World]:
    """A roscore, and the messages of packages that Debian has not."""
    _generate(folder, "rospy_tutorials", "std_srvs", "trajectory_msgs", "turtlesim")
    with roscore(folder) as environment:
        yield World(partial(asyncio.create_subprocess_exec, PYTHON), environment, idle=IDLE)


@asynccontextmanager
async def our_ros() -> AsyncIterator[World]:
    """A hub on a free port."""
    async with HubServer(Settings(port=0, close_timeout=0.1)) as hub:
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
        environment = {**kept, "FIBWS_HUB": hub.url, "LANG": "C.UTF-8"}
        yield World(partial(fork_server.start, "-m", "fibws.rospy"), environment)


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
            subprocess.run(
                [*generator, "-p", package, "-o", str(output), *search, *map(str, files)],
                check=True,
                capture_output=True,
            )
            subprocess.run(
                [*generator, "--initpy", "-p", package, "-o", str(output)],
                check=True,
                capture_output=True,
            )
