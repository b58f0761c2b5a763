"""Packages and programs, as rospack and rosrun find them."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from fibws.ros1.errors import ExecutableNotFound, PackageNotFound, WorkspaceError
from fibws.ros1.workspace.packages import Packages, rosrun_command

from .conftest import Layout

PROGRAM = "#!/usr/bin/env python3\n"


def known(layout: Layout) -> Packages:
    return Packages([layout.source], [layout.devel])


def test_packages_are_found_by_the_name_in_package_xml(layout: Layout) -> None:
    folder = layout.package("fibonacci", folder="somewhere/else")
    package = known(layout).find("fibonacci")
    assert (package.folder, package.manifest.version) == (folder, "1.2.3")
    assert not package.is_standard


def test_first_of_two_packages_of_one_name_counts(tmp_path: Path) -> None:
    first, second = Layout(tmp_path / "a"), Layout(tmp_path / "b")
    folder = first.package("fibonacci")
    second.package("fibonacci")
    assert Packages([first.source, second.source]).find("fibonacci").folder == folder


def test_packages_of_fibws_are_always_found() -> None:
    packages = Packages([])
    assert {"std_msgs", "rospy", "sensor_msgs"} <= set(packages.names())
    assert packages.find("std_msgs").is_standard
    assert (packages.find("std_msgs").folder / "msg" / "Int32.msg").is_file()
    assert packages.find("std_msgs").manifest.direct == []


def test_package_of_a_workspace_replaces_one_of_fibws(layout: Layout) -> None:
    folder = layout.package("std_msgs")
    assert known(layout).find("std_msgs").folder == folder


def test_packages_are_found_by_the_environment(layout: Layout, tmp_path: Path) -> None:
    layout.package("fibonacci")
    path = os.pathsep.join([str(tmp_path / "none"), "", str(layout.source)])
    packages = Packages.from_environment(environment={"ROS_PACKAGE_PATH": path})
    assert packages.find("fibonacci").name == "fibonacci"


def test_workspace_that_is_not_sourced_may_be_given(layout: Layout, tmp_path: Path) -> None:
    layout.package("fibonacci")
    packages = Packages.from_environment(layout.folder, environment={})
    assert packages.find("fibonacci").name == "fibonacci"
    with pytest.raises(WorkspaceError, match="is not a workspace"):
        Packages.from_environment(tmp_path, environment={})


def test_executable_files_in_the_folder_are_programs(layout: Layout) -> None:
    folder = layout.package("fibonacci", programs={"src/node.py": PROGRAM})
    assert known(layout).executable("fibonacci", "node.py") == folder / "src" / "node.py"
    assert known(layout).programs(known(layout).find("fibonacci")) == ["node.py"]


def test_programs_in_devel_come_first(layout: Layout) -> None:
    layout.package("fibonacci", programs={"src/node.py": PROGRAM})
    built = layout.devel / "lib" / "fibonacci" / "node.py"
    built.parent.mkdir(parents=True)
    built.write_text(PROGRAM)
    built.chmod(0o755)
    assert known(layout).executable("fibonacci", "node.py") == built


def test_two_programs_of_one_name_are_an_error(layout: Layout) -> None:
    folder = layout.package("a", programs={"src/node.py": PROGRAM, "scripts/node.py": PROGRAM})
    with pytest.raises(ExecutableNotFound, match=r"there are 2.*: scripts/node\.py, src/node\.py"):
        known(layout).executable("a", "node.py")
    assert known(layout).executable("a", "src/node.py") == folder / "src" / "node.py"


def test_links_to_a_program_do_not_count(layout: Layout) -> None:
    folder = layout.package("a", programs={"src/node.py": PROGRAM})
    try:
        (folder / "bin").symlink_to(folder / "src")
        (folder / "src" / "deeper").mkdir()
        (folder / "src" / "deeper" / "node.py").symlink_to(folder / "src" / "node.py")
    except OSError:
        pytest.skip("this system makes no links")
    assert known(layout).executable("a", "node.py").name == "node.py"


def test_unknown_package_is_an_error() -> None:
    with pytest.raises(PackageNotFound, match="package 'qwertz' not found") as error:
        Packages([]).find("qwertz")
    assert error.value.name == "qwertz"


def test_common_package_that_is_missing_is_an_error_with_the_way_out() -> None:
    with pytest.raises(PackageNotFound, match="ros-teleop/teleop_twist_keyboard into"):
        rosrun_command(Packages([]), "teleop_twist_keyboard", "teleop_twist_keyboard.py", [])
    with pytest.raises(PackageNotFound, match=r"'gazebo_ros' not found: it is in C\+\+.* --ros1"):
        Packages([]).find("gazebo_ros")
    with pytest.raises(WorkspaceError, match=r"move_base is in C\+\+.* --ros1"):
        rosrun_command(Packages([]), "move_base", "move_base", [])
    with pytest.raises(WorkspaceError, match="page"):
        rosrun_command(Packages([]), "rviz", "rviz", [])


def test_rosrun_starts_a_program_in_its_folder(layout: Layout) -> None:
    folder = layout.package("robot", programs={"scripts/run.sh": "#!/bin/sh\n"}) / "scripts"
    found = rosrun_command(known(layout), "robot", "run.sh", ["x", "a:=b"])
    assert found == ([str(folder / "run.sh"), "x", "a:=b"], folder)


def test_rosrun_replaces_some_programs_of_ros() -> None:
    command, folder = rosrun_command(Packages([]), "rqt_graph", "rqt_graph", ["x"])
    assert command == [sys.executable, "-P", "-m", "fibws", "open", "graph", "x"]
    assert folder == Path.cwd()


def test_rosrun_prefers_a_package_of_a_workspace(layout: Layout) -> None:
    folder = layout.package("turtlesim", programs={"turtlesim_node": "#!/bin/sh\n"})
    found, _ = rosrun_command(known(layout), "turtlesim", "turtlesim_node", [])
    assert found == [str(folder / "turtlesim_node")]
    with pytest.raises(ExecutableNotFound):
        rosrun_command(known(layout), "turtlesim", "turtle_teleop_key", [])


def test_rosrun_reports_programs_that_do_not_exist() -> None:
    with pytest.raises(WorkspaceError, match="rviz"):
        rosrun_command(Packages([]), "rviz", "rviz", [])
    with pytest.raises(PackageNotFound, match="'qwertz' not found"):
        rosrun_command(Packages([]), "qwertz", "x", [])


def install(prefix: Path, package: str, program: str) -> Path:
    """Install a program as an installed ROS has it."""
    path = prefix / "lib" / package / program
    path.parent.mkdir(parents=True)
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    (prefix / "share" / package).mkdir(parents=True)
    return path


def test_programs_of_an_installed_ros_are_found(layout: Layout, tmp_path: Path) -> None:
    relay = install(tmp_path / "ros", "topic_tools", "relay")
    folder = layout.package("fibonacci", programs={"src/node": PROGRAM})
    install(tmp_path / "ros", "fibonacci", "node")
    packages = Packages([layout.source], installed=[tmp_path / "none", tmp_path / "ros"])
    assert packages.executable("topic_tools", "relay") == relay
    assert packages.executable("fibonacci", "node") == folder / "src" / "node"
    with pytest.raises(ExecutableNotFound):
        packages.executable("topic_tools", "mux")


def test_prefix_of_an_installed_package_path_is_searched(tmp_path: Path) -> None:
    relay = install(tmp_path / "ros", "topic_tools", "relay")
    environment = {"ROS_PACKAGE_PATH": str(tmp_path / "ros" / "share")}
    packages = Packages.from_environment(environment=environment)
    assert packages.executable("topic_tools", "relay") == relay


def test_installed_program_is_started_if_fibws_has_no_substitute(tmp_path: Path) -> None:
    rviz = install(tmp_path / "ros", "rviz", "rviz")
    packages = Packages([], installed=[tmp_path / "ros"])
    line, folder = rosrun_command(packages, "rviz", "rviz", ["-d", "my.rviz"])
    assert (line, folder) == ([str(rviz), "-d", "my.rviz"], rviz.parent)
    with pytest.raises(WorkspaceError, match="opens a window"):
        rosrun_command(Packages([]), "rviz", "rviz", [])
