"""The tests that packages name in CMakeLists.txt, as catkin's target run_tests runs them."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from fibws.errors import PackageFileError
from fibws.ros1.shell import environment
from fibws.ros1.workspace.cmake_lists import ListedTest
from fibws.ros1.workspace.setup_files import entries
from fibws.ros1.workspace.source_tree import SourcePackage


@dataclass(frozen=True)
class PackageTest:
    """One test of a package.

    Attributes:
        package: the package's name.
        title: its macro and file, ``add_rostest test/talk.test``.
        command: how to run it; its exit code is 0 if it passed.
        folder: the folder to run it in.
    """

    package: str
    title: str
    command: list[str]
    folder: Path


def package_tests(packages: Iterable[SourcePackage], results: Path) -> list[PackageTest]:
    """Return the tests of packages, in order.

    Args:
        packages: the packages.
        results: the folder for results, in JUnit's XML.

    Raises:
        PackageFileError: the file of a test is not found.
    """
    found = []
    for package in packages:
        for test in package.lists.tests:
            if not test.path.exists():
                text = f"{test.macro}(): {test.path} not found"
                raise PackageFileError(package.lists.source, test.line, text)
            for command in _commands(package, test, results):
                title = f"{test.macro} {test.path.relative_to(package.folder)}"
                found.append(PackageTest(package.name, title, command, package.folder))
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


def _commands(package: SourcePackage, test: ListedTest, results: Path) -> Iterator[list[str]]:
    own = results / package.name
    name = "_".join(test.path.relative_to(package.folder).parts)
    match test.macro:
        case "add_rostest":
            yield [
                *(sys.executable, "-P", "-m", "fibws.cli", "rostest", f"--package={package.name}"),
                *(f"--pkgdir={package.folder}", f"--results-base-dir={results}"),
                *(f"--results-filename={name}", str(test.path), *test.arguments),
            ]
        case "catkin_add_nosetests":
            if find_spec("pytest"):
                report = f"--junit-xml={own / f'nosetests-{name}.xml'}"
                yield [sys.executable, "-m", "pytest", "-q", report, str(test.path)]
            elif test.path.is_dir():
                yield [sys.executable, "-m", "unittest", "discover", "-s", str(test.path)]
            else:
                yield [sys.executable, "-m", "unittest", str(test.path)]
        case "roslaunch_add_file_check":
            files = sorted(test.path.glob("*.launch")) if test.path.is_dir() else [test.path]
            for file in files:
                launch = [sys.executable, "-P", "-m", "fibws", "launch", "--check", str(file)]
                yield [*launch, *test.arguments]
