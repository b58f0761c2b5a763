"""One process: its output, line by line, and its end.

Threads wait for it and read its pipes. asyncio would wait for the pipes, too, which a child of the
process may keep open after its end.
"""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Set
from contextlib import suppress
from enum import Enum, auto
from pathlib import Path
from threading import Event, Thread
from typing import IO, TypeAlias

from fibws.ros1.launch.node_command import NodeCommand

OnLine: TypeAlias = Callable[[str, bool], None]
"""Called with a printed line and whether it was on standard error."""

LONGEST_LINE = 2**16
"""Bytes; longer lines are split."""
DRAIN_TIMEOUT = 1.0
"""Seconds to read output after a process's end; a child may keep its pipes open."""


class Signal(Enum):
    """The signals to end a process, ever more urgent."""

    INTERRUPT = auto()
    TERMINATE = auto()
    KILL = auto()


class Process:
    """A process that can be started again after its end.

    Args:
        name: its name on the screen, ``talker-1``.
        command: how to start it.
        on_line: called with each line that it prints, in the event loop of its start.
        inherited: which of ``stdin``, ``stdout`` and ``stderr`` are those of this process.
            ``on_line`` does not get the lines of these; any other ``stdin`` is empty.
    """

    def __init__(
        self,
        name: str,
        command: NodeCommand,
        on_line: OnLine,
        *,
        inherited: Set[str] = frozenset(),
    ) -> None:
        self.name = name
        self.command = command
        self.exit_code: int | None = None
        """Its exit code after its end; -2 if it was ended by signal 2."""
        self.pid = 0
        """Its process ID; 0 before its first start."""
        self.inherited = inherited
        self._on_line = on_line
        self._run: _Run | None = None

    @property
    def is_running(self) -> bool:
        """Whether it was started and has not ended."""
        return self._run is not None and not self._run.ended.done()

    async def start(self) -> None:
        """Start it, or raise `OSError`."""
        self.exit_code = None
        self._run = _Run(self.command, self._on_line, self.inherited)
        self.pid = self._run.pid

    async def wait(self) -> int:
        """Wait for its end and for all its output; return its exit code."""
        assert self._run is not None
        # Cancelling this wait must not cancel the future of the process's end.
        code = await asyncio.shield(self._run.ended)
        if self._run.drained:
            await asyncio.wait(self._run.drained, timeout=DRAIN_TIMEOUT)
        self._run.is_over = True
        self.exit_code = code
        return code

    def send(self, signal_: Signal) -> None:
        """Send a signal to it and its children if it is running."""
        if self._run is not None and self.is_running:
            self._run.send(signal_)


class _Run:
    """A process from one start to its end."""

    def __init__(self, command: NodeCommand, on_line: OnLine, inherited: Set[str]) -> None:
        self._loop = asyncio.get_running_loop()
        self._on_line = on_line
        self.is_over = False
        self._process = subprocess.Popen(
            command.command,
            stdin=None if "stdin" in inherited else subprocess.DEVNULL,
            stdout=None if "stdout" in inherited else subprocess.PIPE,
            stderr=None if "stderr" in inherited else subprocess.PIPE,
            bufsize=0,
            cwd=_folder(command.folder),
            env=command.environment,
            # Only this process receives a terminal's Ctrl-C; it ends the nodes in order. A node can
            # read keys and change the terminal's settings all the same.
            start_new_session=os.name != "nt",
            creationflags=_GROUP,
        )
        self.pid = self._process.pid
        self.ended: asyncio.Future[int] = self._loop.create_future()
        self.drained: list[asyncio.Future[None]] = []
        for stream, is_error in ((self._process.stdout, False), (self._process.stderr, True)):
            if stream is None:
                continue  # It is inherited.
            done: asyncio.Future[None] = self._loop.create_future()
            self.drained.append(done)
            Thread(target=self._read, args=(stream, is_error, done), daemon=True).start()
        Thread(target=self._wait, daemon=True).start()

    def send(self, signal_: Signal) -> None:
        with suppress(ProcessLookupError, PermissionError):
            if sys.platform == "win32":
                match signal_:
                    case Signal.INTERRUPT:
                        self._process.send_signal(signal.CTRL_BREAK_EVENT)
                    case Signal.TERMINATE:
                        self._process.terminate()
                    case Signal.KILL:
                        self._process.kill()
            else:
                os.killpg(self.pid, _NUMBERS[signal_])

    def _wait(self) -> None:
        code = self._process.wait()
        self._call(self.ended.set_result, code)

    def _read(self, stream: IO[bytes], is_error: bool, done: asyncio.Future[None]) -> None:
        rest = b""
        with stream:
            while chunk := stream.read(LONGEST_LINE):
                *lines, rest = (rest + chunk).split(b"\n")
                if len(rest) >= LONGEST_LINE:
                    lines, rest = [*lines, rest], b""
                self._pass_on(lines, is_error)
        if rest:
            self._pass_on([rest], is_error)
        self._call(done.set_result, None)

    def _pass_on(self, lines: list[bytes], is_error: bool) -> None:
        done = Event()

        def pass_on() -> None:
            try:
                for line in lines:
                    if not self.is_over:
                        self._on_line(line.removesuffix(b"\r").decode(errors="replace"), is_error)
            finally:
                done.set()

        # Waiting bounds the memory: a process that prints too fast is slowed down.
        if lines and self._call(pass_on):
            done.wait()

    def _call(self, function: Callable[..., object], *arguments: object) -> bool:
        """Call a function in the event loop; return False if the loop is closed."""
        try:
            self._loop.call_soon_threadsafe(function, *arguments)
        except RuntimeError:
            return False
        return True


if sys.platform == "win32":
    _GROUP = subprocess.CREATE_NEW_PROCESS_GROUP
else:
    _GROUP = 0
    _NUMBERS = {
        Signal.INTERRUPT: signal.SIGINT,
        Signal.TERMINATE: signal.SIGTERM,
        Signal.KILL: signal.SIGKILL,
    }


def _folder(folder: Path) -> Path | None:
    """Return the folder, created if missing; None, for this process's own, if that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder
