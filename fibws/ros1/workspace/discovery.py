"""Find packages below a folder, and programs in a package, by the rules of rospack and rosrun."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

MANIFEST = "package.xml"
SHEBANG = "#!/usr/bin/env python3"
"""The first line of a program in Python."""
IGNORED = {"CATKIN_IGNORE", "AMENT_IGNORE", "COLCON_IGNORE", "rospack_nosubdirs", ".catkin"}
"""A folder with one of these files is not searched; catkin writes .catkin into devel/."""

_RUN_BY_WINDOWS = {".py", ".exe", ".bat", ".cmd", ".ps1"}
_NO_PROGRAMS = {".git", ".svn", ".hg", "__pycache__"}


def find_packages(root: Path) -> Iterator[Path]:
    """Yield the folders below ``root``, including itself, that hold a package.xml, sorted.

    Packages inside packages, hidden folders and ignored folders are left out. Symbolic links are
    followed, but each folder is visited once.
    """
    yield from _find_packages(root, set())


def _find_packages(folder: Path, seen: set[str]) -> Iterator[Path]:
    real = os.path.realpath(folder)
    if real in seen:
        return
    seen.add(real)
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return  # Not a folder, or not readable.
    names = {entry.name for entry in entries}
    if names & IGNORED:
        return
    if MANIFEST in names:
        yield folder
        return
    for entry in entries:
        # Not entry.is_dir(), which raises for a link to itself.
        if not entry.name.startswith(".") and os.path.isdir(folder / entry.name):
            yield from _find_packages(folder / entry.name, seen)


def find_files(folder: Path, name: str = "") -> Iterator[Path]:
    """Yield the files below ``folder``, or only those whose path ends in ``name``.

    Symbolic links are followed, but each folder is visited once.

    Args:
        folder: where to search; it need not exist.
        name: a file name, perhaps with folders, as in ``scripts/talker.py``.
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


def is_executable(path: Path) -> bool:
    """Return whether a file is a program; on Windows its suffix or first line says so."""
    if not path.is_file():
        return False
    if os.name != "nt":
        return os.access(path, os.X_OK)
    return path.suffix.lower() in _RUN_BY_WINDOWS or has_shebang(path)


def has_shebang(path: Path) -> bool:
    """Return whether the first line names the program that runs the file."""
    return _first_line(path).startswith(b"#!")


def has_windows_shebang(path: Path) -> bool:
    """Return whether that line ends in CRLF: Linux takes the CR for a part of the name."""
    return has_shebang(path) and _first_line(path).endswith(b"\r\n")


def fault_of_script(path: Path) -> str:
    """Return why Linux and macOS would not run an executable file with Python; empty if they do.

    A shell would take a file without a shebang for a script of its own.
    """
    if os.name == "nt" or not path.is_file():
        return ""
    if has_windows_shebang(path):
        return "line 1: lines end in CRLF, so the program does not run; save it with LF"
    if path.suffix == ".py" and not has_shebang(path):
        return f"line 1 must be {SHEBANG}, or a shell runs the program in place of Python"
    return ""


def starts_node(path: Path) -> bool:
    """Return whether a Python file is a node's, and not a module of a Python package."""
    if path.suffix != ".py" or (path.parent / "__init__.py").exists():
        return False
    try:
        return b"init_node(" in path.read_bytes()
    except OSError:
        return False


def looks_like_program(path: Path) -> bool:
    """Return whether a file was probably meant to be a program."""
    return is_executable(path) or path.suffix == ".py" or has_shebang(path)


def _first_line(path: Path) -> bytes:
    """Return at most as much as Linux reads; nothing if the file cannot be read."""
    try:
        with path.open("rb") as file:
            return file.readline(256)
    except OSError:
        return b""
