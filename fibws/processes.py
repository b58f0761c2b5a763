"""Command lines of programs, and execution of one in place of this process."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

_PYTHON = re.compile(rb"#!.*\bpython[\d.]*\b")
_HEAD = 256
"""Bytes of a file that are searched for a script's first line."""


def command_line(executable: Path, arguments: Sequence[str]) -> list[str]:
    """Return a program's command line; a Python script runs in this Python, with fibws's rospy.

    Args:
        executable: the program's file.
        arguments: its arguments.

    Raises:
        OSError: the file cannot be read.
    """
    if is_python(executable):
        # With -P, a random.py in the current folder does not replace Python's.
        return [sys.executable, "-P", "-m", "fibws.rospy", str(executable), *arguments]
    return [str(executable), *arguments]


def is_python(executable: Path) -> bool:
    """Return whether a program is a Python script, by its suffix or its first line.

    Raises:
        OSError: the file cannot be read.
    """
    if executable.suffix in (".py", ".pyw"):
        return True
    with executable.open("rb") as file:
        return _PYTHON.match(file.read(_HEAD).partition(b"\n")[0]) is not None


def start_error(error: OSError, program: str) -> OSError:
    """Return the error of a failed start with the program's name and a text that helps."""
    text = error.strerror
    if error.errno == errno.ENOEXEC:
        text = "Missing first line, such as #!/usr/bin/env python3"
    elif error.errno == errno.ENOENT and os.path.isfile(program):
        text = "Interpreter in its first line not found"
    return OSError(error.errno, text, program)


def exec_command(command: Sequence[str]) -> NoReturn:
    """Run a command in place of this process, which passes it all signals and its exit code.

    On Windows, run it as a child and wait for it.

    Raises:
        OSError: it cannot be started.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    if os.name != "nt":
        try:
            os.execvp(command[0], list(command))
        except OSError as error:
            raise start_error(error, command[0]) from None
    with subprocess.Popen(command) as process:
        while process.poll() is None:
            with suppress(KeyboardInterrupt):  # The child receives it, too.
                process.wait()
    sys.exit(process.returncode)
