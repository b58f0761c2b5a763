"""The packages in src/ of a workspace, in the order in which they are built."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fibws.errors import FibwsError
from fibws.ros1.errors import PackageFileError, WorkspaceError
from fibws.ros1.workspace.cmake_lists import FILE as LISTS
from fibws.ros1.workspace.cmake_lists import CMakeLists, read_cmake_lists
from fibws.ros1.workspace.discovery import find_packages
from fibws.ros1.workspace.package_xml import FILE as MANIFEST
from fibws.ros1.workspace.package_xml import Manifest, read_manifest, read_name


@dataclass
class SourcePackage:
    """A package in src/.

    Attributes:
        folder: where it is.
        manifest: its package.xml; only a name if that is invalid.
        lists: its CMakeLists.txt; empty if there is none.
        depends: the packages that it needs, in this workspace or not.
        errors: why it cannot be built.
        warnings: likely mistakes, each with file and line.
    """

    folder: Path
    manifest: Manifest
    lists: CMakeLists
    depends: set[str] = field(default_factory=set)
    errors: list[FibwsError] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The package's name."""
        return self.manifest.name


def read_source_tree(source: Path) -> tuple[list[SourcePackage], list[str]]:
    """Read all packages below a folder.

    Returns:
        The packages, each after those that it depends on, and warnings about packages that are left
        out because another one has the same name.
    """
    packages: dict[str, SourcePackage] = {}
    warnings = []
    for folder in find_packages(source):
        package = _read_package(folder)
        if first := packages.get(package.name):
            text = f"{folder} is ignored: {first.folder} has the same package name, {package.name}"
            warnings.append(f"{text}; rename one, or create {folder / 'CATKIN_IGNORE'}")
        else:
            packages[package.name] = package
    for package in packages.values():
        package.depends |= {
            member.name
            for member in packages.values()
            if set(member.manifest.groups) & set(package.manifest.group_depends)
        }
    depends = {name: package.depends for name, package in packages.items()}
    order, circles = topological_order(depends)
    for circle in circles:
        text = f"these packages depend on each other in a circle: {' -> '.join(circle)}"
        for name in circle[1:]:
            packages[name].errors.append(WorkspaceError(text))
    return [packages[name] for name in order], warnings


def _read_package(folder: Path) -> SourcePackage:
    """Read one package; what is invalid becomes an error of the package."""
    lists = CMakeLists(str(folder / LISTS))
    try:
        manifest = read_manifest(folder)
    except (FibwsError, OSError) as error:
        unknown = Manifest(read_name(folder), source=str(folder / MANIFEST))
        return SourcePackage(folder, unknown, lists, errors=[_as_error(error)])
    package = SourcePackage(folder, manifest, lists, warnings=list(manifest.warnings))
    try:
        if (folder / LISTS).is_file():
            package.lists = read_cmake_lists(folder, manifest.name)
        elif not manifest.is_metapackage:
            missing = f"{LISTS} not found in this folder"
            package.errors.append(PackageFileError(manifest.source, 1, missing))
    except (FibwsError, OSError) as error:
        package.errors.append(_as_error(error))
    package.errors += package.lists.errors
    package.warnings += package.lists.warnings
    package.depends = {
        *manifest.direct,
        *package.lists.components,
        *package.lists.message_packages,
    } - {manifest.name}
    return package


def _as_error(error: FibwsError | OSError) -> FibwsError:
    if isinstance(error, FibwsError):
        return error
    return WorkspaceError(f"{error.filename}: {error.strerror}")


def topological_order(depends: Mapping[str, set[str]]) -> tuple[list[str], list[list[str]]]:
    """Sort names so that each follows those that it depends on, else alphabetically.

    Args:
        depends: which others each depends on; other names than the keys are ignored.

    Returns:
        The names, and the circles, as in ``["a", "b", "a"]``; each is broken at one place.
    """
    left = {name: others & depends.keys() for name, others in depends.items()}
    order: list[str] = []
    circles: list[list[str]] = []
    while left:
        ready = min((name for name, others in left.items() if not others & left.keys()), default="")
        if ready:
            order.append(ready)
            del left[ready]
        else:
            circle = _circle(left)
            circles.append(circle)
            left[circle[0]].discard(circle[1])
    return order, circles


def _circle(left: Mapping[str, set[str]]) -> list[str]:
    """Return a path from a name over names that it depends on back to itself."""
    path = [min(left)]
    while path[-1] not in path[:-1]:
        path.append(min(left[path[-1]] & left.keys()))
    return path[path.index(path[-1]) :]


def with_dependencies(names: set[str], depends: Mapping[str, set[str]]) -> set[str]:
    """Return the names and all names that they depend on, as far as those are keys."""
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name in depends and name not in found:
            found.add(name)
            pending += depends[name]
    return found
