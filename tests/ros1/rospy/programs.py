"""Programs that use rospy, each a process of its own, on a hub of the test's."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from textwrap import dedent

from fibws.hub import Hub, Settings

PATIENCE = 60
PYTHONPATH = Path(__file__).parents[3] / "fibws" / "ros1" / "python"


class Program:
    """One that runs."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self._lines: list[str] = []
        self.complaints = ""
        """What it has written on standard error, once it has ended well."""

    async def says(self) -> str:
        """The next line that it prints."""
        assert self._process.stdout is not None
        async with asyncio.timeout(PATIENCE):
            line = (await self._process.stdout.readline()).decode().rstrip("\n")
        self._lines.append(line)
        assert line or not self._process.stdout.at_eof(), await self._last_words()
        return line

    def interrupt(self) -> None:
        """Ctrl-C."""
        self._process.send_signal(signal.SIGINT)

    async def ends(self) -> list[str]:
        """What it prints until its end, which is a good one."""
        async with asyncio.timeout(PATIENCE):
            out, err = await self._process.communicate()
        assert self._process.returncode == 0, (self._lines, out.decode(), err.decode())
        self.complaints = err.decode()
        return out.decode().splitlines()

    async def complains(self) -> str:
        """What it writes on standard error until its end."""
        async with asyncio.timeout(PATIENCE):
            _, err = await self._process.communicate()
        return err.decode()

    async def end(self) -> None:
        """End it, whatever it does."""
        if self._process.returncode is None:
            self._process.kill()
            await self._process.communicate()

    async def _last_words(self) -> str:
        assert self._process.stderr is not None
        return f"it said {self._lines} and {(await self._process.stderr.read()).decode()}"


class World:
    """A hub, and whom it serves."""

    def __init__(self, hub: Hub) -> None:
        self.hub = hub
        self._programs: list[Program] = []

    async def start(self, text: str, *arguments: str) -> Program:
        """Start a program of this text."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-c",
            f"from fibws.ros1 import finder; finder.install()\n{dedent(text)}",
            *arguments,
            env={
                **kept,
                "FIBWS_HUB": self.hub.url,
                "PYTHONPATH": str(PYTHONPATH),
                "PYTHONUNBUFFERED": "1",
            },
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        self._programs.append(Program(process))
        return self._programs[-1]

    async def run(self, text: str, *arguments: str) -> list[str]:
        """What a program of this text prints."""
        return await (await self.start(text, *arguments)).ends()

    async def end(self) -> None:
        """End all programs that still run."""
        for program in self._programs:
            await program.end()


@asynccontextmanager
async def world() -> AsyncIterator[World]:
    """A hub on a free port; what still runs at the end is ended."""
    async with Hub(Settings(port=0, close_timeout=0.1)) as hub:
        found = World(hub)
        try:
            yield found
        finally:
            await found.end()
