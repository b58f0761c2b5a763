"""The folders of a workspace: where it is, src/, and what catkin_make writes beside it."""

from __future__ import annotations

import os
from pathlib import Path
from shlex import quote

from fibws.command_names import command_name
from fibws.ros1.errors import WorkspaceError
from fibws.ros1.workspace.cmake_lists import FILE as LISTS
from fibws.ros1.workspace.discovery import MANIFEST
from fibws.ros1.workspace.file_writer import File, write

SOURCE, DEVEL, BUILD, MARK = "src", "devel", "build", ".catkin_workspace"
SPACES = ".catkin"
"""The file in devel/ that names src/."""

_LISTS = """\
# Created by catkin_init_workspace. This file marks the folder as the source space of a catkin
# workspace: packages are in folders below it, and catkin_make is run in the folder above it.
#
# fibws does not read it. To build with an installed ROS instead, replace it:
# rm CMakeLists.txt && catkin_init_workspace

cmake_minimum_required(VERSION 3.0.2)
project(Project)
message(FATAL_ERROR "This workspace was created by fibws, whose catkin_make does not use CMake.")
"""


def workspace_around(folder: Path) -> Path | None:
    """Return the workspace that ``folder`` is or is in, if it was initialized or built."""
    folder = folder.resolve()
    return next((each for each in (folder, *folder.parents) if is_workspace(each)), None)


def is_workspace(folder: Path) -> bool:
    """Return whether the folder was initialized or built as a workspace."""
    return (folder / SOURCE).is_dir() and (
        (folder / MARK).is_file()
        or os.path.lexists(folder / SOURCE / LISTS)
        or (folder / DEVEL / SPACES).is_file()
    )


def is_built(workspace: Path) -> bool:
    """Return whether the workspace was built, and not moved since."""
    devel = workspace / DEVEL
    try:
        source = Path((devel / SPACES).read_text("utf-8").strip())
        return (devel / "setup.bash").is_file() and source.samefile(workspace / SOURCE)
    except (OSError, ValueError):
        return False


def source_command(devel: Path) -> str:
    """Return what to type so that the shell has the workspace."""
    if os.name == "nt":
        return f". {devel / 'setup.ps1'}    (cmd: call {devel / 'setup.bat'})"
    return f"source {quote(str(devel / f'setup.{_shell()}'))}"


def _shell() -> str:
    """Return the shell that has started this program, or else the user's: bash or zsh."""
    try:
        name = Path(f"/proc/{os.getppid()}/comm").read_text("utf-8").strip()
    except OSError:
        name = ""
    if name not in ("bash", "zsh"):
        name = Path(os.environ.get("SHELL", "")).name
    return "zsh" if name == "zsh" else "bash"


def current_folder() -> Path:
    """Return the current folder as the shell shows it, which may be a symbolic link."""
    folder = Path.cwd()
    shown = Path(os.environ.get("PWD", folder))
    try:
        return shown if shown.is_absolute() and shown.samefile(folder) else folder
    except OSError:
        return folder


def check_workspace(folder: Path) -> None:
    """Check that ``folder`` can be built as a workspace.

    Raises:
        WorkspaceError: it cannot; the text says where to go instead.
    """
    make = command_name("workspace make")
    if not folder.is_dir():
        raise WorkspaceError(f"folder {folder} not found")
    if (folder / SOURCE).is_dir() and not (folder / MANIFEST).exists() and not _is_source(folder):
        if os.pathsep in str(folder):
            text = f"the path of a workspace must not contain {os.pathsep!r}"
            raise WorkspaceError(f"{text}, got {folder}")
        return
    above = workspace_around(folder) or _new_workspace_around(folder)
    if above is not None and above != folder.resolve():
        steps = os.path.relpath(above, folder.resolve())
        text = f"run {make} in the root of the workspace, not in {folder}"
        raise WorkspaceError(f"{text}: cd {steps}")
    if (folder / MANIFEST).exists():
        text = f"{folder} is a package; run {make} in the root of a workspace"
        raise WorkspaceError(f"{text} that has the package in its {SOURCE}/")
    text = f"{folder} is not a workspace, as it has no {SOURCE}/"
    raise WorkspaceError(f"{text}: cd to yours, or create one with mkdir {SOURCE}")


def initialize(folder: Path) -> Path:
    """Mark ``folder``, the src/ of a workspace, and return the file that does so.

    Raises:
        WorkspaceError: the folder does not exist, or is marked already.
        OSError: the file cannot be written.
    """
    if not folder.is_dir():
        raise WorkspaceError(f'workspace "{folder}" does not exist')
    path = folder / LISTS
    if os.path.lexists(path):
        raise WorkspaceError(f'File "{path}" already exists: the workspace is initialized')
    write(folder, {LISTS: File(_LISTS.encode())})
    return path


def _new_workspace_around(folder: Path) -> Path | None:
    """Return the workspace, not yet initialized or built, whose src/ ``folder`` is in."""
    for each in (folder, *folder.parents):
        if each.name == SOURCE and not (each.parent / MANIFEST).exists():
            inside = each == folder or any(
                (above / MANIFEST).exists() for above in (folder, *folder.parents)
            )
            return each.parent if inside else None
    return None


def _is_source(folder: Path) -> bool:
    """Return whether the folder is the src/ of a workspace, even if it holds a src/ itself."""
    return os.path.lexists(folder / LISTS)
