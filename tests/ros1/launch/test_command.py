"""How a node's program is started."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Any

import pytest

from fibws.errors import LaunchError
from fibws.ros1.launch.command import (
    hub_does_it,
    log_folder,
    ros_home,
    shown,
    start_of,
    variables_of,
)
from fibws.ros1.launch.model import Node
from fibws.ros1.workspace.packages import Packages

from .packages import package

HUB = "ws://localhost:1234"


def node(**fields: Any) -> Node:
    return Node(**{"package": "robot", "type": "run.sh", "name": "n", **fields}, file="a", line=7)


@pytest.fixture
def packages(tmp_path: Path) -> Packages:
    return package(tmp_path, run_sh="#!/bin/sh\n", drive_py="", rosapi_py="")


def test_a_program_is_given_its_arguments_remaps_and_name(
    packages: Packages, tmp_path: Path
) -> None:
    start = start_of(
        node(args="-x 'a b'", remaps=(("a", "/b"),), prefix="nice -n 5"), packages, HUB, {}
    )
    path = str(tmp_path / "robot/scripts/run.sh")
    assert start.command == ["nice", "-n", "5", path, "-x", "a b", "a:=/b", "__name:=n"]


def test_a_python_script_gets_this_python_and_rospy(packages: Packages, tmp_path: Path) -> None:
    start = start_of(node(type="drive.py"), packages, HUB, {})
    path = str(tmp_path / "robot/scripts/drive.py")
    assert start.command == [sys.executable, "-P", "-m", "fibws.rospy", path, "__name:=n"]


def test_a_node_has_its_hub_its_namespace_and_its_own_variables(packages: Packages) -> None:
    base = {"PATH": "/bin", "ROS_NAMESPACE": "/mine", "A": "1"}
    start = start_of(
        node(namespace="/g", environment=(("A", "2"), ("B", "3"))), packages, HUB, base
    )
    assert start.environment == {
        "PATH": "/bin",
        "FIBWS_HUB": HUB,
        "ROS_NAMESPACE": "/g",
        "A": "2",
        "B": "3",
        "PYTHONUNBUFFERED": "1",
    }


def test_the_namespace_of_whoever_launches_is_not_that_of_a_node() -> None:
    assert "ROS_NAMESPACE" not in variables_of(node(), HUB, {})
    assert variables_of(node(), HUB, {"ROS_NAMESPACE": "/mine"})["ROS_NAMESPACE"] == "/"
    assert "FIBWS_HUB" not in variables_of(node(), HUB, {"FIBWS_HUB": HUB})


def test_a_node_runs_in_ros_home_or_where_its_program_is(
    packages: Packages, tmp_path: Path
) -> None:
    base = {"ROS_HOME": str(tmp_path / "home")}
    assert start_of(node(), packages, HUB, base).folder == tmp_path / "home"
    assert start_of(node(cwd="node"), packages, HUB, base).folder == tmp_path / "robot/scripts"


def test_folders_are_those_of_ros(tmp_path: Path) -> None:
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
            ["-P", "-m", "fibws.tf.static_transform_publisher", "x", "__name:=n"],
        ),
        ("rqt_graph", "rqt_graph", ["-P", "-m", "fibws", "open", "graph", "x", "__name:=n"]),
    ],
)
def test_programs_of_fibws_are_there(
    package_: str, type_: str, words: list[str], packages: Packages
) -> None:
    start = start_of(node(package=package_, type=type_, args="x"), packages, HUB, {})
    assert start.command == [sys.executable, *words]


def test_the_tutorials_talker_is_there(packages: Packages) -> None:
    start = start_of(node(package="rospy_tutorials", type="talker"), packages, HUB, {})
    assert start.command[-2:] == [start.command[-2], "__name:=n"]
    assert start.command[-2].endswith("talker.py")


def test_what_the_hub_does_needs_no_start(packages: Packages, tmp_path: Path) -> None:
    assert hub_does_it(node(package="rosbridge_server"), packages)
    assert hub_does_it(node(package="rosapi"), packages)
    assert not hub_does_it(node(), packages)
    assert not hub_does_it(node(package="rosapi"), package(tmp_path / "own", "rosapi"))


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"package": "robt"}, "a:7: <node n>: package 'robt' not found: "),
        ({"type": "rn.sh"}, "<node n>: no executable 'rn.sh' in package 'robot': did you mean run"),
        ({"args": "'x"}, "<node n>: args: No closing quotation: 'x"),
        ({"prefix": "'x"}, "<node n>: No closing quotation"),
        ({"package": "turtlesim", "type": "turtlesim_node"}, "<node n>: turtlesim opens a window"),
        ({"package": "fibws", "type": "nope"}, "<node n>: package 'fibws' not found"),
    ],
)
def test_a_program_that_is_not_there_is_an_error(
    fields: dict[str, str], error: str, packages: Packages
) -> None:
    with pytest.raises(LaunchError) as raised:
        start_of(node(**fields), packages, HUB, {})
    assert error in str(raised.value)


def test_a_command_can_be_typed_into_a_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    text = shown({"A": "1 2"}, ["run", "a b"])
    assert shlex.split(text) == ["A=1 2", "run", "a b"]
    monkeypatch.setattr("os.name", "nt")
    assert shown({"A": "1 2"}, ["run", "a b"]) == 'cmd /c "set A=1 2&& run "a b""'
