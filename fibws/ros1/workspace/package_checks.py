"""Warn of likely mistakes in packages: names, missing dependencies, programs that do not run."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.discovery import (
    SHEBANG,
    fault_of_script,
    find_files,
    has_shebang,
    has_windows_shebang,
    is_executable,
    starts_node,
)
from fibws.ros1.workspace.packages_outside_fibws import (
    NOT_NEEDED,
    REPOSITORIES,
    is_installed,
    pip_name,
)
from fibws.ros1.workspace.source_tree import SourcePackage
from fibws.ros1.workspace.suggestions import quoted
from fibws.suggestions import nearest


def check_package(package: SourcePackage) -> None:
    """Add errors and warnings about one package that was read."""
    manifest, lists = package.manifest, package.lists
    build_type = manifest.exports.get("build_type", "catkin")
    if build_type not in ("catkin", "cmake"):
        text = f"this is a ROS 2 package ({build_type}); fibws builds packages of ROS 1 (catkin)"
        package.errors.append(PackageFileError(manifest.source, manifest.line, text))
    if lists.project.text not in ("", package.name):
        where = f"{lists.source}, line {lists.project.line}"
        text = f"project({lists.project.text}) should be project({package.name}), as in package.xml"
        package.warnings.append(f"{where}: {text}")
    package.warnings += _check_programs(package)


def _check_programs(package: SourcePackage) -> Iterator[str]:
    lists = package.lists
    sources: dict[str, Path] = {}
    for each in lists.programs:
        where = f"{lists.source}, line {each.line}"
        other = sources.get(each.target, each.path)
        sources[each.target] = each.path
        if other.resolve() != each.path.resolve():
            text = f"{quoted(each.path)} replaces {quoted(other)}: both become {each.target}"
            yield f"{where}: {text}"
        if not has_shebang(each.path):
            yield f"{where}: the first line of {each.path.name} should be {SHEBANG}"
        if not is_executable(each.path):
            yield f"{where}: {each.path.name} is not executable: chmod +x {quoted(each.path)}"
    installed = {each.path.resolve() for each in lists.programs}
    for path in find_files(package.folder):
        is_script = path.suffix == ".py" and (has_shebang(path) or starts_node(path))
        is_installed = path.resolve() in installed
        if is_script and not is_executable(path) and not is_installed:
            yield f"{path} is not executable, so it cannot be run: chmod +x {quoted(path)}"
        is_run = is_script or is_executable(path)
        if is_run and (fault := fault_of_script(path)):
            if not is_installed or has_windows_shebang(path):
                yield f"{path}, {fault}"


def missing_dependencies(
    packages: Iterable[SourcePackage], known: Collection[str]
) -> Iterator[str]:
    """Yield a warning for each dependency that is not found, with what would install it.

    Args:
        packages: the packages.
        known: the names of all packages that are found, including those of fibws.
    """
    places: dict[str, str] = {}
    users: dict[str, dict[str, None]] = {}
    for package in packages:
        for name, place in _dependencies(package):
            if name not in known and name not in NOT_NEEDED:
                places.setdefault(name, place)
                users.setdefault(name, {})[package.name] = None
    for name, place in places.items():
        if remedy := _how_to_install(name, known):
            others = ", ".join([*users[name]][1:])
            also = f" (also needed by {others})" if others else ""
            yield f"{place}: package {name} not found{also}: {remedy}"


def _dependencies(package: SourcePackage) -> Iterator[tuple[str, str]]:
    """Yield the names of a package's dependencies, each with file and line."""
    manifest, lists = package.manifest, package.lists
    for each in manifest.depends:
        if each.tag not in ("test_depend", "doc_depend", "buildtool_depend"):
            yield each.name, f"{manifest.source}, line {each.line}"
    for name, line in (*lists.components.items(), *lists.message_packages.items()):
        yield name, f"{lists.source}, line {line}"


def _how_to_install(name: str, known: Collection[str]) -> str:
    """Return what to do about a missing dependency; empty if it may be a library of the system."""
    if pip := pip_name(name):
        return "" if is_installed(pip) else f"pip install {pip}"
    if name in REPOSITORIES:
        return f"put its source for ROS 1 into src/: {REPOSITORIES[name]}"
    if near := nearest(name, known, cutoff=0.8):
        return f"did you mean {near}?"
    # Most packages have an underscore in their names; libraries, as boost and libusb-dev, have not.
    return "put its source into src/" if "_" in name else ""


def note_cpp(packages: Iterable[SourcePackage]) -> Iterator[str]:
    """Yield one warning about all C++ programs and libraries, if there are any."""
    having = [package for package in packages if package.lists.cpp_targets]
    if having:
        count = sum(len(package.lists.cpp_targets) for package in having)
        targets = "1 target" if count == 1 else f"{count} targets"
        names = ", ".join(package.name for package in having)
        yield f"fibws does not build C++: {targets} left out, in {names}"
