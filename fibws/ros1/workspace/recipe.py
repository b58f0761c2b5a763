"""What the CMakeLists.txt of a package asks for, as far as anything here is made of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from fibws.errors import FibwsError, PackageFileError
from fibws.ros1.workspace.cmake.script import Value

FILE = "CMakeLists.txt"

ADD_FILES = {
    "msg": "add_message_files",
    "srv": "add_service_files",
    "action": "add_action_files",
}
"""The commands that list definitions, by the kind of these."""


@dataclass(frozen=True)
class Listed:
    """A file that the recipe names, and the line in which it does."""

    path: Path
    line: int
    destination: str = ""

    @property
    def target(self) -> str:
        """The file in devel/ that stands for it, if it is a program."""
        return f"{self.destination.rstrip('/')}/{self.path.name}"


@dataclass
class Recipe:
    """What is to be made.

    Attributes:
        source: the file's name, for errors.
        project: the name in project(), with its line.
        components: what find_package() finds, each with its line.
        modules: those of them that it does not find by way of catkin.
        definitions: the files that add_*_files() list, by their kind: msg, srv, action.
        generates: the line of generate_messages(), if it is there.
        message_packages: what that depends on, each with its line.
        declares: the line of catkin_package(), if it is there.
        catkin_depends: what that depends on, each with its line.
        python_setup: the line of catkin_python_setup(), if it is there.
        programs: what catkin_install_python() installs.
        compiled: the targets in C++, each with its line.
        faults: what is wrong, each with its line; nothing is made of the package then.
        warnings: what should be otherwise, each with its line.
    """

    source: str
    project: Value = field(default_factory=lambda: Value("", 1))
    components: dict[str, int] = field(default_factory=dict)
    modules: set[str] = field(default_factory=set)
    definitions: dict[str, list[Listed]] = field(
        default_factory=lambda: {kind: [] for kind in ADD_FILES}
    )
    generates: int | None = None
    message_packages: dict[str, int] = field(default_factory=dict)
    declares: int | None = None
    catkin_depends: dict[str, int] = field(default_factory=dict)
    python_setup: int | None = None
    programs: list[Listed] = field(default_factory=list)
    compiled: dict[str, int] = field(default_factory=dict)
    faults: list[FibwsError] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def fault(self, line: int, text: str) -> None:
        """Note that something is wrong."""
        self.faults.append(PackageFileError(self.source, line, text))

    def warn(self, line: int, text: str) -> None:
        """Note that something should be otherwise."""
        self.warnings.append(f"{self.source}, line {line}: {text}")
