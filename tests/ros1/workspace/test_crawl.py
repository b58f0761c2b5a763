"""Where packages are found."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.workspace.crawl import find_folders


def package(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "package.xml").touch()
    return folder


def test_packages_are_found_at_any_depth_but_not_in_each_other(tmp_path: Path) -> None:
    first, second = package(tmp_path / "a"), package(tmp_path / "group" / "b")
    package(second / "within")
    assert list(find_folders(tmp_path)) == [first, second]


@pytest.mark.parametrize("name", ["CATKIN_IGNORE", "AMENT_IGNORE", "COLCON_IGNORE", ".catkin"])
def test_a_folder_may_ask_to_be_passed_over(tmp_path: Path, name: str) -> None:
    package(tmp_path / "a" / "b")
    (tmp_path / "a" / name).touch()
    assert not list(find_folders(tmp_path))


def test_hidden_folders_are_passed_over(tmp_path: Path) -> None:
    package(tmp_path / ".git" / "a")
    assert not list(find_folders(tmp_path))


def test_links_are_followed_but_not_in_circles(tmp_path: Path) -> None:
    elsewhere = package(tmp_path / "elsewhere" / "a").parent
    root = tmp_path / "src"
    root.mkdir()
    try:
        (root / "link").symlink_to(elsewhere)
        (root / "circle").symlink_to(root)
        (root / "itself").symlink_to(root / "itself")
    except OSError:
        pytest.skip("this system makes no links")
    assert list(find_folders(root)) == [root / "link" / "a"]


def test_where_there_is_nothing_nothing_is_found(tmp_path: Path) -> None:
    assert not list(find_folders(tmp_path / "none"))


def test_a_package_that_links_lead_to_is_found_once(tmp_path: Path) -> None:
    packages = [package(tmp_path / name) for name in ("a", "b")]
    groups = [tmp_path / f"group{each}" for each in range(12)]
    try:
        for group in groups:
            group.mkdir()
            for other in (*packages, *groups):
                (group / other.name).symlink_to(other)
    except OSError:
        pytest.skip("this system makes no links")
    assert list(find_folders(tmp_path)) == packages
