"""`fibws top` on a terminal: two tables that stay where they are, and keys."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fibws.cli import output
from fibws.cli.top.keyboard import Keyboard
from fibws.cli.top.measure import Measure
from fibws.cli.top.tables import tables

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

KEYS = {"r": "rate", "b": "bw", "n": "name"}
"""What a key has the topics sorted by."""
KEYS_SHOWN = "q: quit, r: rate, b: bw, n: name"
"""What the keys do, in as few characters as there is room for in a line of 80."""
SLICE = 0.5
"""Seconds between two looks at the connection: a hub ends one that answers no ping."""


class Screen:
    """The screen of a terminal while it is this tool's: ``with Screen.taken() as screen``."""

    def __init__(self, console: Console, show: Callable[[RenderableType], None]) -> None:
        self._console = console
        self._show = show
        self._keyboard = Keyboard()

    @classmethod
    @contextmanager
    def taken(cls) -> Iterator[Screen]:
        """Take the screen, and give it back as it was, also when SIGTERM ends the tool."""
        from rich.console import Console
        from rich.live import Live

        before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
        console = Console(no_color=not output.has_colours(), highlight=False)
        try:
            with Live(console=console, screen=True, auto_refresh=False) as live:
                screen = cls(console, lambda shown: live.update(shown, refresh=True))
                with screen._keyboard.read():
                    yield screen
        finally:
            signal.signal(signal.SIGTERM, before)

    def show(self, measure: Measure, url: str, sort: str) -> None:
        """Show a measure, as much of it as there is room for."""
        head = f"{url}  {time.strftime('%X')}  by {sort}  {KEYS_SHOWN}"
        self._show(tables(measure, head, self._console.width, self._console.height))

    def wait(self, seconds: float, meanwhile: Callable[[], None]) -> str:
        """Wait for so long or until a key is pressed, which is returned; empty if none was."""
        deadline = time.monotonic() + seconds
        while (rest := deadline - time.monotonic()) > 0:
            if key := self._keyboard.pressed(min(rest, SLICE)):
                return key
            meanwhile()
        return ""
