"""What a person sees: what nodes print, each line with its node's name before it, and our words."""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle

COLOURS = (36, 33, 35, 32, 34, 96, 93, 95, 92, 94)
"""Of names, one after the other; red is that of errors."""
_RED, _BOLD, _RESET = "\x1b[31m", "\x1b[1m", "\x1b[0m"


class Screen:
    """Where all is shown.

    Args:
        write: is given a line, and whether it is an error's.
        colours: whether that may have colours in it.
    """

    def __init__(self, write: Callable[[str, bool], None], *, colours: bool = False) -> None:
        self._write = write
        self._has_colours = colours
        self._colours: dict[str, int] = {}
        self._next = cycle(COLOURS)

    def say(self, text: str, *, bold: bool = False) -> None:
        """Show our own words."""
        self._write(f"{_BOLD}{text}{_RESET}" if bold and self._has_colours else text, False)

    def complain(self, text: str) -> None:
        """Show what is wrong."""
        self._write(f"{_RED}{text}{_RESET}" if self._has_colours else text, True)

    def show(self, process: str, line: str, *, is_error: bool = False) -> None:
        """Show a line that a process has printed."""
        name = f"[{process}]"
        if self._has_colours:
            if process not in self._colours:
                self._colours[process] = next(self._next)
            name = f"\x1b[{self._colours[process]}m{name}{_RESET}"
        self._write(f"{name} {line}", is_error)
