"""How a package's program is started, and how a process becomes it."""

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
"""Bytes in which a script's first line is looked for."""


def command_line(executable: Path, arguments: Sequence[str]) -> list[str]:
    """What to start a program with: a Python script gets this Python, and our rospy.

    Args:
        executable: the program's file.
        arguments: what to call it with.

    Raises:
        OSError: the file cannot be read.
    """
    if is_python(executable):
        # With -P, no random.py of the folder that one happens to be in is imported for Python's.
        return [sys.executable, "-P", "-m", "fibws.rospy", str(executable), *arguments]
    return [str(executable), *arguments]


def is_python(executable: Path) -> bool:
    """Whether a program is a Python script, by its suffix or its first line.

    Raises:
        OSError: the file cannot be read.
    """
    if executable.suffix in (".py", ".pyw"):
        return True
    with executable.open("rb") as file:
        return _PYTHON.match(file.read(_HEAD).partition(b"\n")[0]) is not None


def explained(error: OSError, program: str) -> OSError:
    """The error of a start that was in vain, with the program's name and what a person can do."""
    text = error.strerror
    if error.errno == errno.ENOEXEC:
        text = "It has no first line that says what runs it, such as #!/usr/bin/env python3"
    elif error.errno == errno.ENOENT and os.path.isfile(program):
        text = "There is no program such as its first line names"
    return OSError(error.errno, text, program)


def become(command: Sequence[str]) -> NoReturn:
    """Run a command in this process's place, so that signals and its exit code are its own.

    Windows cannot do that: there it is a child that this process waits for.

    Raises:
        OSError: it cannot be started.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    if os.name != "nt":
        try:
            os.execvp(command[0], list(command))
        except OSError as error:
            raise explained(error, command[0]) from None
    with subprocess.Popen(command) as process:
        while process.poll() is None:
            with suppress(KeyboardInterrupt):  # It is the child's, who is told of it, too.
                process.wait()
    sys.exit(process.returncode)
