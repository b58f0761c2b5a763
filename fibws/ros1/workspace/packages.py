"""The packages that are known here, as rospack and rosrun find them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Self

from fibws.definition_folders import STANDARD
from fibws.errors import ExecutableNotFound, PackageNotFound, WorkspaceError
from fibws.ros1.workspace import missing
from fibws.ros1.workspace.crawl import find_folders
from fibws.ros1.workspace.manifest import Manifest, read_manifest, read_name
from fibws.ros1.workspace.place import DEVEL, SOURCE
from fibws.ros1.workspace.programs import find_files, is_executable, looks_like_program

PATH = "ROS_PACKAGE_PATH"
"""Names folders with packages in them, as PATH does; of two of one name the first one counts."""
PREFIXES = "CMAKE_PREFIX_PATH"
"""Names the folders that catkin_make has written to, devel/ of each workspace."""

_FIBWS = Path(__file__).parents[2]
_MODULES = _FIBWS / "ros1" / "python"
SHARE = _FIBWS / "ros1" / "launch" / "share"
"""Holds the packages that are nothing but launch files, for others to include."""


class Package:
    """One package.

    Attributes:
        name: as its manifest says.
        folder: where it is.
        is_standard: whether fibws brings it, as a ROS would that is installed.
    """

    def __init__(self, name: str, folder: Path, *, is_standard: bool = False) -> None:
        self.name = name
        self.folder = folder
        self.is_standard = is_standard

    def __repr__(self) -> str:
        return f"Package({self.name!r}, {str(self.folder)!r})"

    @cached_property
    def manifest(self) -> Manifest:
        """What its package.xml says; a standard package has none, and depends on nothing.

        Raises:
            PackageFileError: the file is wrong.
            OSError: it cannot be read.
        """
        if self.is_standard:
            return Manifest(self.name, source=str(self.folder))
        return read_manifest(self.folder)


class Packages:
    """All packages that a path leads to, and the standard ones of fibws.

    Args:
        roots: folders with packages in them; of two packages of one name the first one counts.
        prefixes: folders that hold programs as ``lib/<package>/<program>``, looked into first.
        here: the folder that whoever looks for a package is in, for what an error suggests.
    """

    def __init__(
        self, roots: Sequence[Path], prefixes: Sequence[Path] = (), here: Path | None = None
    ) -> None:
        self._roots = list(roots)
        self._prefixes = list(prefixes)
        self._here = here

    @classmethod
    def from_environment(
        cls, workspace: Path | None = None, environment: Mapping[str, str] | None = None
    ) -> Self:
        """The packages of $ROS_PACKAGE_PATH and, before them, those of a workspace that is given.

        Args:
            workspace: its folder, for shells that have sourced nothing.
            environment: the variables; by default this process's own.

        Raises:
            WorkspaceError: the folder is no workspace.
        """
        environment = os.environ if environment is None else environment
        roots, prefixes = _paths(environment, PATH), _paths(environment, PREFIXES)
        if workspace is not None:
            if not (workspace / SOURCE).is_dir():
                raise WorkspaceError(f"{workspace} is no workspace: there is no src/ in it")
            roots.insert(0, workspace.resolve() / SOURCE)
            prefixes.insert(0, workspace.resolve() / DEVEL)
        return cls(roots, prefixes, workspace or Path.cwd())

    def __iter__(self) -> Iterator[Package]:
        """The packages, sorted by name."""
        return (self._found[name] for name in self.names())

    def names(self) -> list[str]:
        """The names of all packages, sorted."""
        return sorted(self._found)

    def find(self, name: str) -> Package:
        """The package of that name.

        Raises:
            PackageNotFound: there is none; its text says what the person has missed, perhaps.
        """
        if name not in self._found:
            raise PackageNotFound(name, missing.hint_for_package(name, "", self, self._here))
        return self._found[name]

    def has(self, name: str) -> bool:
        """Whether there is a package of that name."""
        return name in self._found

    def has_own(self, name: str) -> bool:
        """Whether there is a package of that name that fibws does not bring."""
        return name in self._found and not self._found[name].is_standard

    def executable(self, package: str, name: str) -> Path:
        """The program of a package, as rosrun finds it.

        That is what catkin_make has put into ``devel/lib/<package>``, else whatever is executable
        in the package's folder.

        Args:
            package: its name.
            name: the program's, perhaps with folders before it.

        Raises:
            PackageNotFound: there is no such package; the text names one that has such a program.
            ExecutableNotFound: there is no such program, it is not executable, or there are two.
        """
        if package not in self._found:
            hint = missing.hint_for_package(package, name, self, self._here)
            raise PackageNotFound(package, hint)
        owner = self._found[package]
        found = self._programs(owner, name)
        if not found:
            raise ExecutableNotFound(package, name, missing.hint_for_program(owner, name, self))
        if len(found) > 1:
            raise ExecutableNotFound(package, name, missing.hint_for_several(owner, found))
        return found[0]

    def having(self, program: str) -> list[Package]:
        """The packages that have a program of that name, or one that was meant to be."""
        return [
            package
            for package in self
            if not package.is_standard
            and (
                self._programs(package, program)
                or any(looks_like_program(path) for path in find_files(package.folder, program))
            )
        ]

    def programs(self, package: Package) -> list[str]:
        """The names of all that can be run in a package, sorted."""
        places = [*(prefix / "lib" / package.name for prefix in self._prefixes), package.folder]
        return sorted(
            {path.name for place in places for path in find_files(place) if is_executable(path)}
        )

    def in_workspace(self, workspace: Path) -> Packages:
        """The packages of a workspace that this path does not lead to, with the standard ones."""
        return Packages([workspace / SOURCE], [workspace / DEVEL])

    @property
    def has_workspace(self) -> bool:
        """Whether the path leads anywhere but to what fibws brings."""
        return any(root.is_dir() for root in self._roots)

    @cached_property
    def _found(self) -> dict[str, Package]:
        standard = {
            folder.name: Package(folder.name, folder, is_standard=True)
            for place in (_MODULES, STANDARD, SHARE)
            if place.is_dir()
            for folder in sorted(place.iterdir())
            if folder.is_dir() and folder.name.isidentifier() and folder.name != "__pycache__"
        }
        own: dict[str, Package] = {}
        for root in self._roots:
            for folder in find_folders(root):
                package = Package(read_name(folder), folder)
                own.setdefault(package.name, package)
        return {**standard, **own}

    def _programs(self, package: Package, name: str) -> list[Path]:
        for prefix in self._prefixes:
            built = prefix / "lib" / package.name / name
            if is_executable(built):
                return [built]
        found = {
            os.path.realpath(path): path
            for path in find_files(package.folder, name)
            if is_executable(path)
        }
        return sorted(found.values())


def _paths(environment: Mapping[str, str], variable: str) -> list[Path]:
    return [Path(each) for each in environment.get(variable, "").split(os.pathsep) if each]
