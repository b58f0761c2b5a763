"""Packages are where roslib says."""

from __future__ import annotations

from pathlib import Path

import pytest
import roslib.packages
import rospkg

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


def test_files_of_a_package_are_found(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    devel = package.parents[1] / "devel"
    monkeypatch.setenv("CMAKE_PREFIX_PATH", str(devel))
    built, source = devel / "lib" / "fibonacci" / "talker", package / "scripts" / "talker"
    for path in (built, source, package / "doc" / "talker"):
        path.parent.mkdir(parents=True)
        path.write_text("")
    built.chmod(0o755)
    source.chmod(0o755)
    assert roslib.packages.find_node("fibonacci", "talker") == [str(built), str(source)]
    assert len(roslib.packages.find_resource("fibonacci", "talker")) == 3
    assert roslib.packages.find_resource("fibonacci", "doc/talker") == [
        str(package / "doc" / "talker")
    ]
    assert roslib.packages.find_node("fibonacci", "nothing") == []
    with pytest.raises(rospkg.ResourceNotFound):
        roslib.packages.find_node("nothing", "talker")


def test_package_of_a_folder_is_found(package: Path) -> None:
    (package / "scripts").mkdir()
    found = (str(package.resolve()), "fibonacci")
    assert roslib.packages.get_dir_pkg(str(package / "scripts")) == found
    assert roslib.packages.get_dir_pkg(str(package)) == found
    assert roslib.packages.get_dir_pkg(str(package.parent)) == (None, None)
