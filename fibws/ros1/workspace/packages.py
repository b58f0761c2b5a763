"""Find packages and their programs, as rospack and rosrun do."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Self

from fibws import processes
from fibws.definition_folders import STANDARD
from fibws.ros1.errors import ExecutableNotFound, PackageNotFound, WorkspaceError
from fibws.ros1.shell import ros_programs
from fibws.ros1.workspace.discovery import (
    fault_of_script,
    find_files,
    find_packages,
    is_executable,
    looks_like_program,
)
from fibws.ros1.workspace.package_xml import Manifest, read_manifest, read_name
from fibws.ros1.workspace.paths import DEVEL, SOURCE
from fibws.ros1.workspace.suggestions import (
    suggestion_for_package,
    suggestion_for_program,
    suggestion_for_several,
)

PATH = "ROS_PACKAGE_PATH"
"""The variable that lists folders with packages; the first of two packages of one name counts."""
PREFIXES = "CMAKE_PREFIX_PATH"
"""The variable that lists the folders that catkin_make has written: devel/ of each workspace."""

_DISTRIBUTIONS = Path("/opt/ros")
"""The folder of the installed distributions of ROS, such as ``noetic``."""
_DEBIAN = Path("/usr")
"""Where Debian's own packages of ROS have their programs."""

_FIBWS = Path(__file__).parents[2]
_MODULES = _FIBWS / "ros1" / "python"
SHARE = _FIBWS / "ros1" / "launch" / "share"
"""Packages that hold only launch files, to be included by others."""


class Package:
    """One package.

    Attributes:
        name: its name in package.xml.
        folder: where it is.
        is_standard: whether it is part of fibws.
    """

    def __init__(self, name: str, folder: Path, *, is_standard: bool = False) -> None:
        self.name = name
        self.folder = folder
        self.is_standard = is_standard

    def __repr__(self) -> str:
        return f"Package({self.name!r}, {str(self.folder)!r})"

    @cached_property
    def manifest(self) -> Manifest:
        """The content of its package.xml; a standard package has none, and no dependencies.

        Raises:
            PackageFileError: the file is invalid.
            OSError: the file cannot be read.
        """
        if self.is_standard:
            return Manifest(self.name, source=str(self.folder))
        return read_manifest(self.folder)


class Packages:
    """The packages below some folders, and those of fibws.

    Args:
        roots: folders with packages; the first of two packages of one name counts.
        prefixes: folders with programs as ``lib/<package>/<program>``, which are searched first.
        here: the current folder, for suggestions in errors.
        installed: folders of an installed ROS, with packages as ``share/<package>`` and programs
            as in ``prefixes``; these come last.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        prefixes: Sequence[Path] = (),
        here: Path | None = None,
        *,
        installed: Sequence[Path] = (),
    ) -> None:
        self._roots = list(roots)
        self._prefixes = list(prefixes)
        self._here = here
        self._installed = list(installed)

    @classmethod
    def from_environment(
        cls, workspace: Path | None = None, environment: Mapping[str, str] | None = None
    ) -> Self:
        """Find the packages of a workspace, if one is given, and those of $ROS_PACKAGE_PATH.

        Args:
            workspace: its folder, for shells that have not sourced it.
            environment: the variables; by default those of this process.

        Raises:
            WorkspaceError: the folder is not a workspace.
        """
        environment = os.environ if environment is None else environment
        roots, prefixes = _paths(environment, PATH), _paths(environment, PREFIXES)
        if workspace is not None:
            if not (workspace / SOURCE).is_dir():
                raise WorkspaceError(f"{workspace} is not a workspace: it has no src/")
            roots.insert(0, workspace.resolve() / SOURCE)
            prefixes.insert(0, workspace.resolve() / DEVEL)
        distributions = sorted(_DISTRIBUTIONS.glob("*"))
        installed = [*_prefixes_of(roots), *distributions, _DEBIAN]
        return cls(roots, prefixes, workspace or Path.cwd(), installed=installed)

    def __iter__(self) -> Iterator[Package]:
        """Yield the packages, sorted by name."""
        return (self._found[name] for name in self.names())

    def names(self) -> list[str]:
        """Return the names of all packages, sorted."""
        return sorted(self._found)

    def find(self, name: str) -> Package:
        """Return the package of that name.

        Raises:
            PackageNotFound: the name is unknown; the text suggests what to do.
        """
        if name not in self._found:
            raise PackageNotFound(name, suggestion_for_package(name, "", self, self._here))
        return self._found[name]

    def has(self, name: str) -> bool:
        """Return whether there is a package of that name."""
        return name in self._found

    def has_own(self, name: str) -> bool:
        """Return whether there is a package of that name that is not part of fibws."""
        return name in self._found and not self._found[name].is_standard

    def executable(self, package: str, name: str) -> Path:
        """Return the program of a package, as rosrun finds it.

        It is in ``devel/lib/<package>``, where catkin_make puts programs, or else it is an
        executable file in the package's folder, or a program of an installed ROS.

        Args:
            package: the package's name.
            name: the program's name, perhaps with folders.

        Raises:
            PackageNotFound: there is no such package; the text suggests what to do.
            ExecutableNotFound: there is no such program, it cannot be run, or there are two.
        """
        owner = self._found.get(package)
        found = [] if owner is None else self._programs(owner, name)
        if not found and (installed := self.installed(package, name)) is not None:
            return installed
        if owner is None:
            raise PackageNotFound(package, suggestion_for_package(package, name, self, self._here))
        if not found:
            raise ExecutableNotFound(package, name, suggestion_for_program(owner, name, self))
        if len(found) > 1:
            raise ExecutableNotFound(package, name, suggestion_for_several(owner, found))
        if fault := fault_of_script(found[0]):
            raise ExecutableNotFound(package, name, f"{found[0]}, {fault}")
        return found[0]

    def installed(self, package: str, name: str) -> Path | None:
        """Return a program of an installed ROS; None if it is not there."""
        if not package.isidentifier():
            return None
        places = (
            prefix / "lib" / package / name
            for prefix in self._installed
            if (prefix / "share" / package).is_dir()
        )
        return next((path for path in places if is_executable(path)), None)

    def having(self, program: str) -> list[Package]:
        """Return the packages that have a program of that name, executable or not."""
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
        """Return the names of a package's programs, sorted."""
        places = [*(prefix / "lib" / package.name for prefix in self._prefixes), package.folder]
        found = {path.name for place in places for path in find_files(place) if is_executable(path)}
        return sorted(found.union(ros_programs.names(package.name) if package.is_standard else ()))

    def in_workspace(self, workspace: Path) -> Packages:
        """Return the packages of another workspace, and those of fibws."""
        return Packages([workspace / SOURCE], [workspace / DEVEL])

    @property
    def has_workspace(self) -> bool:
        """Whether any folder with packages exists, besides those of fibws."""
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
            for folder in find_packages(root):
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


def _prefixes_of(roots: Sequence[Path]) -> list[Path]:
    """Return the folders of an installed ROS whose packages are listed as ``<folder>/share``."""
    return [root.parent for root in roots if root.name == "share"]


def rosrun_command(
    packages: Packages, package: str, program: str, arguments: Sequence[str]
) -> tuple[list[str], Path]:
    """Return what rosrun starts for a program, and the folder that the program is in.

    Some programs of ROS, as rqt_graph, are replaced by programs of fibws. Others, as RViz, which
    has no substitute, are started if they are installed.

    Args:
        packages: the known packages; those outside fibws come first.
        package: the program's package.
        program: its name.
        arguments: its arguments.

    Raises:
        WorkspaceError: there is no such package or program, or fibws has no such program.
        OSError: the program's file cannot be read.
    """
    if not packages.has_own(package):
        try:
            found = ros_programs.command_line(package, program, arguments)
        except WorkspaceError:
            if packages.installed(package, program) is None:
                raise
            found = None
        if found is not None:
            return found, Path.cwd()
    executable = packages.executable(package, program)
    return processes.command_line(executable, arguments), executable.parent
