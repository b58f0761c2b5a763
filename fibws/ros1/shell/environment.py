"""The environment variables of a shell in which ROS 1's commands and modules are fibws's."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TypeAlias

from fibws.command_names import SETUP, is_set_up

FOLDER = Path(__file__).absolute().parent
BIN_FOLDER = FOLDER / "bin"
"""Holds the commands; it is to be the first of PATH."""
PYTHON_FOLDER = FOLDER.parent / "python"
"""Holds rospy and the like; it is to be the first of PYTHONPATH."""

PYTHON = "FIBWS_PYTHON"
"""The variable that names the Python by which the commands run."""
DISTRO = "noetic"
OF_ROS = {"ROS_DISTRO": DISTRO, "ROS_VERSION": "1", "ROS_PYTHON_VERSION": "3"}
"""What scripts and launch files ask a ROS 1 for."""

Changes: TypeAlias = dict[str, str | None]
"""New values of variables; those with None are no more."""


def set_up(environ: Mapping[str, str]) -> Changes:
    """What puts commands and modules on their paths; done again, it changes nothing."""
    record = _record(environ)
    if record is None:
        record = {name: environ.get(name) for name in (PYTHON, *OF_ROS)}
    return {
        "PATH": _joined(str(BIN_FOLDER), *_others(environ.get("PATH"))),
        "PYTHONPATH": _joined(str(PYTHON_FOLDER), *_others(environ.get("PYTHONPATH"))),
        PYTHON: sys.executable,
        **OF_ROS,
        SETUP: json.dumps(record),
    }


def undo(environ: Mapping[str, str], besides: Iterable[tuple[str, Path]] = ()) -> Changes:
    """What takes `set_up` back, whatever else was done to the paths meanwhile.

    Args:
        environ: the variables as they are.
        besides: what else is to go: folders, each with the variable that has it on its path.
    """
    paths = {name: _others(environ.get(name)) for name in ("PATH", "PYTHONPATH")}
    for name, folder in besides:
        others = paths[name] if name in paths else _others(environ.get(name))
        paths[name] = [each for each in others if each != str(folder)]
    record = _record(environ)
    return {
        **{name: _joined(*folders) or None for name, folders in paths.items()},
        **({} if record is None else record),
        SETUP: None,
    }


def other_ros(environ: Mapping[str, str]) -> str | None:
    """What shows that a ROS is installed or was set up, or None if nothing does."""
    others = _joined(*_others(environ.get("PATH")))
    if roscore := shutil.which("roscore", path=others):
        return f"there is {roscore}"
    if is_set_up(environ):
        return None
    found = [name for name in ("ROS_ROOT", "ROS_DISTRO") if environ.get(name)]
    return f"{found[0]} is {environ[found[0]]}" if found else None


def _record(environ: Mapping[str, str]) -> Changes | None:
    try:
        found = json.loads(environ.get(SETUP, ""))
    except ValueError:
        return None
    if not isinstance(found, dict):
        return None
    values = {name: found.get(name) for name in (PYTHON, *OF_ROS)}
    return {name: each if isinstance(each, str) else None for name, each in values.items()}


def _others(path: str | None) -> list[str]:
    """The folders of a path but for ours, and those of other installations of fibws."""
    folders = path.split(os.pathsep) if path else []
    return [folder for folder in folders if not _is_ours(folder)]


def _is_ours(folder: str) -> bool:
    path = Path(folder)
    if path in (BIN_FOLDER, PYTHON_FOLDER):
        return True
    return any(
        path.parts[-len(own) :] == own
        for own in (BIN_FOLDER.parts[-4:], PYTHON_FOLDER.parts[-3:], ("fibws", "ros1", "bin"))
    )


def _joined(*folders: str) -> str:
    return os.pathsep.join(folders)
