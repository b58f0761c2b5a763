"""Suggest what to do when a package or a program is not found."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fibws.command_names import command_name
from fibws.errors import FibwsError
from fibws.ros1.workspace.discovery import find_files, looks_like_program, starts_node
from fibws.ros1.workspace.packages_outside_fibws import CPP, IN_CPP, REPOSITORIES
from fibws.ros1.workspace.paths import DEVEL, is_built, source_command, workspace_around
from fibws.suggestions import nearest

if TYPE_CHECKING:
    from fibws.ros1.workspace.packages import Package, Packages


def suggestion_for_package(name: str, program: str, packages: Packages, here: Path | None) -> str:
    """Return the end of the error when there is no package ``name``; empty if nothing is known.

    Args:
        name: what was asked for.
        program: the program in it that was to be run, if any.
        packages: all that are known.
        here: the current folder.
    """
    if program and (having := [each.name for each in packages.having(program)]):
        return _run(nearest(name, having) or having[0], program)
    if here is not None and (text := _not_sourced(name, program, packages, here)):
        return text
    if name in IN_CPP:
        return f"it is {CPP}"
    if repository := REPOSITORIES.get(name):
        make = command_name("workspace make")
        return f"clone {repository} into the folder src of a workspace and run {make}"
    if near := nearest(name, packages.names()):
        return f"did you mean {near}?"
    if not packages.has_workspace:
        return "this shell has no workspace: source WORKSPACE/devel/setup.bash"
    return ""


def suggestion_for_program(package: Package, name: str, packages: Packages) -> str:
    """Return the end of the error when there is no program ``name`` in a package."""
    files = list(find_files(package.folder, name))
    if meant := next((path for path in files if looks_like_program(path)), None):
        return f"the file is not executable: chmod +x {quoted(meant)}"
    if line := _cpp_targets(package).get(name):
        return f"it is a C++ program (CMakeLists.txt, line {line}), and fibws does not build C++"
    if files:
        return "the file is not a program"
    if others := [each.name for each in packages.having(name) if each.name != package.name]:
        return _run(others[0], name)
    known = packages.programs(package)
    if near := nearest(name, known):
        return f"did you mean {near}?"
    idle = {path.name: path for path in find_files(package.folder) if path.suffix == ".py"}
    if near := nearest(name, sorted(idle)):
        return f"did you mean {near}? It is not executable: chmod +x {quoted(idle[near])}"
    if not known and (nodes := [path for path in idle.values() if starts_node(path)]):
        words = " ".join(quoted(path) for path in nodes[:10])
        return f"no program is executable: chmod +x {words}"
    if known:
        return f"it has {', '.join(known[:10])}"
    return f"there are no programs in {package.folder}"


def suggestion_for_several(package: Package, found: Sequence[Path]) -> str:
    """Return the end of the error when a package has several programs of one name."""
    names = [path.relative_to(package.folder).as_posix() for path in found]
    return f"there are {len(names)}; choose one: {', '.join(names)}"


def quoted(path: Path) -> str:
    """Return a path as one word of a shell command."""
    return shlex.quote(str(path))


def _run(package: str, program: str) -> str:
    return f"{package} has it: {command_name('run')} {package} {program}"


def _cpp_targets(package: Package) -> dict[str, int]:
    """Return the C++ programs of a package, with their lines in its CMakeLists.txt."""
    from fibws.ros1.workspace.cmake_lists import read_cmake_lists

    try:
        return read_cmake_lists(package.folder, package.name).cpp_targets
    except (FibwsError, OSError):
        return {}


def _not_sourced(name: str, program: str, packages: Packages, here: Path) -> str:
    """Return what to do if the workspace around ``here`` has the package or the program."""
    workspace = workspace_around(here)
    if workspace is None:
        return ""
    known = packages.in_workspace(workspace)
    having = [each.name for each in known.having(program)] if program else []
    if known.has(name) and not known.find(name).is_standard:
        subject = "it is"
    elif having:
        subject = f"{having[0]} has it, which is"
    else:
        return ""
    command = source_command(workspace / DEVEL)
    if not is_built(workspace):
        build = f"cd {quoted(workspace)} && {command_name('workspace make')} && {command}"
        return f"{subject} in the workspace {workspace}, which is not built: {build}"
    return f"{subject} in the workspace {workspace}, which this shell has not sourced: {command}"
