"""Programs as a person starts them, and the hub that they meet at."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Self, TypeAlias

import fork_server
import pytest
from patience import PATIENCE

from fibws.hub import Settings
from fibws.hub.server import HubServer

ROOT = Path(__file__).parents[1]


class Program:
    """A running ``python -m`` program and its two pipes."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self.pid = process.pid

    @classmethod
    async def start(cls, *arguments: str, **environment: str) -> Self:
        variables = {name: value for name, value in os.environ.items() if "FIBWS" not in name}
        process = await fork_server.start(
            *("-W", "error", "-m"),
            *arguments,
            stdin=asyncio.subprocess.DEVNULL,
            cwd=ROOT,
            env={**variables, **environment},
        )
        return cls(process)

    async def line(self) -> str:
        """The next line of standard output."""
        assert self._process.stdout is not None
        async with asyncio.timeout(PATIENCE):
            return (await self._process.stdout.readline()).decode()

    async def error_line(self) -> str:
        """The next line of standard error."""
        assert self._process.stderr is not None
        async with asyncio.timeout(PATIENCE):
            return (await self._process.stderr.readline()).decode()

    def stop_reading(self) -> None:
        """Close the reading end of standard output, as ``head`` does."""
        transport = self._process._transport.get_pipe_transport(1)  # type: ignore[attr-defined]
        transport.close()

    def send(self, number: signal.Signals) -> None:
        self._process.send_signal(number)

    async def end(self) -> tuple[int, str, str]:
        """Wait for the end: exit code, the rest of standard output, that of standard error."""
        async with asyncio.timeout(PATIENCE):
            out, err = await self._process.communicate()
        assert self._process.returncode is not None
        return self._process.returncode, out.decode(), err.decode()

    async def stop(self) -> None:
        """End it if it still runs, in good order so that its coverage is counted."""
        if self._process.returncode is None:
            self._process.terminate()
            await self.end()


Start: TypeAlias = Callable[..., Awaitable[Program]]


@pytest.fixture
async def start() -> AsyncIterator[Start]:
    """Starts programs, and sees to it that none is left over."""
    programs: list[Program] = []

    async def start(*arguments: str, **environment: str) -> Program:
        program = await Program.start(*arguments, **environment)
        programs.append(program)
        return program

    yield start
    for program in programs:
        await program.stop()


@pytest.fixture
async def hub() -> AsyncIterator[HubServer]:
    async with HubServer(Settings(port=0, close_timeout=0.1)) as hub:
        yield hub
