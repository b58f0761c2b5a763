"""The command, variables and folder of a node's program."""

from __future__ import annotations

import shlex
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.model import LaunchNode
from fibws.ros1.launch.node_command import (
    MODULES,
    is_built_in,
    log_folder,
    node_command,
    node_variables,
    ros_home,
    shell_line,
)
from fibws.ros1.workspace.packages import Packages

from .packages import package

HUB = "ws://localhost:1234"


def node(**fields: Any) -> LaunchNode:
    return LaunchNode(
        **{"package": "robot", "type": "run.sh", "name": "n", **fields}, file="a", line=7
    )


@pytest.fixture
def packages(tmp_path: Path) -> Packages:
    return package(tmp_path, run_sh="#!/bin/sh\n", drive_py="", rosapi_py="")


def test_command_has_prefix_arguments_remaps_and_name(packages: Packages, tmp_path: Path) -> None:
    found = node_command(
        node(args="-x 'a b'", remaps=(("a", "/b"),), prefix="nice -n 5"), packages, HUB, {}
    )
    path = str(tmp_path / "robot/scripts/run.sh")
    assert found.command == ["nice", "-n", "5", path, "-x", "a b", "a:=/b", "__name:=n"]


def test_python_script_runs_in_this_python_with_rospy(packages: Packages, tmp_path: Path) -> None:
    found = node_command(node(type="drive.py"), packages, HUB, {})
    path = str(tmp_path / "robot/scripts/drive.py")
    assert found.command == [sys.executable, "-P", "-m", "fibws.rospy", path, "__name:=n"]


def test_environment_has_hub_namespace_and_own_variables(packages: Packages) -> None:
    base = {"PATH": "/bin", "ROS_NAMESPACE": "/mine", "A": "1"}
    found = node_command(
        node(namespace="/g", environment=(("A", "2"), ("B", "3"))), packages, HUB, base
    )
    assert found.environment == {
        "PATH": "/bin",
        "FIBWS_HUB": HUB,
        "ROS_NAMESPACE": "/g",
        "A": "2",
        "B": "3",
        "PYTHONUNBUFFERED": "1",
    }


def test_namespace_of_this_process_is_not_inherited() -> None:
    assert "ROS_NAMESPACE" not in node_variables(node(), HUB, {})
    assert node_variables(node(), HUB, {"ROS_NAMESPACE": "/mine"})["ROS_NAMESPACE"] == "/"
    assert "FIBWS_HUB" not in node_variables(node(), HUB, {"FIBWS_HUB": HUB})


def test_folder_is_ros_home_or_the_programs(packages: Packages, tmp_path: Path) -> None:
    base = {"ROS_HOME": str(tmp_path / "home")}
    assert node_command(node(), packages, HUB, base).folder == tmp_path / "home"
    assert node_command(node(cwd="node"), packages, HUB, base).folder == tmp_path / "robot/scripts"


def test_ros_home_and_log_folder(tmp_path: Path) -> None:
    assert ros_home({}) == Path.home() / ".ros"
    assert log_folder({}) == Path.home() / ".ros" / "log"
    assert log_folder({"ROS_HOME": "/r"}) == Path("/r/log")
    assert log_folder({"ROS_HOME": "/r", "ROS_LOG_DIR": "/l"}) == Path("/l")


@pytest.mark.parametrize(
    ("package_", "type_", "words"),
    [
        ("fibws", "broadcaster", ["-P", "-m", "fibws.broadcaster", "x", "__name:=n"]),
        (
            "tf2_ros",
            "static_transform_publisher",
            ["-P", "-m", "fibws.programs.static_transform_publisher", "x", "__name:=n"],
        ),
        ("rqt_graph", "rqt_graph", ["-P", "-m", "fibws", "open", "graph", "x", "__name:=n"]),
    ],
)
def test_programs_of_fibws_are_found(
    package_: str, type_: str, words: list[str], packages: Packages
) -> None:
    found = node_command(node(package=package_, type=type_, args="x"), packages, HUB, {})
    assert found.command == [sys.executable, *words]


def test_modules_of_fibws_exist() -> None:
    for module in MODULES.values():
        assert find_spec(module) is not None, module


def test_talker_of_the_tutorial_is_found(packages: Packages) -> None:
    found = node_command(node(package="rospy_tutorials", type="talker"), packages, HUB, {})
    assert found.command[-2:] == [found.command[-2], "__name:=n"]
    assert found.command[-2].endswith("talker.py")


def test_programs_that_are_part_of_the_hub(packages: Packages, tmp_path: Path) -> None:
    assert is_built_in(node(package="rosbridge_server"), packages)
    assert is_built_in(node(package="rosapi"), packages)
    assert not is_built_in(node(), packages)
    assert not is_built_in(node(package="rosapi"), package(tmp_path / "own", "rosapi"))


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"package": "robt"}, "a:7: <node n>: package 'robt' not found: "),
        ({"type": "rn.sh"}, "<node n>: no executable 'rn.sh' in package 'robot'"),
        ({"args": "'x"}, "<node n>: args: No closing quotation: 'x"),
        ({"prefix": "'x"}, "<node n>: No closing quotation"),
        ({"package": "rviz", "type": "rviz"}, "<node n>: rviz "),
        ({"package": "fibws", "type": "nope"}, "<node n>: package 'fibws' not found"),
    ],
)
def test_missing_program_is_an_error(
    fields: dict[str, str], error: str, packages: Packages
) -> None:
    with pytest.raises(LaunchError) as raised:
        node_command(node(**fields), packages, HUB, {})
    assert error in str(raised.value)


def test_shell_line(monkeypatch: pytest.MonkeyPatch) -> None:
    text = shell_line({"A": "1 2"}, ["run", "a b"])
    assert shlex.split(text) == ["A=1 2", "run", "a b"]
    monkeypatch.setattr("os.name", "nt")
    assert shell_line({"A": "1 2"}, ["run", "a b"]) == 'cmd /c "set A=1 2&& run "a b""'
