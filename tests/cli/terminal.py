"""A pseudo-terminal for a program: its output is read, and keys are typed."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path
from typing import Any

from patience import PATIENCE

ROOT = Path(__file__).parents[2]


class Terminal:
    """A program on its own terminal, which sends it the signals of Ctrl-C and of its end."""

    def __init__(self, *words: str, **environment: str) -> None:
        import fcntl
        import pty
        import struct
        import termios

        self._master, self._slave = pty.openpty()
        size = struct.pack("HHHH", 24, 80, 0, 0)
        fcntl.ioctl(self._slave, termios.TIOCSWINSZ, size)
        self._unread = b""
        self.output = ""
        """All output of the program."""
        variables = {name: value for name, value in os.environ.items() if "FIBWS" not in name}
        self.process = subprocess.Popen(
            words,
            stdin=self._slave,
            stdout=self._slave,
            stderr=self._slave,
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
            cwd=ROOT,
            env={**variables, **environment},
        )

    def type(self, keys: str) -> None:
        """Press keys."""
        os.write(self._master, keys.encode())

    def type_until(self, keys: str, text: str) -> None:
        """Press keys, again if the text does not follow: a completion does not wait long."""
        for _ in range(10):
            self.type(keys)
            if self._is_sent(text, 10):
                return
        raise AssertionError(f"no {text!r} in {self._unread!r}")

    def wait_for(self, text: str) -> None:
        """Read until a text was printed; the next call continues after it."""
        assert self._is_sent(text, PATIENCE), f"no {text!r} in {self._unread!r}"

    def _is_sent(self, text: str, seconds: float) -> bool:
        deadline = time.monotonic() + seconds
        while text.encode() not in self._unread:
            rest = deadline - time.monotonic()
            if rest <= 0 or not self._read(rest):
                return False
        self._unread = self._unread.partition(text.encode())[2]
        return True

    def modes(self) -> list[Any]:
        """Return the terminal's settings, such as the echo of keys."""
        import termios

        return termios.tcgetattr(self._slave)

    def ended(self) -> int:
        """Wait for the program's end, and return its exit code."""
        deadline = time.monotonic() + PATIENCE
        while self.process.poll() is None:
            assert time.monotonic() < deadline, "the program does not end"
            self._read(0.01)  # Unread output would block the program.
        return self.process.returncode

    def close(self) -> None:
        """End the program, if it has not ended, and the terminal."""
        self.process.kill()
        self.process.wait()
        self.hang_up()

    def hang_up(self) -> None:
        """Close the terminal without ending the program."""
        os.close(self._master)
        os.close(self._slave)

    def _read(self, seconds: float) -> bool:
        import select

        if not select.select([self._master], [], [], seconds)[0]:
            return False
        data = os.read(self._master, 4096)
        self._unread += data
        self.output += data.decode(errors="replace")
        return True
