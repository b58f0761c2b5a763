"""The programs in a folder, by the rules of rosrun."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

_RUN_BY_WINDOWS = {".py", ".exe", ".bat", ".cmd", ".ps1"}
_NO_PROGRAMS = {".git", ".svn", ".hg", "__pycache__"}


def is_executable(path: Path) -> bool:
    """Whether a file is marked as a program; Windows knows that by its name or its first line."""
    if not path.is_file():
        return False
    if os.name != "nt":
        return os.access(path, os.X_OK)
    return path.suffix.lower() in _RUN_BY_WINDOWS or has_shebang(path)


def has_shebang(path: Path) -> bool:
    """Whether the first line says which program runs the file."""
    return _first_line(path).startswith(b"#!")


def has_windows_shebang(path: Path) -> bool:
    """Whether it does so, and ends in CRLF: Linux takes the CR for a part of the program's name."""
    line = _first_line(path)
    return line.startswith(b"#!") and line.endswith(b"\r\n")


def looks_like_program(path: Path) -> bool:
    """Whether a file was most likely meant to be one."""
    return is_executable(path) or path.suffix == ".py" or has_shebang(path)


def find_files(folder: Path, name: str = "") -> Iterator[Path]:
    """The files below ``folder``, or those of them that ``name`` is the end of.

    Symbolic links are followed, to each folder once.

    Args:
        folder: where to look; nothing is found where there is none.
        name: a file's name, perhaps with folders before it, as in ``scripts/talker.py``.
    """
    wanted = tuple(name.replace("\\", "/").split("/")) if name else ()
    seen: set[str] = set()
    for root, folders, files in os.walk(folder, followlinks=True):
        if (real := os.path.realpath(root)) in seen:
            folders.clear()
            continue
        seen.add(real)
        folders[:] = sorted(each for each in folders if each not in _NO_PROGRAMS)
        for file in sorted(files):
            path = Path(root, file)
            if not wanted or path.relative_to(folder).parts[-len(wanted) :] == wanted:
                yield path


def _first_line(path: Path) -> bytes:
    """As much of it as Linux reads; nothing if the file cannot be read."""
    try:
        with path.open("rb") as file:
            return file.readline(256)
    except OSError:
        return b""
