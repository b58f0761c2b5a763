"""Running a program of nodes until it ends, or until a signal ends it."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Coroutine, Iterable
from pathlib import Path
from types import FrameType
from typing import Any, TypeVar

from fibws.errors import AccessDenied, HubUnreachable, NodeKilled, NodeReplaced
from fibws.exit_signals import ExitSignals

T = TypeVar("T")

NO_PERMISSION = 77
"""The exit code after a refusal by the hub: EX_NOPERM of sysexits.h."""
PATIENCE = 5.0
"""Seconds in which a program's other tasks must end when it does."""
MOST_NAMED = 5
"""Tasks that do not end, and are named one by one."""


def run(main: Coroutine[Any, Any, T]) -> T | None:
    """Run a program of nodes: ``fibws.run(main())`` in place of ``asyncio.run(main())``.

    Ctrl-C and SIGTERM are the normal end of a node, as with rospy: they cancel ``main``, so that
    each ``async with fibws.Node(...)`` block leaves the graph, and the exit code is 0. So does
    SIGHUP, when the terminal is closed, unless it is ignored, as under ``nohup``. A signal
    more than a second later ends the process at once; earlier ones repeat the first.

    Tasks that are left when ``main`` ends, such as handlers, are cancelled. One that goes on all
    the same, as it swallows ``asyncio.CancelledError``, is named on stderr after 5 seconds, with
    the line that it waits in, and the program ends without it. ``main`` itself has as much time as
    it wants; after a signal, what it waits for is named likewise.

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
        TypeError: ``main`` is not a coroutine, such as when its parentheses are missing.
        RuntimeError: an event loop is running already; there, write ``await main()``.
        Exception: any other error that ``main`` raises.
    """
    try:
        return run_until_signal(main)
    except AccessDenied as error:
        print(error, file=sys.stderr)
        sys.exit(NO_PERMISSION)
    except (NodeReplaced, NodeKilled, HubUnreachable) as error:
        sys.exit(str(error))
    except BrokenPipeError:
        # Python flushes stdout again when it exits, which must not fail.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)


def run_until_signal(main: Coroutine[Any, Any, T]) -> T | None:
    """Run a coroutine as `run` does; its errors are raised as they are."""
    _check_can_run(main)
    try:
        return asyncio.run(_until_signal(main))
    except KeyboardInterrupt:  # Where the event loop handles no signals, as on Windows.
        return None


def _check_can_run(main: object) -> None:
    """Raise an error that says what to write, where asyncio's own would not.

    Raises:
        TypeError: it is not a coroutine.
        RuntimeError: an event loop is running in this thread.
    """
    name = getattr(main, "__qualname__", "main").rpartition("<locals>.")[2]
    call = f"{name}()" if "." not in name else "..."  # Of a method the object is not known.
    if not isinstance(main, Coroutine):
        called = f": write fibws.run({call}), with parentheses" if callable(main) else ""
        raise TypeError(f"fibws.run takes a coroutine, got {main!r}{called}")
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return
    main.close()  # Python would warn that it was never awaited.
    raise RuntimeError(
        f"an event loop is running, as in a notebook: write await {call} in place of "
        f"fibws.run({call})"
    )


async def _until_signal(main: Coroutine[Any, Any, T]) -> T | None:
    loop = asyncio.get_running_loop()
    task, runner = asyncio.ensure_future(main), asyncio.current_task()
    is_stopped = False

    def stop(number: int) -> None:
        nonlocal is_stopped
        is_stopped = True
        if sys.stderr is not None and sys.stderr.isatty():
            print(file=sys.stderr)  # The shell's prompt must not follow the terminal's ^C.
        signals.receive_directly()
        task.cancel()
        hint = "is still ending; another Ctrl-C or SIGTERM ends the program at once"
        loop.call_later(PATIENCE, lambda: _name_stubborn(asyncio.all_tasks() - {runner}, hint))

    signals = ExitSignals(stop)
    signals.install(loop)
    try:
        return await task
    except asyncio.CancelledError:
        if not is_stopped:
            raise
        return None
    finally:
        await _end_others()
        signals.remove(loop)


async def _end_others() -> None:
    """Cancel the remaining tasks; tasks that do not end are left behind."""
    tasks = asyncio.all_tasks() - {asyncio.current_task()}
    if not tasks:
        return
    for task in tasks:
        task.cancel()
    _, stubborn = await asyncio.wait(tasks, timeout=PATIENCE)
    _name_stubborn(stubborn, "did not end when it was cancelled, and is left behind")
    for task in stubborn:
        # asyncio.run would wait for it without end.
        asyncio._unregister_task(task)
        task._log_destroy_pending = False  # type: ignore[attr-defined]


def _name_stubborn(tasks: Iterable[asyncio.Task[Any]], text: str) -> None:
    """Write on stderr which tasks do not end, and where they wait."""
    found = sorted(tasks, key=lambda task: task.get_name())
    if sys.stderr is None:
        return
    for task in found[:MOST_NAMED]:
        name = getattr(task.get_coro(), "__qualname__", "a task")
        print(f"{name} ({_line_of(task)}) {text}", file=sys.stderr)
    if len(found) > MOST_NAMED:
        print(f"and {len(found) - MOST_NAMED} more tasks", file=sys.stderr)


def _line_of(task: asyncio.Task[Any]) -> str:
    """Return the file and the line that a task waits in: the innermost one outside asyncio."""
    waiting: Any = task.get_coro()
    innermost = "?"
    while waiting is not None:
        frame: FrameType | None = getattr(waiting, "cr_frame", getattr(waiting, "gi_frame", None))
        if frame is not None and Path(frame.f_code.co_filename).parent != _ASYNCIO:
            innermost = f"{frame.f_code.co_filename}:{frame.f_lineno}"
        waiting = getattr(waiting, "cr_await", getattr(waiting, "gi_yieldfrom", None))
    return innermost


_ASYNCIO = Path(asyncio.__file__).parent
