"""Running a program of nodes until it ends, or until Ctrl-C or SIGTERM."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Coroutine
from typing import Any, TypeVar

from fibws.errors import AccessDenied, HubUnreachable, NodeKilled, NodeReplaced
from fibws.exit_signals import ExitSignals

T = TypeVar("T")


def run(main: Coroutine[Any, Any, T]) -> T | None:
    """Run a program of nodes: ``fibws.run(main())`` in place of ``asyncio.run(main())``.

    Ctrl-C and SIGTERM are the normal end of a node, as with rospy: they cancel ``main``, so that
    each ``async with fibws.Node(...)`` block leaves the graph, and the exit code is 0. A signal
    more than a second later ends the process at once; earlier ones repeat the first.

    Args:
        main: the program. It may also start a `Hub`, or tasks of its own.

    Returns:
        What ``main`` returns; None if a signal ended it.

    Raises:
        SystemExit: with one line on stderr and exit code 1, if a node ended because another node
            took its name (`NodeReplaced`), because it was killed (`NodeKilled`), or because the hub
            refuses it (`HubUnreachable`); with exit code 77 if that is because of its token or its
            rights (`AccessDenied`); with exit code 0, if stdout has no reader any more, as behind
            ``| head``.
        Exception: any other error that ``main`` raises.
    """
    try:
        return run_until_signal(main)
    except AccessDenied as error:
        print(error, file=sys.stderr)
        sys.exit(error.exit_code)
    except (NodeReplaced, NodeKilled, HubUnreachable) as error:
        sys.exit(str(error))
    except BrokenPipeError:
        # Python flushes stdout again when it exits, which must not fail.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)


def run_until_signal(main: Coroutine[Any, Any, T]) -> T | None:
    """Run a coroutine as `run` does; its errors are raised as they are."""
    try:
        return asyncio.run(_until_signal(main))
    except KeyboardInterrupt:  # Where the event loop handles no signals, as on Windows.
        return None


async def _until_signal(main: Coroutine[Any, Any, T]) -> T | None:
    loop = asyncio.get_running_loop()
    task = asyncio.ensure_future(main)
    is_stopped = False

    def stop(number: int) -> None:
        nonlocal is_stopped
        is_stopped = True
        if sys.stderr is not None and sys.stderr.isatty():
            print(file=sys.stderr)  # The shell's prompt must not follow the terminal's ^C.
        signals.receive_directly()
        task.cancel()

    signals = ExitSignals(stop)
    signals.install(loop)
    try:
        return await task
    except asyncio.CancelledError:
        if not is_stopped:
            raise
        return None
    finally:
        signals.remove(loop)
