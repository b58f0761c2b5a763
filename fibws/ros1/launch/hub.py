"""The hub of a launch that found none."""

from __future__ import annotations

import asyncio
import os
import re
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

from fibws.errors import HubError
from fibws.ros1.launch.command import Start
from fibws.ros1.launch.log import Log
from fibws.ros1.launch.process import Ask, Process
from fibws.ros1.launch.runner import Job

NAME = "hub"
PATIENCE = 30.0
"""Seconds in which a hub must be there."""
_LISTENS = re.compile(r"The hub listens at (ws://\S+?);")


async def start_hub(host: str, port: int, folder: Path) -> tuple[Job, str]:
    """Start a hub, and wait until it is there.

    Args:
        host: the address to listen on.
        port: its port; 0 for a free one.
        folder: for what it logs.

    Returns:
        It, to be watched, and its URL.

    Raises:
        HubError: it cannot start.
    """
    log = Log(folder / f"{NAME}.log")
    listens: asyncio.Future[str] = asyncio.get_running_loop().create_future()
    said: list[str] = []

    def hear(line: str, is_error: bool) -> None:
        with suppress(OSError):  # A hub can do without.
            log.write(line)
        if (found := _LISTENS.match(line)) and not listens.done():
            listens.set_result(found[1])
        elif not listens.done():
            said.append(line)

    command = [sys.executable, "-P", "-m", "fibws.hub", "--host", host, "--port", str(port)]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    process = Process(NAME, Start(command, environment, Path.cwd()), hear)
    await process.begin()
    end = asyncio.create_task(process.end())
    try:
        first: list[asyncio.Future[Any]] = [listens, end]
        await asyncio.wait(first, timeout=PATIENCE, return_when=asyncio.FIRST_COMPLETED)
        if not listens.done():
            why = said[-1].partition(": ")[2] if said else "it says nothing"
            raise HubError(f"no hub can be started: {why.rstrip('.')}")
    finally:
        end.cancel()
        if not listens.done():
            process.ask(Ask.KILL)
            log.close()
    return Job(process, log, required=True, is_core=True), listens.result()
