"""Which launch files the words of a command line name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fibws.command_names import command_name
from fibws.errors import PackageNotFound, WorkspaceError
from fibws.ros1.workspace.discovery import find_files
from fibws.ros1.workspace.packages import Packages
from fibws.suggestions import nearest

SUFFIXES = (".launch", ".xml", ".test")
DASH = "-"
"""Stands for what comes in by a pipe."""


def named(words: Sequence[str], packages: Packages) -> list[str]:
    """The paths of the files that words name: PACKAGE FILE, or FILE, then others.

    Raises:
        WorkspaceError: one of them is no file; the text says what is near.
    """
    first, *others = words
    is_file = first == DASH or Path(first).is_file()
    if others and (packages.has(first) or not is_file):
        return [str(_in_package(first, others[0], packages)), *map(_checked, others[1:])]
    if not is_file:
        raise _no_file(first, packages)
    return [_checked(word) for word in words]


def launch_files(folder: Path) -> list[Path]:
    """The launch files in a package's folder."""
    return [path for path in find_files(folder) if path.suffix in SUFFIXES[:1]]


def _in_package(package: str, file: str, packages: Packages) -> Path:
    folder = _folder(package, file, packages)
    found = list(find_files(folder, file))
    if len(found) == 1:
        return found[0]
    if found:
        paths = ", ".join(path.relative_to(folder).as_posix() for path in found)
        raise WorkspaceError(f"there are {len(found)} files {file} in {package}: write {paths}")
    known = [path.name for path in launch_files(folder)]
    raise WorkspaceError(
        f"there is no launch file {file!r} in package {package!r}: {_have(file, known)}"
    )


def _folder(package: str, file: str, packages: Packages) -> Path:
    try:
        return packages.find(package).folder
    except PackageNotFound as error:
        if Path(package).suffix in SUFFIXES or "/" in package:
            raise WorkspaceError(f"there is no file {package}") from None
        if having := _having(file, packages):
            raise PackageNotFound(package, having) from None
        raise error


def _no_file(word: str, packages: Packages) -> WorkspaceError:
    if packages.has(word):
        known = [path.name for path in launch_files(packages.find(word).folder)]
        return WorkspaceError(
            f"{word} is a package: name a launch file of it, too; {_have('', known)}"
        )
    beside = [path.name for path in Path(word).parent.glob("*") if path.suffix in SUFFIXES]
    if having := _having(word, packages):
        return WorkspaceError(f"there is no file {word}: {having}")
    near = _nearest(word, beside)
    return WorkspaceError(f"there is no file {word}{f'; did you mean {near}?' if near else ''}")


def _having(file: str, packages: Packages) -> str:
    """Which package has a launch file, as a hint; empty if none has."""
    if not file.endswith(SUFFIXES) or Path(file).is_absolute():
        return ""
    for package in packages:
        if not package.is_standard and any(find_files(package.folder, file)):
            return f"{package.name} has it: {command_name('launch')} {package.name} {file}"
    return ""


def _checked(word: str) -> str:
    if word != DASH and not Path(word).is_file():
        raise WorkspaceError(f"there is no file {word}")
    return word


def _have(name: str, known: list[str]) -> str:
    if near := _nearest(name, known):
        return f"did you mean {near}?"
    return f"it has {', '.join(known)}" if known else "it has none"


def _nearest(file: str, known: list[str]) -> str | None:
    """The one of the known files that is almost called so; all have like suffixes."""
    by_stem = {Path(each).stem: each for each in known}
    near = nearest(Path(file).stem, by_stem)
    return by_stem[near] if near else None
