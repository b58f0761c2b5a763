"""One process: what it prints, line by line, and how it is made to end.

Threads wait for it and read from it, so that its end is known though a child of it lives on and
keeps its pipes open, for which asyncio would wait.
"""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from enum import Enum, auto
from pathlib import Path
from threading import Event, Thread
from typing import IO, TypeAlias

from fibws.ros1.launch.command import Start

Hear: TypeAlias = Callable[[str, bool], None]
"""Is given a line that was printed, and whether that was on standard error."""

LONGEST_LINE = 2**16
"""Bytes; what is longer is given in parts."""
LAST_WORDS = 1.0
"""Seconds in which what a process has printed is read after its end; a child of it may live on."""


class Ask(Enum):
    """How a process is asked to end, ever more urgently."""

    INTERRUPT = auto()
    TERMINATE = auto()
    KILL = auto()


class Process:
    """A process that can be started again when it has ended.

    Args:
        name: what it is called on the screen, ``talker-1``.
        start: what it is started with.
        hear: is given what it prints, in the event loop that it was started in.
    """

    def __init__(self, name: str, start: Start, hear: Hear) -> None:
        self.name = name
        self.start = start
        self.exit_code: int | None = None
        """Its exit code when it has ended; -2 if signal 2 has ended it."""
        self.pid = 0
        """Its id; 0 before its first start."""
        self._hear = hear
        self._run: _Run | None = None

    @property
    def is_running(self) -> bool:
        """Whether it has been started and has not ended."""
        return self._run is not None and not self._run.ended.done()

    async def begin(self) -> None:
        """Start it; it raises `OSError` if that cannot be done."""
        self.exit_code = None
        self._run = _Run(self.start, self._hear)
        self.pid = self._run.pid

    async def end(self) -> int:
        """Wait until it has ended and all that it printed was heard; return its exit code."""
        assert self._run is not None
        # Whoever waits may be cancelled; the process may not be thought to have ended by that.
        code = await asyncio.shield(self._run.ended)
        await asyncio.wait(self._run.heard, timeout=LAST_WORDS)
        self._run.is_over = True
        self.exit_code = code
        return code

    def ask(self, how: Ask) -> None:
        """Ask it, and what it has started, to end; nothing happens if it has."""
        if self._run is not None and self.is_running:
            self._run.ask(how)


class _Run:
    """A process from one start to its end."""

    def __init__(self, start: Start, hear: Hear) -> None:
        self._loop = asyncio.get_running_loop()
        self._hear = hear
        self.is_over = False
        self._process = subprocess.Popen(
            start.command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            bufsize=0,
            cwd=_folder(start.folder),
            env=start.environment,
            # A terminal's Ctrl-C is this process's alone: nodes are told in their order.
            start_new_session=os.name != "nt",
            creationflags=_GROUP,
        )
        self.pid = self._process.pid
        self.ended: asyncio.Future[int] = self._loop.create_future()
        self.heard: list[asyncio.Future[None]] = []
        for stream, is_error in ((self._process.stdout, False), (self._process.stderr, True)):
            assert stream is not None
            done: asyncio.Future[None] = self._loop.create_future()
            self.heard.append(done)
            Thread(target=self._read, args=(stream, is_error, done), daemon=True).start()
        Thread(target=self._wait, daemon=True).start()

    def ask(self, how: Ask) -> None:
        with suppress(ProcessLookupError, PermissionError):
            if sys.platform == "win32":
                match how:
                    case Ask.INTERRUPT:
                        self._process.send_signal(signal.CTRL_BREAK_EVENT)
                    case Ask.TERMINATE:
                        self._process.terminate()
                    case Ask.KILL:
                        self._process.kill()
            else:
                os.killpg(self.pid, _SIGNALS[how])

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
                self._tell(lines, is_error)
        if rest:
            self._tell([rest], is_error)
        self._call(done.set_result, None)

    def _tell(self, lines: list[bytes], is_error: bool) -> None:
        told = Event()

        def tell() -> None:
            try:
                for line in lines:
                    if not self.is_over:
                        self._hear(line.removesuffix(b"\r").decode(errors="replace"), is_error)
            finally:
                told.set()

        # Not to read more than is shown keeps this small: who prints too much has to wait.
        if lines and self._call(tell):
            told.wait()

    def _call(self, function: Callable[..., object], *arguments: object) -> bool:
        """Call a function in the event loop; False if that is no more."""
        try:
            self._loop.call_soon_threadsafe(function, *arguments)
        except RuntimeError:
            return False
        return True


if sys.platform == "win32":
    _GROUP = subprocess.CREATE_NEW_PROCESS_GROUP
else:
    _GROUP = 0
    _SIGNALS = {
        Ask.INTERRUPT: signal.SIGINT,
        Ask.TERMINATE: signal.SIGTERM,
        Ask.KILL: signal.SIGKILL,
    }


def _folder(folder: Path) -> Path | None:
    """The folder, made if need be; None, for this process's own, if it cannot be there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder
