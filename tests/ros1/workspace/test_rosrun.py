"""What rosrun starts."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from fibws.errors import ExecutableNotFound, PackageNotFound, WorkspaceError
from fibws.ros1.workspace.packages import Packages
from fibws.ros1.workspace.rosrun import command_line

from .conftest import Layout

PROGRAM = "#!/bin/sh\n"


def test_a_program_of_a_package_is_started_with_its_folder_told(layout: Layout) -> None:
    folder = layout.package("robot", programs={"scripts/run.sh": PROGRAM}) / "scripts"
    packages = Packages([layout.source])
    found = command_line(packages, "robot", "run.sh", ["x", "a:=b"])
    assert found == ([str(folder / "run.sh"), "x", "a:=b"], folder)


def test_some_of_ros_own_programs_are_there() -> None:
    command, folder = command_line(Packages([]), "rqt_graph", "rqt_graph", ["x"])
    assert command == [sys.executable, "-P", "-m", "fibws", "open", "graph", "x"]
    assert folder == Path.cwd()


def test_a_workspaces_package_comes_before_one_of_ros_own(layout: Layout) -> None:
    folder = layout.package("turtlesim", programs={"turtlesim_node": PROGRAM})
    packages = Packages([layout.source])
    found, _ = command_line(packages, "turtlesim", "turtlesim_node", [])
    assert found == [str(folder / "turtlesim_node")]
    with pytest.raises(ExecutableNotFound):
        command_line(packages, "turtlesim", "turtle_teleop_key", [])


def test_what_is_not_there_is_an_error() -> None:
    with pytest.raises(WorkspaceError, match="turtlesim"):
        command_line(Packages([]), "turtlesim", "turtlesim_node", [])
    with pytest.raises(PackageNotFound, match="'qwertz' not found"):
        command_line(Packages([]), "qwertz", "node", [])
