"""The environment variables of a shell in which ROS 1's commands and modules are fibws's."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TypeAlias

from fibws.command_names import SETUP, is_set_up

FOLDER = Path(__file__).absolute().parent
BIN_FOLDER = FOLDER / "bin"
"""The folder of the commands, for the front of PATH."""
PYTHON_FOLDER = FOLDER.parent / "python"
"""The folder of rospy and the like, for the front of PYTHONPATH."""

PYTHON = "FIBWS_PYTHON"
"""The variable for the Python that runs the commands."""
DISTRO = "noetic"
OF_ROS = {"ROS_DISTRO": DISTRO, "ROS_VERSION": "1", "ROS_PYTHON_VERSION": "3"}
"""Variables of a ROS 1 that scripts and launch files read."""

_OF_ROS_1 = re.compile(
    r"(catkin|rqt)(_\w+)?|rviz|xacro|ros(action|bag|boost|cat|clean|console|core|create|dep|ed|graph|"
    r"launch|locate|make|master|msg|node|pack|param|run|service|srv|stack|test|topic|unit|version|wtf)"
    r"(-\w+)?"
)
"""The names of ROS 1's commands."""

_SHADOWS = "shadows"
"""A key of the record of `SETUP`: an installed ROS was hidden on purpose."""

Changes: TypeAlias = dict[str, str | None]
"""New values of variables; None unsets one."""


def set_up(environ: Mapping[str, str], *, shadows: bool = False) -> Changes:
    """Return the changes that put commands and modules on their paths.

    The variable `SETUP` records the earlier values of the other variables. In an environment that
    is set up already, nothing changes.

    Args:
        shadows: whether an installed ROS is hidden on purpose, which `SETUP` records, too.
    """
    is_shadowing = shadows or shadows_ros(environ)
    record = _record(environ)
    if record is None:
        record = {name: environ.get(name) for name in (PYTHON, *OF_ROS)}
    return {
        "PATH": _joined(str(BIN_FOLDER), *_others(environ.get("PATH"))),
        "PYTHONPATH": _joined(str(PYTHON_FOLDER), *_others(environ.get("PYTHONPATH"))),
        PYTHON: sys.executable,
        **OF_ROS,
        SETUP: json.dumps({**record, **({_SHADOWS: "yes"} if is_shadowing else {})}),
    }


def shadows_ros(environ: Mapping[str, str]) -> bool:
    """Return whether this shell hides an installed ROS on purpose, as `SETUP` records."""
    try:
        found = json.loads(environ.get(SETUP, ""))
    except ValueError:
        return False
    return isinstance(found, dict) and _SHADOWS in found


def undo(environ: Mapping[str, str], besides: Iterable[tuple[str, Path]] = ()) -> Changes:
    """Return the changes that undo `set_up`; other folders on the paths are kept.

    Args:
        environ: the current variables.
        besides: further folders to remove, each with its path variable.
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
    """Return how to recognize another ROS that is installed or set up; None without one."""
    others = _joined(*_others(environ.get("PATH")))
    if roscore := shutil.which("roscore", path=others):
        return f"found {roscore}"
    if is_set_up(environ):
        return None
    found = [name for name in ("ROS_ROOT", "ROS_DISTRO") if environ.get(name)]
    return f"{found[0]} is {environ[found[0]]}" if found else None


def unreplaced_commands(environ: Mapping[str, str]) -> list[str]:
    """Return the commands of another ROS that fibws has no command for; they stay reachable.

    In a folder of ROS's own, such as /opt/ros/noetic/bin, these are all commands. In a folder of
    the system that has a roscore, these are the commands with names of ROS 1.
    """
    found: set[str] = set()
    for folder in _others(environ.get("PATH")):
        if shutil.which("roscore", path=folder):
            names = {path.name for path in Path(folder).iterdir() if os.access(path, os.X_OK)}
            is_of_ros = (Path(folder).parent / "_setup_util.py").exists()
            found |= {name for name in names if is_of_ros or _OF_ROS_1.fullmatch(name)}
    return sorted(found - {path.name for path in BIN_FOLDER.iterdir()})


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
    """Return the folders of a path that no installation of fibws has put there."""
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
