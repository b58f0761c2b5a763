"""How a program runs: until it is done, or until somebody has had enough of it."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import Coroutine
from contextlib import suppress
from typing import Any

import click

import fibws


def run(program: Coroutine[Any, Any, None]) -> None:
    """Run ``program``; Ctrl-C, SIGTERM and a reader who leaves (``| head``) end it cleanly.

    Raises:
        ClickException: a node or a hub cannot go on; click prints why and exits with 1.
    """
    try:
        asyncio.run(_until_told(program))
    except KeyboardInterrupt:
        pass  # On Windows, where an event loop handles no signals.
    except BrokenPipeError:
        # Python flushes standard output once more when it exits, and must not fail at that.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except fibws.FibwsError as error:
        raise click.ClickException(str(error)) from None


async def _until_told(program: Coroutine[Any, Any, None]) -> None:
    task = asyncio.ensure_future(program)

    def stop() -> None:
        if sys.stderr.isatty():
            click.echo(err=True)  # The shell's prompt must not stand behind the terminal's ^C.
        task.cancel()

    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError):
            asyncio.get_running_loop().add_signal_handler(number, stop)
    with suppress(asyncio.CancelledError):
        await task
