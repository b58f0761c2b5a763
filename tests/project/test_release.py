"""The check of a release's tag, packages and changelog."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from .requirements import ROOT

CHANGELOG = """\
# Changelog

## Unreleased

### Added

- Something new.

## 0.2.0 - 2027-01-31

### Fixed

- Something old.

## 0.1.0 - 2026-11-27

- All.
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the packages and the changelog of version 0.2.0."""
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG)
    (tmp_path / "dist").mkdir()
    for name in ("fibws-0.2.0.tar.gz", "fibws-0.2.0-py3-none-any.whl"):
        (tmp_path / "dist" / name).touch()
    return tmp_path


def check(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / ".ci" / "check_release.py"), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def test_version_of_a_good_release_is_printed(folder: Path) -> None:
    done = check(folder, "v0.2.0")
    assert (done.returncode, done.stdout, done.stderr) == (0, "version=0.2.0\n", "")


def test_notes_are_the_section_of_the_release(folder: Path) -> None:
    assert check(folder, "v0.2.0", "--notes").stdout == "### Fixed\n\n- Something old.\n"


@pytest.mark.parametrize("tag", ["0.2.0", "v0.2", "v0.2.0-beta", "version"])
def test_invalid_tag_is_refused(folder: Path, tag: str) -> None:
    done = check(folder, tag)
    assert done.returncode == 1
    assert repr(tag) in done.stderr


def test_packages_of_another_version_are_refused(folder: Path) -> None:
    (folder / "dist" / "fibws-0.2.0.tar.gz").rename(folder / "dist" / "fibws-0.2.1.dev3.tar.gz")
    done = check(folder, "v0.2.0")
    assert done.returncode == 1
    assert "fibws-0.2.1.dev3.tar.gz" in done.stderr


def test_version_without_a_dated_section_is_refused(folder: Path) -> None:
    changelog = folder / "CHANGELOG.md"
    changelog.write_text(CHANGELOG.replace("## 0.2.0 - 2027-01-31", "## 0.2.0"))
    done = check(folder, "v0.2.0")
    assert done.returncode == 1
    assert "CHANGELOG.md" in done.stderr


def test_changelog_of_the_repository_has_notes_for_each_version() -> None:
    headings = [
        line.removeprefix("## ")
        for line in (ROOT / "CHANGELOG.md").read_text("utf-8").splitlines()
        if line.startswith("## ")
    ]
    assert headings[0] == "Unreleased"
    assert headings[1:], "CHANGELOG.md has no released version"
    for heading in headings[1:]:
        version, _, date = heading.partition(" - ")
        assert len(date) == len("2026-11-27"), heading
        assert version
