"""The screen and the keyboard of a terminal on which `fibws top` runs."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fibws.cli import output
from fibws.cli.arguments import is_stdin_terminal
from fibws.cli.top.tables import tables
from fibws.client.statistics import Measurement

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

KEYS = {"r": "rate", "b": "bw", "n": "name"}
"""The keys that sort topics."""
KEYS_TEXT = "q: quit, r: rate, b: bw, n: name"
"""The keys' help, which fits a line of 80 characters with the rest of the heading."""
MAX_WAIT = 0.5
"""Seconds to wait for a key before processing messages: the hub disconnects unresponsive tools."""


class TopScreen:
    """The screen of a terminal: ``with Screen.open() as screen``."""

    def __init__(self, console: Console, show: Callable[[RenderableType], None]) -> None:
        self._console = console
        self._show = show
        self._keyboard = Keyboard()

    @classmethod
    @contextmanager
    def open(cls) -> Iterator[TopScreen]:
        """Switch to an own screen, and restore the previous one, on SIGTERM, too."""
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

    def show(self, measurement: Measurement, url: str, sort: str) -> None:
        """Show a measurement, as much of it as fits."""
        heading = f"{url}  {time.strftime('%X')}  by {sort}  {KEYS_TEXT}"
        self._show(tables(measurement, heading, self._console.width, self._console.height))

    def wait_for_key(self, seconds: float, process: Callable[[], None]) -> str:
        """Wait for a key, and return it, or an empty string after ``seconds``.

        Args:
            process: called while waiting.
        """
        deadline = time.monotonic() + seconds
        while (rest := deadline - time.monotonic()) > 0:
            if key := self._keyboard.pressed(min(rest, MAX_WAIT)):
                return key
            process()
        return ""


class Keyboard:
    """The keyboard, if standard input is one."""

    @contextmanager
    def read(self) -> Iterator[None]:
        """Read keys without Enter, and do not echo them."""
        if sys.platform == "win32" or not is_stdin_terminal():
            yield
            return
        import termios
        import tty

        before = termios.tcgetattr(sys.stdin)
        try:
            tty.setcbreak(sys.stdin)
            yield
        finally:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)

    def pressed(self, seconds: float) -> str:
        """Return the key that is pressed within ``seconds``, or an empty string."""
        if not is_stdin_terminal():
            time.sleep(seconds)
            return ""
        if sys.platform == "win32":
            import msvcrt

            deadline = time.monotonic() + seconds
            while not msvcrt.kbhit():
                if time.monotonic() >= deadline:
                    return ""
                time.sleep(0.05)
            return msvcrt.getwch()
        import os
        import select

        ready, _, _ = select.select([sys.stdin], [], [], seconds)
        return os.read(sys.stdin.fileno(), 1).decode(errors="replace") if ready else ""
