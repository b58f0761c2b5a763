"""Keys as they are pressed, which is asked of each system in another way."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from fibws.cli.arguments import is_stdin_terminal


class Keyboard:
    """The keyboard, if standard input is one."""

    @contextmanager
    def read(self) -> Iterator[None]:
        """Have each key told at once, and not shown."""
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
        """The key that is pressed within so many seconds, or an empty text."""
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
