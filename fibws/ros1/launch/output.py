"""The output of nodes: in a terminal, in lines after their names, and in log files."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Set
from contextlib import suppress
from itertools import cycle
from pathlib import Path
from typing import Any, TextIO

COLOURS = (36, 33, 35, 32, 34, 96, 93, 95, 92, 94)
"""Colours of names, in turn; red is for errors."""
_RED, _BOLD, _RESET = "\x1b[31m", "\x1b[1m", "\x1b[0m"


class Screen:
    """The terminal, or where else standard output and error go.

    Args:
        write: is called with a line and whether it goes to standard error.
        colours: whether lines may be coloured.
    """

    def __init__(self, write: Callable[[str, bool], None], *, colours: bool = False) -> None:
        self._write = write
        self._has_colours = colours
        self._colours: dict[str, int] = {}
        self._next = cycle(COLOURS)

    def info(self, text: str, *, bold: bool = False) -> None:
        """Show a text of the launch itself."""
        self._write(f"{_BOLD}{text}{_RESET}" if bold and self._has_colours else text, False)

    def error(self, text: str) -> None:
        """Show an error of the launch itself."""
        self._write(f"{_RED}{text}{_RESET}" if self._has_colours else text, True)

    def output(self, process: str, line: str, *, is_error: bool = False) -> None:
        """Show a line that a process printed."""
        name = f"[{process}]"
        if self._has_colours:
            if process not in self._colours:
                self._colours[process] = next(self._next)
            name = f"\x1b[{self._colours[process]}m{name}{_RESET}"
        self._write(f"{name} {line}", is_error)


class Terminal:
    """This process's terminal, if it has one, which it shares with nodes, as roslaunch does.

    A node with ``output="screen"`` writes to it directly; all nodes can read keys from it.

    Args:
        is_shared: whether nodes use it; otherwise all their output is received.
    """

    def __init__(self, *, is_shared: bool) -> None:
        standard = {"stdin": sys.stdin, "stdout": sys.stdout, "stderr": sys.stderr}
        self.streams: Set[str] = {
            name
            for name, stream in standard.items()
            if is_shared and stream is not None and stream.isatty()
        }
        """Which of stdin, stdout and stderr are shared terminals."""
        self._settings = self._read() if "stdin" in self.streams else None

    def streams_of_node(self, *, screen: bool) -> Set[str]:
        """Return the streams that a node shares with this process."""
        return self.streams if screen else self.streams & {"stdin"}

    def restore(self) -> None:
        """Restore the settings, such as the echo of keys, that a node may have changed."""
        if sys.platform == "win32":
            return
        if self._settings is None or not self._is_in_foreground():
            return
        import termios

        if self._read() not in (None, self._settings):
            with suppress(termios.error):
                termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._settings)

    def _is_in_foreground(self) -> bool:
        """Return whether it may be changed; a shell's background job would be stopped by that."""
        if sys.platform == "win32":
            return True
        try:
            return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
        except OSError:
            return True  # The terminal belongs to another session, whose jobs it stops.

    def _read(self) -> list[Any] | None:
        """Return the settings; None on Windows, and if the terminal was closed."""
        if sys.platform == "win32":
            return None
        import termios

        try:
            return termios.tcgetattr(sys.stdin)
        except termios.error:
            return None


class LogFile:
    """A log file, created with its first line."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: TextIO | None = None

    def write(self, line: str) -> None:
        """Append a line, or raise `OSError`."""
        if self._file is None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = self.path.open("a", encoding="utf-8", buffering=1)
        self._file.write(f"{line}\n")

    def close(self) -> None:
        """Close the file; another line opens it again."""
        if self._file is not None:
            self._file.close()
            self._file = None
