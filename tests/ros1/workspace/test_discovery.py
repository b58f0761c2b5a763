"""Packages below a folder, and programs in a package."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.ros1.workspace.discovery import (
    find_files,
    find_packages,
    has_shebang,
    is_executable,
    looks_like_program,
)


def write(path: Path, text: str, mode: int) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(mode)
    return path


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_programs_are_executable(tmp_path: Path) -> None:
    marked = write(tmp_path / "a.py", "", 0o755)
    idle = write(tmp_path / "b", "#!/usr/bin/env python3\n", 0o644)
    text = write(tmp_path / "c.txt", "", 0o644)
    assert [is_executable(each) for each in (marked, idle, text)] == [True, False, False]
    assert [looks_like_program(each) for each in (marked, idle, text)] == [True, True, False]
    assert has_shebang(idle) and not has_shebang(text) and not has_shebang(tmp_path / "none")
    assert not is_executable(tmp_path)


def test_program_may_be_named_with_its_folders(tmp_path: Path) -> None:
    first = write(tmp_path / "nodes" / "a.py", "", 0o755)
    second = write(tmp_path / "scripts" / "a.py", "", 0o755)
    write(tmp_path / ".git" / "a.py", "", 0o755)
    assert list(find_files(tmp_path, "a.py")) == [first, second]
    assert list(find_files(tmp_path, "scripts/a.py")) == [second]
    assert not list(find_files(tmp_path, "cripts/a.py"))
    assert not list(find_files(tmp_path / "none"))


@pytest.mark.skipif(os.name == "nt", reason="Windows lets few make links")
def test_files_behind_links_are_found_once(tmp_path: Path) -> None:
    shared = write(tmp_path / "shared" / "a.py", "", 0o755)
    package = tmp_path / "package"
    package.mkdir()
    (package / "scripts").symlink_to(shared.parent)
    (shared.parent / "again").symlink_to(package)
    assert list(find_files(package, "a.py")) == [package / "scripts" / "a.py"]


def package(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "package.xml").touch()
    return folder


def test_packages_are_found_at_any_depth_but_not_inside_packages(tmp_path: Path) -> None:
    first, second = package(tmp_path / "a"), package(tmp_path / "group" / "b")
    package(second / "within")
    assert list(find_packages(tmp_path)) == [first, second]


@pytest.mark.parametrize("name", ["CATKIN_IGNORE", "AMENT_IGNORE", "COLCON_IGNORE", ".catkin"])
def test_ignored_folders_are_skipped(tmp_path: Path, name: str) -> None:
    package(tmp_path / "a" / "b")
    (tmp_path / "a" / name).touch()
    assert not list(find_packages(tmp_path))


def test_hidden_folders_are_skipped(tmp_path: Path) -> None:
    package(tmp_path / ".git" / "a")
    assert not list(find_packages(tmp_path))


def test_packages_behind_links_are_found_without_circles(tmp_path: Path) -> None:
    elsewhere = package(tmp_path / "elsewhere" / "a").parent
    root = tmp_path / "src"
    root.mkdir()
    try:
        (root / "link").symlink_to(elsewhere)
        (root / "circle").symlink_to(root)
        (root / "itself").symlink_to(root / "itself")
    except OSError:
        pytest.skip("this system makes no links")
    assert list(find_packages(root)) == [root / "link" / "a"]


def test_missing_folder_has_no_packages(tmp_path: Path) -> None:
    assert not list(find_packages(tmp_path / "none"))


def test_package_behind_many_links_is_found_once(tmp_path: Path) -> None:
    packages = [package(tmp_path / name) for name in ("a", "b")]
    groups = [tmp_path / f"group{each}" for each in range(12)]
    try:
        for group in groups:
            group.mkdir()
            for other in (*packages, *groups):
                (group / other.name).symlink_to(other)
    except OSError:
        pytest.skip("this system makes no links")
    assert list(find_packages(tmp_path)) == packages
