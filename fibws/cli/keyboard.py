"""Keys that are typed in a terminal, for programs with an event loop."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Thread


@contextmanager
def reading_keys(received: Callable[[str | None], None]) -> Iterator[None]:
    """Pass on what is typed, at once and without an echo; None at the end of the input.

    Standard input must be a terminal.
    """
    loop = asyncio.get_running_loop()
    if sys.platform == "win32":
        import msvcrt

        def read_keys() -> None:
            while True:
                first = msvcrt.getwch()
                text = first + msvcrt.getwch() if first in "\x00\xe0" else first
                loop.call_soon_threadsafe(received, text)

        Thread(target=read_keys, daemon=True, name="keyboard").start()
        yield
        return
    import os
    import termios
    import tty

    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)

    def read() -> None:
        data = os.read(descriptor, 1024)
        if not data:
            loop.remove_reader(descriptor)
        received(data.decode(errors="replace") or None)

    tty.setcbreak(descriptor)
    loop.add_reader(descriptor, read)
    try:
        yield
    finally:
        loop.remove_reader(descriptor)
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
