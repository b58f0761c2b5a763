"""How a program runs: until it is done, or until somebody has had enough of it."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Coroutine
from contextlib import suppress
from typing import Any

from fibws.cli.ending import end_line, ending


def run(program: Coroutine[Any, Any, None]) -> None:
    """Run ``program``; Ctrl-C, SIGTERM and a reader who leaves (``| head``) end it cleanly.

    Raises:
        ClickException: a node or a hub cannot go on; click prints why and exits with 1.
    """
    with ending(endless=True):
        asyncio.run(_until_told(program))


async def _until_told(program: Coroutine[Any, Any, None]) -> None:
    task = asyncio.ensure_future(program)

    def stop() -> None:
        end_line()
        task.cancel()

    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError):  # On Windows, where an event loop handles no signals.
            asyncio.get_running_loop().add_signal_handler(number, stop)
    with suppress(asyncio.CancelledError):
        await task
