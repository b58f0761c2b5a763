"""The launch files that a command line names: PACKAGE FILE, or paths."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fibws.command_names import command_name
from fibws.ros1.errors import PackageNotFound, WorkspaceError
from fibws.ros1.workspace.discovery import find_files
from fibws.ros1.workspace.packages import Packages
from fibws.suggestions import nearest

SUFFIXES = (".launch", ".xml", ".test")
STANDARD_INPUT = "-"


def find_launch_files(words: Sequence[str], packages: Packages) -> list[str]:
    """Return the paths of the named files: PACKAGE FILE, or FILE, then further files.

    Raises:
        WorkspaceError: a file is not found; the text has a suggestion.
    """
    first, *others = words
    is_file = first == STANDARD_INPUT or Path(first).is_file()
    if others and (packages.has(first) or not is_file):
        return [str(_in_package(first, others[0], packages)), *map(_existing, others[1:])]
    if not is_file:
        raise _not_found(first, packages)
    return [_existing(word) for word in words]


def launch_files_in(folder: Path, suffix: str = ".launch") -> list[Path]:
    """Return the launch files in a package's folder; those of tests have the suffix .test."""
    return [path for path in find_files(folder) if path.suffix == suffix]


def _in_package(package: str, file: str, packages: Packages) -> Path:
    folder = _folder(package, file, packages)
    found = list(find_files(folder, file))
    if len(found) == 1:
        return found[0]
    if found:
        paths = " or ".join(path.relative_to(folder).as_posix() for path in found)
        raise WorkspaceError(f"{package} has {len(found)} files {file}; write {paths}")
    suffix = ".test" if file.endswith(".test") else ".launch"
    known = _suggestion(file, launch_files_in(folder, suffix))
    raise WorkspaceError(f"launch file {file!r} not found in package {package!r}; {known}")


def _folder(package: str, file: str, packages: Packages) -> Path:
    try:
        return packages.find(package).folder
    except PackageNotFound as error:
        if Path(package).suffix in SUFFIXES or "/" in package:
            raise WorkspaceError(f"file {package} not found") from None
        if hint := _package_with(file, packages):
            raise PackageNotFound(package, hint) from None
        raise error


def _not_found(word: str, packages: Packages) -> WorkspaceError:
    if packages.has(word):
        known = _suggestion("", launch_files_in(packages.find(word).folder))
        return WorkspaceError(f"missing launch file after package {word}; {known}")
    if hint := _package_with(word, packages):
        return WorkspaceError(f"file {word} not found: {hint}")
    near = _nearest(word, [path for path in Path(word).parent.glob("*") if path.suffix in SUFFIXES])
    return WorkspaceError(f"file {word} not found{f'; did you mean {near}?' if near else ''}")


def _package_with(file: str, packages: Packages) -> str:
    """Return a hint to a package with a launch file; empty if none has it."""
    if not file.endswith(SUFFIXES) or Path(file).is_absolute():
        return ""
    for package in packages:
        if not package.is_standard and any(find_files(package.folder, file)):
            return f"{package.name} has it: {command_name('launch')} {package.name} {file}"
    return ""


def _existing(word: str) -> str:
    if word != STANDARD_INPUT and not Path(word).is_file():
        raise WorkspaceError(f"file {word} not found")
    return word


def _suggestion(file: str, known: Sequence[Path]) -> str:
    if near := _nearest(file, known):
        return f"did you mean {near}?"
    return f"it has {', '.join(path.name for path in known) or 'none'}"


def _nearest(file: str, known: Sequence[Path]) -> str | None:
    """Return the name of the known file with the most similar stem."""
    by_stem = {path.stem: path.name for path in known}
    near = nearest(Path(file).stem, by_stem)
    return by_stem[near] if near else None
