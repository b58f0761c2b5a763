"""Runs programs that use rospy as processes, with a hub of the test's own."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from textwrap import dedent
from typing import Any

import fork_server
from patience import PATIENCE

from fibws.hub import Settings
from fibws.hub.server import HubServer

PYTHONPATH = Path(__file__).parents[3] / "fibws" / "ros1" / "python"


class Program:
    """A running program."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self._lines: list[str] = []
        self.errors = ""
        """The text on standard error, after `finish`."""

    async def read_line(self) -> str:
        """Return the next line on standard output."""
        assert self._process.stdout is not None
        async with asyncio.timeout(PATIENCE):
            line = (await self._process.stdout.readline()).decode().rstrip("\n")
        self._lines.append(line)
        assert line or not self._process.stdout.at_eof(), await self._output()
        return line

    def interrupt(self) -> None:
        """Send SIGINT, as Ctrl-C does."""
        self._process.send_signal(signal.SIGINT)

    async def finish(self) -> list[str]:
        """Return the remaining lines on standard output; the exit code must be 0."""
        async with asyncio.timeout(PATIENCE):
            out, err = await self._process.communicate()
        assert self._process.returncode == 0, (self._lines, out.decode(), err.decode())
        self.errors = err.decode()
        return out.decode().splitlines()

    async def read_errors(self) -> str:
        """Return the text on standard error until its end."""
        async with asyncio.timeout(PATIENCE):
            _, err = await self._process.communicate()
        return err.decode()

    async def kill(self) -> None:
        """Kill the program if it still runs."""
        if self._process.returncode is None:
            self._process.kill()
            await self._process.communicate()

    async def _output(self) -> str:
        assert self._process.stderr is not None
        return f"printed {self._lines} and {(await self._process.stderr.read()).decode()}"


class Programs:
    """Programs on a hub."""

    def __init__(self, hub: HubServer) -> None:
        self.hub = hub
        self._programs: list[Program] = []

    async def start(self, text: str, *arguments: str) -> Program:
        """Start a program with this text."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
        process = await fork_server.start(
            "-c",
            f"from fibws.ros1 import finder; finder.install()\n{dedent(text)}",
            *arguments,
            env={
                **kept,
                "FIBWS_HUB": self.hub.url,
                "PYTHONPATH": str(PYTHONPATH),
                "PYTHONUNBUFFERED": "1",
            },
        )
        self._programs.append(Program(process))
        return self._programs[-1]

    async def run(self, text: str, *arguments: str) -> list[str]:
        """Run a program with this text, and return its lines on standard output."""
        return await (await self.start(text, *arguments)).finish()

    async def kill(self) -> None:
        """Kill all programs that still run."""
        for program in self._programs:
            await program.kill()


@asynccontextmanager
async def running_hub(**settings: Any) -> AsyncIterator[Programs]:
    """Run a hub on a free port; programs that still run at the end are killed.

    Args:
        settings: more settings of the hub.
    """
    async with HubServer(Settings(port=0, close_timeout=0.1, **settings)) as hub:
        programs = Programs(hub)
        try:
            yield programs
        finally:
            await programs.kill()
