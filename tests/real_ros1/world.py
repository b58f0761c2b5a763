"""A hub that is the master of ROS 1 nodes, and programs of an installed ROS that join it."""

from __future__ import annotations

import asyncio
import json
import os
import re
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Self

from patience import PATIENCE
from ports import reserved_port

NEEDED = [
    *("/usr/bin/rosbag", "/usr/bin/roslaunch", "/usr/bin/rosrun", "/usr/bin/rostopic"),
    *("/usr/lib/topic_tools/relay", "/usr/lib/tf2_ros/static_transform_publisher"),
    "/usr/lib/robot_state_publisher/robot_state_publisher",
]


def missing_programs() -> str | None:
    """Return which programs are not installed; None if all are."""
    missing = [path for path in NEEDED if not Path(path).exists()]
    return f"{', '.join(missing)} not found: install the packages in .ci/run" if missing else None


class Program:
    """A running program that reads and prints lines.

    Attributes:
        lines: what it has printed on standard output.
        log: what it has printed on standard error.
    """

    def __init__(self, name: str, process: asyncio.subprocess.Process) -> None:
        self.name = name
        self.process = process
        self.lines: list[str] = []
        self.log: list[str] = []
        self._changed = asyncio.Condition()
        assert process.stdout is not None
        assert process.stderr is not None
        self._reading = [
            asyncio.create_task(self._read(process.stdout, self.lines)),
            asyncio.create_task(self._read(process.stderr, self.log)),
        ]

    @classmethod
    async def start(cls, name: str, *command: str, **environment: str) -> Self:
        """Start a program with an environment of these variables alone."""
        process = await asyncio.create_subprocess_exec(
            *command,
            env={"PYTHONUNBUFFERED": "1", "LANG": "C.UTF-8", **environment},
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            limit=2**20,
        )
        return cls(name, process)

    async def found(self, pattern: str) -> re.Match[str]:
        """Wait for text of standard output or error, and return the match."""
        expression = re.compile(pattern)

        def search() -> re.Match[str] | None:
            return expression.search("\n".join([*self.lines, *self.log]))

        await self.until(lambda: search() is not None, pattern)
        found = search()
        assert found is not None
        return found

    async def until(self, holds: Callable[[], bool], what: str) -> None:
        """Wait until a condition on the lines holds."""
        try:
            async with asyncio.timeout(PATIENCE), self._changed:
                await self._changed.wait_for(
                    lambda: holds() or all(task.done() for task in self._reading)
                )
        except TimeoutError:
            raise AssertionError(f"{self.name}: waited for {what!r}\n{self._text()}") from None
        assert holds(), f"{self.name} has ended before {what!r}\n{self._text()}"

    def kill(self) -> None:
        """Kill it by SIGKILL."""
        if self.process.returncode is None:
            self.process.kill()

    async def ended(self) -> int:
        """Wait for its end; return its exit code."""
        try:
            async with asyncio.timeout(PATIENCE):
                await asyncio.gather(*self._reading)
                return await self.process.wait()
        except TimeoutError:
            raise AssertionError(f"{self.name} did not end\n{self._text()}") from None

    def _text(self) -> str:
        return "\n".join([*self.lines[-20:], "on standard error:", *self.log[-20:]])

    async def _read(self, stream: asyncio.StreamReader, lines: list[str]) -> None:
        try:
            while line := await stream.readline():
                async with self._changed:
                    lines.append(line.decode(errors="replace").rstrip("\n"))
                    self._changed.notify_all()
        finally:
            async with self._changed:
                self._changed.notify_all()


class World:
    """A hub with its ROS 1 master, in a process of its own, and programs that join it.

    Attributes:
        url: the hub's address.
        master: ROS_MASTER_URI.
    """

    def __init__(self, folder: Path, port: int, master_port: int) -> None:
        self.folder = folder
        self.url = ""
        self.master = ""
        self.hub: Program
        self._programs: list[Program] = []
        self._ports = (str(port), str(master_port))

    async def start_hub(self) -> None:
        """Start a hub, on the same ports as the one before."""
        port, master_port = self._ports
        self.hub = await self._start(
            "hub",
            *(sys.executable, "-m", "fibws.hub", "--port", port, "--ros1", master_port),
            *("--ros1-state", str(self.folder / "state.json")),
            **_coverage(),
        )
        found = await self.hub.found(r"listens at (ws://[^;]+:\d+);[^$]*=(http://[^/]+:\d+/?)")
        self.url, self.master = found.groups()

    async def saved(self, nodes: set[str]) -> None:
        """Wait until the hub has written these nodes, and no others, to its state file."""
        file = self.folder / "state.json"

        async def are_saved() -> bool:
            return (
                file.exists()
                and {each["name"] for each in json.loads(file.read_bytes())["nodes"]} == nodes
            )

        await until(are_saved)

    async def program(self, *command: str, **environment: str) -> Program:
        """Start a program in the environment of an installed ROS."""
        name = Path(command[0]).name
        return await self._start(name, *command, **self.ros_environment(), **environment)

    async def output(self, command: str, *arguments: str, given: str = "") -> str:
        """Run a command of ROS to its end; return its standard output."""
        program = await self.program(f"/usr/bin/{command}", *arguments)
        assert program.process.stdin is not None
        program.process.stdin.write(given.encode())
        program.process.stdin.close()
        code = await program.ended()
        text = "".join(f"{line}\n" for line in program.lines)
        assert code == 0, f"{command} {arguments}: {text}{program.log}"
        return text

    def ros_environment(self) -> dict[str, str]:
        """Return the environment of an installed ROS."""
        return {
            "PATH": "/usr/bin:/bin",
            "HOME": str(self.folder),
            "ROS_HOME": str(self.folder / "ros"),
            "ROS_MASTER_URI": self.master,
            "ROS_IP": "127.0.0.1",
            "ROS_PACKAGE_PATH": "/usr/share",
        }

    async def our(self, name: str, *arguments: str, **environment: str) -> Program:
        """Start a Python program in the environment of fibws."""
        return await self._start(
            name,
            *(sys.executable, *arguments),
            FIBWS_HUB=self.url,
            HOME=str(self.folder),
            **_coverage(),
            **environment,
        )

    async def _start(self, name: str, *command: str, **environment: str) -> Program:
        program = await Program.start(name, *command, **environment)
        self._programs.append(program)
        return program

    def kill(self) -> None:
        """Kill all programs that still run."""
        for program in self._programs:
            program.kill()


async def until(holds: Callable[[], Awaitable[bool]]) -> None:
    """Wait until something holds that another process does, and does not report."""
    async with asyncio.timeout(PATIENCE):
        while True:
            if await holds():
                return
            await asyncio.sleep(0.02)


def _coverage() -> dict[str, str]:
    """Return the variables with which the tests' processes find fibws and are measured."""
    kept = ("PATH", "PYTHONPATH", "COVERAGE_PROCESS_START", "COVERAGE_PROCESS_CONFIG")
    return {name: os.environ[name] for name in kept if name in os.environ}


@asynccontextmanager
async def world(folder: Path) -> AsyncIterator[World]:
    """A hub to which programs can be started; they end with it."""
    with reserved_port() as port, reserved_port() as master_port:
        world = World(folder, port, master_port)
        try:
            await world.start_hub()
            yield world
        finally:
            print(*world.hub.log, sep="\n")  # pytest shows it if the test has failed.
            world.kill()
            for program in world._programs:
                await program.ended()
