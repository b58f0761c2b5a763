"""Where a workspace is: a folder that holds src/, and what catkin_make writes beside it."""

from __future__ import annotations

import os
from pathlib import Path
from shlex import quote

from fibws.errors import WorkspaceError
from fibws.ros1.workspace.manifest import FILE as MANIFEST
from fibws.ros1.workspace.recipe import FILE as LISTS
from fibws.ros1.workspace.tree import File, write

SOURCE, DEVEL, BUILD, MARK = "src", "devel", "build", ".catkin_workspace"
SPACES = ".catkin"
"""The file in devel/ that names src/: catkin's mark of a folder that it has written."""

_LISTS = """\
# Made by catkin_init_workspace. It marks this folder as the source space of a catkin workspace: the
# packages are in folders below it, and catkin_make is called in the folder above it.
#
# fibws reads no more of it than that it is there. For the CMake of an installed ROS, put its own in
# its place: rm CMakeLists.txt && catkin_init_workspace

cmake_minimum_required(VERSION 3.0.2)
project(Project)
message(FATAL_ERROR "This is a workspace of fibws, whose catkin_make needs no CMake.")
"""


def around(folder: Path) -> Path | None:
    """The workspace that ``folder`` is in, or is; None if it is in none.

    A folder is taken for one if catkin has been at work there: it has initialized src/ or built it.
    """
    folder = folder.resolve()
    return next((each for each in (folder, *folder.parents) if is_workspace(each)), None)


def is_workspace(folder: Path) -> bool:
    """Whether catkin has been at work in the folder."""
    return (folder / SOURCE).is_dir() and (
        (folder / MARK).is_file()
        or os.path.lexists(folder / SOURCE / LISTS)
        or (folder / DEVEL / SPACES).is_file()
    )


def is_built(workspace: Path) -> bool:
    """Whether catkin_make has been at work there, and the folder is where it was then."""
    devel = workspace / DEVEL
    try:
        source = Path((devel / SPACES).read_text("utf-8").strip())
        return (devel / "setup.bash").is_file() and source.samefile(workspace / SOURCE)
    except (OSError, ValueError):
        return False


def sourcing(devel: Path) -> str:
    """What a person types in order that the shell has the workspace."""
    if os.name == "nt":
        return f". {devel / 'setup.ps1'}    (cmd: call {devel / 'setup.bat'})"
    shell = "zsh" if Path(os.environ.get("SHELL", "")).name == "zsh" else "bash"
    return f"source {quote(str(devel / f'setup.{shell}'))}"


def here() -> Path:
    """The folder that the person is in, by the name that the shell shows, be it a symbolic link."""
    folder = Path.cwd()
    shown = Path(os.environ.get("PWD", folder))
    try:
        return shown if shown.is_absolute() and shown.samefile(folder) else folder
    except OSError:
        return folder


def check(folder: Path) -> None:
    """See whether catkin_make can be called for ``folder``.

    Raises:
        WorkspaceError: it is none that packages are built in; the text says which one is.
    """
    if not folder.is_dir():
        raise WorkspaceError(f"there is no folder {folder}")
    if (folder / SOURCE).is_dir() and not (folder / MANIFEST).exists() and not _is_source(folder):
        if os.pathsep in str(folder):
            fault = f"the path of a workspace cannot have {os.pathsep} in it"
            raise WorkspaceError(f"{fault}, as {folder} has")
        return
    above = around(folder) or _begun_around(folder)
    if above is not None and above != folder.resolve():
        steps = os.path.relpath(above, folder.resolve())
        fault = f"catkin_make is called in the root of the workspace, not in {folder}"
        raise WorkspaceError(f"{fault}: cd {steps}")
    if (folder / MANIFEST).exists():
        fault = f"{folder} is a package, and catkin_make is called in the root of a workspace"
        raise WorkspaceError(f"{fault}: make one, with the package in its src/")
    raise WorkspaceError(
        f"{folder} is no workspace, for it has no {SOURCE}/: cd into yours, or begin one: mkdir src"
    )


def initialize(folder: Path) -> Path:
    """Mark ``folder``, the src/ of a workspace; the file that does is returned.

    Raises:
        WorkspaceError: the folder is not there, or has been marked.
        OSError: it cannot be written to.
    """
    if not folder.is_dir():
        raise WorkspaceError(f'workspace "{folder}" does not exist')
    path = folder / LISTS
    if os.path.lexists(path):
        raise WorkspaceError(f'File "{path}" already exists: the workspace is initialized')
    write(folder, {LISTS: File(_LISTS.encode())})
    return path


def _begun_around(folder: Path) -> Path | None:
    """The workspace that ``folder`` is in if catkin has not been at work there, by its src/."""
    for each in (folder, *folder.parents):
        if each.name == SOURCE and not (each.parent / MANIFEST).exists():
            inside = each == folder or any(
                (above / MANIFEST).exists() for above in (folder, *folder.parents)
            )
            return each.parent if inside else None
    return None


def _is_source(folder: Path) -> bool:
    """Whether the folder is the src/ of a workspace, even if there is a src/ in it, too."""
    return os.path.lexists(folder / LISTS)
