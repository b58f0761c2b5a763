"""The programs that clients meet at a hub, the hub among them."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import AsyncIterator, Sequence
from contextlib import ExitStack, asynccontextmanager
from pathlib import Path
from typing import Self

from patience import PATIENCE
from ports import reserved_port

from fibws import Node

from .casts import Program


class Hub:
    """The hub as a program, which another one on the same port can replace.

    Args:
        tokens: its file of tokens; None if everybody may enter.
    """

    def __init__(self, tokens: Path | None = None) -> None:
        self.log: list[str] = []
        self._reserved = ExitStack()
        self._port = 0
        self._options = [] if tokens is None else ["--tokens", str(tokens)]

    async def __aenter__(self) -> Self:
        self._port = self._reserved.enter_context(reserved_port())
        await self._start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._stop()
        self._reserved.close()

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self._port}"

    async def restart(self) -> None:
        await self._stop()
        await self._start()

    async def _start(self) -> None:
        self._process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "fibws.hub", "--port", str(self._port), *self._options),
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        assert self._process.stdout is not None
        greeting = (await self._process.stdout.readline()).decode()
        assert self.url in greeting, (await self._process.communicate())[1].decode()
        self._logging = asyncio.create_task(self._process.communicate())

    async def _stop(self) -> None:
        self._process.terminate()
        _, log = await self._logging
        self.log += log.decode().splitlines()


@asynccontextmanager
async def running(programs: Sequence[Program], url: str) -> AsyncIterator[None]:
    """Programs at the hub, from when all of them are ready."""
    processes = [
        await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", *program.command, "--hub", url),
            stdout=asyncio.subprocess.DEVNULL,
        )
        for program in programs
    ]
    try:
        async with Node("stage", hub=url) as node:
            for program in programs:
                await node.wait_for_service(program.service, timeout=PATIENCE)
        yield
    finally:
        for process in processes:
            if process.returncode is None:
                process.terminate()
            await process.wait()
