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


def test_the_folder_of_a_package(package: Path) -> None:
    assert roslib.packages.get_pkg_dir("fibonacci") == str(package)
    paths = str(package.parent)
    assert roslib.packages.get_pkg_dir("fibonacci", ros_package_path=paths) == str(package)


def test_a_folder_in_it_is_made_if_need_be(package: Path) -> None:
    assert roslib.packages.get_pkg_subdir("fibonacci", "config") == str(package / "config")
    assert (package / "config").is_dir()
    path = roslib.packages.resource_file("fibonacci", "config", "a.yaml")
    assert path == str(package / "config" / "a.yaml")


def test_a_package_that_is_not_there(package: Path) -> None:
    assert roslib.packages.get_pkg_dir("fibonaci", required=False) is None
    assert roslib.packages.get_pkg_subdir("fibonaci", "config", required=False) is None
    with pytest.raises(
        roslib.packages.InvalidROSPkgException, match=r"cannot locate package: .*fibonaci"
    ):
        roslib.packages.get_pkg_dir("fibonaci")
