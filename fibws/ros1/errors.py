"""The errors of ROS 1's userland: workspaces, launch files, robot models and maps.

FibwsError
├── WorkspaceError         something is wrong with a workspace, or with a package in it
│   ├── PackageNotFound        no package of this name is on the path
│   ├── ExecutableNotFound     the package has no such program, or it cannot be run
│   └── PackageFileError       an invalid package.xml or CMakeLists.txt
├── LaunchError            an invalid launch file
├── UrdfError              an invalid robot model
└── MapError               an occupancy map's files cannot be read or written
"""

from __future__ import annotations

from typing import Literal

from fibws.errors import FibwsError


class WorkspaceError(FibwsError):
    """Something is wrong with a workspace, or with a package in it; the text says what."""


class PackageNotFound(WorkspaceError, LookupError):
    """No package of this name is on the path; ``hint`` suggests what to do."""

    def __init__(self, name: str, hint: str = "") -> None:
        self.name = name
        self.hint = hint
        super().__init__(f"package {name!r} not found{': ' if hint else ''}{hint}")


class ExecutableNotFound(WorkspaceError, LookupError):
    """The package has no such program, or it cannot be run; ``hint`` says more."""

    def __init__(self, package: str, name: str, hint: str) -> None:
        self.package = package
        self.name = name
        self.hint = hint
        super().__init__(f"no executable {name!r} in package {package!r}: {hint}")


class PackageFileError(WorkspaceError, ValueError):
    """An invalid package.xml or CMakeLists.txt."""

    def __init__(self, source: str, line: int, fault: str) -> None:
        self.source = source
        self.line = line
        self.fault = fault
        super().__init__(f"{source}, line {line}: {fault}")


class LaunchError(FibwsError, ValueError):
    """An invalid launch file; ``file`` and ``line`` say where.

    ``files`` are those that include it, the nearest first, each with the line of its <include>.
    """

    def __init__(
        self, file: str, line: int, fault: str, files: tuple[tuple[str, int], ...] = ()
    ) -> None:
        self.file = file
        self.line = line
        self.fault = fault
        self.files = files
        above = "".join(f", included from {file}:{line}" for file, line in files)
        super().__init__(f"{file}:{line}: {fault}{above}")


class UrdfError(FibwsError, ValueError):
    """An invalid robot model; the text says where and why."""


class MapError(FibwsError, ValueError):
    """An occupancy map's files cannot be read or written.

    Attributes:
        part: what is wrong: the ``file`` is missing or cannot be written, or the ``metadata`` in
            YAML or the ``image`` is invalid.
    """

    def __init__(self, part: Literal["file", "metadata", "image"], text: str) -> None:
        self.part = part
        super().__init__(text)
