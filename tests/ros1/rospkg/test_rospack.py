"""Packages, their folders and their dependencies."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import rospkg

MANIFEST = """<package format="2">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>A package.</description>
  <maintainer email="a@example.org">A</maintainer>
  <license>BSD</license>
  {depends}
</package>
"""


def write(folder: Path, *depends: str) -> Path:
    folder.mkdir(parents=True)
    tags = "".join(f"<depend>{each}</depend>" for each in depends)
    path = folder / "package.xml"
    path.write_text(MANIFEST.format(name=folder.name, depends=tags))
    return path


@pytest.fixture
def src(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "src"
    write(folder / "robot", "arm", "std_msgs")
    write(folder / "parts" / "arm", "hand", "arm_tools")
    write(folder / "parts" / "hand", "arm")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder))
    return folder


def test_packages_are_found(src: Path) -> None:
    packages = rospkg.RosPack()
    assert packages.get_path("arm") == str(src / "parts" / "arm")
    assert {"robot", "arm", "hand", "std_msgs"} <= set(packages.list())
    assert packages.ros_paths == [str(src)]
    assert packages.get_manifest("arm").version == "0.1.0"


def test_search_path_can_be_given(src: Path) -> None:
    packages = rospkg.RosPack.get_instance([str(src / "parts")])
    assert "robot" not in packages.list()
    assert packages.get_path("hand") == str(src / "parts" / "hand")


def test_unknown_package_is_an_error(src: Path) -> None:
    with pytest.raises(rospkg.ResourceNotFound, match=r"robots.*robot") as raised:
        rospkg.RosPack().get_path("robots")
    assert raised.value.ros_paths == [str(src)]
    with pytest.raises(rospkg.ResourceNotFound):
        rospkg.RosPack().get_depends("robots")


def test_dependencies_are_found(src: Path) -> None:
    packages = rospkg.RosPack()
    assert packages.get_depends("robot", implicit=False) == ["arm", "std_msgs"]
    assert packages.get_depends("robot") == ["arm", "std_msgs", "hand", "arm_tools"]
    assert packages.get_depends_on("hand") == ["arm", "robot"]
    assert packages.get_depends_on("hand", implicit=False) == ["arm"]


def test_error_names_the_invalid_manifest(src: Path) -> None:
    (src / "parts" / "hand" / "package.xml").write_text("<package><name>hand</name>")
    packages = rospkg.RosPack()
    with pytest.raises(rospkg.InvalidManifest, match=r"package\.xml"):
        packages.get_manifest("hand")
    assert packages.get_depends_on("std_msgs", implicit=False) == ["robot"]


def test_package_of_a_file_is_found(src: Path, tmp_path: Path) -> None:
    assert rospkg.get_package_name(str(src / "parts" / "arm" / "scripts" / "node.py")) == "arm"
    assert rospkg.get_package_name(os.sep) is None
