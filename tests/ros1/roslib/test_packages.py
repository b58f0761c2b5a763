"""Packages are where roslib says."""

from __future__ import annotations

from pathlib import Path

import pytest
import roslib.packages

XML = """\
<package format="2"><name>fibonacci</name><version>0.0.0</version>
<description>Numbers</description><maintainer email="a@b.c">A</maintainer><license>BSD</license>
</package>
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "src" / "fibonacci"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(XML)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.chdir(tmp_path)
    return folder


def test_package_folder_is_found(package: Path) -> None:
    assert roslib.packages.get_pkg_dir("fibonacci") == str(package)
    paths = str(package.parent)
    assert roslib.packages.get_pkg_dir("fibonacci", ros_package_path=paths) == str(package)


def test_missing_subfolder_is_created(package: Path) -> None:
    assert roslib.packages.get_pkg_subdir("fibonacci", "config") == str(package / "config")
    assert (package / "config").is_dir()
    path = roslib.packages.resource_file("fibonacci", "config", "a.yaml")
    assert path == str(package / "config" / "a.yaml")


def test_unknown_package_is_an_error(package: Path) -> None:
    assert roslib.packages.get_pkg_dir("fibonaci", required=False) is None
    assert roslib.packages.get_pkg_subdir("fibonaci", "config", required=False) is None
    with pytest.raises(
        roslib.packages.InvalidROSPkgException, match=r"cannot locate package: .*fibonaci"
    ):
        roslib.packages.get_pkg_dir("fibonaci")
