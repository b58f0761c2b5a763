"""The tests that packages name in CMakeLists.txt, as catkin's target run_tests runs them."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from fibws.ros1.errors import PackageFileError
from fibws.ros1.shell import environment
from fibws.ros1.workspace.cmake_lists import ListedTest
from fibws.ros1.workspace.setup_files import entries
from fibws.ros1.workspace.source_tree import SourcePackage

_PREFIXES = {
    "add_rostest": "rostest-",
    "catkin_add_nosetests": "nosetests-",
    "roslaunch_add_file_check": "roslaunch-check_",
}
"""The beginnings of the names of files with results."""


@dataclass(frozen=True)
class PackageTest:
    """One test of a package.

    Attributes:
        package: the package's name.
        title: its macro and file, ``add_rostest test/talk.test``.
        command: how to run it; its exit code is 0 if it passed.
        folder: the folder to run it in.
        results: the file for its results; some tests write none.
    """

    package: str
    title: str
    command: list[str]
    folder: Path
    results: Path


def package_tests(packages: Iterable[SourcePackage], results: Path) -> list[PackageTest]:
    """Return the tests of packages, in order.

    Args:
        packages: the packages.
        results: the folder for results, in JUnit's XML.

    Raises:
        PackageFileError: the file of a test is not found.
    """
    found: list[PackageTest] = []
    for package in packages:
        for test in package.lists.tests:
            if not test.path.exists():
                text = f"{test.macro}(): {test.path} not found"
                raise PackageFileError(package.lists.source, test.line, text)
            found += _tests(package, test, results)
    return found


def test_variables(source: Path, devel: Path, environ: Mapping[str, str]) -> dict[str, str]:
    """Return the environment variables of tests: those of a shell that has the workspace."""
    found = dict(environ)
    for name, value in environment.set_up(environ).items():
        if value is None:
            found.pop(name, None)
        else:
            found[name] = value
    for entry in entries(source, devel):
        folders = [each for each in found.get(entry.variable, "").split(os.pathsep) if each]
        folders = [each for each in folders if each != str(entry.folder)]
        at = len(folders) if entry.at_end else 0
        folders.insert(at, str(entry.folder))
        found[entry.variable] = os.pathsep.join(folders)
    return found


def _tests(package: SourcePackage, test: ListedTest, folder: Path) -> Iterator[PackageTest]:
    """Yield what one macro stands for; roslaunch_add_file_check() may name several files."""
    is_check = test.macro == "roslaunch_add_file_check"
    files = sorted(test.path.rglob("*.launch")) if is_check and test.path.is_dir() else [test.path]
    for file in files:
        path = file.relative_to(package.folder)
        name = "_".join(path.with_suffix("").parts)
        results = folder / package.name / f"{_PREFIXES[test.macro]}{name}.xml"
        command = _command(package, test, file, results)
        yield PackageTest(package.name, f"{test.macro} {path}", command, package.folder, results)


def _command(package: SourcePackage, test: ListedTest, file: Path, results: Path) -> list[str]:
    if test.macro == "add_rostest":
        return [
            *(sys.executable, "-P", "-m", "fibws.cli", "rostest", f"--package={package.name}"),
            *(f"--pkgdir={package.folder}", f"--results-base-dir={results.parents[1]}"),
            *(str(file), *test.arguments),
        ]
    if test.macro == "roslaunch_add_file_check":
        launch = [sys.executable, "-P", "-m", "fibws", "launch", "--check"]
        return [*launch, str(file), *test.arguments]
    if find_spec("pytest"):
        return [sys.executable, "-m", "pytest", "-q", f"--junit-xml={results}", str(file)]
    # Not by its path from here, as test/ is a package of Python's own.
    found = [str(file)] if file.is_dir() else [str(file.parent), "-p", file.name]
    return [sys.executable, "-m", "unittest", "discover", "-s", *found]
