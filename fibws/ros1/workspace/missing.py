"""What a person has missed who asks for a package or a program that is not found."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fibws.errors import FibwsError
from fibws.ros1.workspace.place import DEVEL, around, is_built, sourcing
from fibws.ros1.workspace.programs import find_files, looks_like_program
from fibws.ros1.workspace.recipe import FILE as LISTS
from fibws.suggestions import nearest

if TYPE_CHECKING:
    from fibws.ros1.workspace.packages import Package, Packages


def hint_for_package(name: str, program: str, packages: Packages, here: Path | None) -> str:
    """The end of the error's text when there is no package ``name``; empty if nothing is known.

    Args:
        name: what was asked for.
        program: the program in it that was to be run, if any.
        packages: all that there are.
        here: the folder that the person is in.
    """
    if program and (having := [each.name for each in packages.having(program)]):
        has = nearest(name, having) or having[0]
        return f"{has} has it: rosrun {has} {program}"
    if here is not None and (hint := _not_sourced(name, program, packages, here)):
        return hint
    if near := nearest(name, packages.names()):
        return f"did you mean {near}?"
    if not packages.has_workspace:
        return "no workspace is known in this shell: source WORKSPACE/devel/setup.bash"
    return ""


def hint_for_program(package: Package, name: str, packages: Packages) -> str:
    """The end of the error's text when there is no program ``name`` in a package."""
    meant = [path for path in find_files(package.folder, name) if looks_like_program(path)]
    if meant:
        return f"it is there, but not executable: chmod +x {quoted(meant[0])}"
    if line := _compiled(package).get(name):
        return f"{LISTS}, line {line}, makes it of C++, which is not built here"
    if any(find_files(package.folder, name)):
        return "it is there, but no program"
    if others := [each.name for each in packages.having(name) if each.name != package.name]:
        return f"{others[0]} has it: rosrun {others[0]} {name}"
    known = packages.programs(package)
    if near := nearest(name, known):
        return f"did you mean {near}?"
    idle = sorted({path.name for path in find_files(package.folder) if path.suffix == ".py"})
    if near := nearest(name, idle):
        path = next(find_files(package.folder, near))
        return f"did you mean {near}? It is not executable: chmod +x {quoted(path)}"
    if known:
        return f"it has {', '.join(known[:10])}"
    return f"there is no program at all in {package.folder}"


def _compiled(package: Package) -> dict[str, int]:
    """What a package would make of C++, with the lines in its recipe, as far as that is right."""
    from fibws.ros1.workspace.reader import read_recipe

    try:
        return read_recipe(package.folder).compiled
    except (FibwsError, OSError):
        return {}


def hint_for_several(package: Package, found: Sequence[Path]) -> str:
    """The end of the error's text when a package has several programs of one name."""
    names = [path.relative_to(package.folder).as_posix() for path in found]
    return f"there are {len(names)}, write which one: {', '.join(names)}"


def quoted(path: Path) -> str:
    """A path as one word of a shell."""
    return shlex.quote(str(path))


def _not_sourced(name: str, program: str, packages: Packages, here: Path) -> str:
    """What to do if the workspace that the person is in has the package, or the program."""
    workspace = around(here)
    if workspace is None:
        return ""
    known = packages.in_workspace(workspace)
    having = [each.name for each in known.having(program)] if program else []
    if known.has(name) and not known.find(name).is_standard:
        what = "it is"
    elif having:
        what = f"{having[0]} has it, which is"
    else:
        return ""
    setup = sourcing(workspace / DEVEL)
    if not is_built(workspace):
        built = f"cd {quoted(workspace)} && catkin_make && {setup}"
        return f"{what} in the workspace {workspace}, which is not built: {built}"
    return f"{what} in the workspace {workspace}, which this shell does not know: {setup}"
