"""The hub of a launch that found none."""

from __future__ import annotations

import asyncio
import os
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fibws.errors import HubError
from fibws.ros1.launch.command import Start
from fibws.ros1.launch.log import Log
from fibws.ros1.launch.process import Ask, Process
from fibws.ros1.launch.runner import Job

NAME = "hub"
START_TIMEOUT = 30.0
"""Seconds in which a hub must be ready."""
POLL_INTERVAL = 0.02
"""Seconds between two looks at a hub's URL file."""


async def start_hub(host: str, port: int, folder: Path) -> tuple[Job, str]:
    """Start a hub, and wait until nodes can connect to it.

    Args:
        host: the address to listen on.
        port: its port; 0 for a free one.
        folder: the folder for its log.

    Returns:
        Its job and its URL.

    Raises:
        HubError: it cannot start.
    """
    log = Log(folder / f"{NAME}.log")
    lines: list[str] = []

    def receive(line: str, is_error: bool) -> None:
        with suppress(OSError):  # A hub does not need its log.
            log.write(line)
        lines[:] = [line]

    with TemporaryDirectory(prefix="fibws-", ignore_cleanup_errors=True) as temporary:
        url_file = Path(temporary) / "url"
        command = [
            *(sys.executable, "-P", "-m", "fibws.hub", "--host", host, "--port", str(port)),
            *("--url-file", str(url_file)),
        ]
        environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
        process = Process(NAME, Start(command, environment, Path.cwd()), receive)
        await process.begin()
        url = asyncio.create_task(_read_url(url_file))
        waits: list[asyncio.Task[Any]] = [url, asyncio.create_task(process.end())]
        try:
            await asyncio.wait(waits, timeout=START_TIMEOUT, return_when=asyncio.FIRST_COMPLETED)
            if not url.done():
                raise HubError(f"cannot start a hub: {''.join(lines) or 'it does not respond'}")
        finally:
            for each in waits:
                each.cancel()
            if not url.done():
                process.ask(Ask.KILL)
                log.close()
    return Job(process, log, required=True, is_core=True), url.result()


async def _read_url(file: Path) -> str:
    """Return the URL in a hub's URL file as soon as the file exists."""
    while True:
        if url := _url_in(file):
            return url
        await asyncio.sleep(POLL_INTERVAL)


def _url_in(file: Path) -> str:
    try:
        return file.read_text().strip()
    except FileNotFoundError:
        return ""
