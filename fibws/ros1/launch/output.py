"""The output of nodes: on the screen, each line after its node's name, and in log files."""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle
from pathlib import Path
from typing import TextIO

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
