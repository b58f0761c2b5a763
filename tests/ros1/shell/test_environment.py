"""The environment variables that ``fibws setup`` sets and restores."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from fibws.command_names import SETUP
from fibws.ros1.shell import environment
from fibws.ros1.shell.environment import BIN_FOLDER, OF_ROS, PYTHON, PYTHON_FOLDER, Changes

PATH = os.pathsep.join(["/usr/local/bin", "/usr/bin"])


def after(environ: dict[str, str], changes: Changes) -> dict[str, str]:
    """Return the variables with changes applied."""
    changed = {**environ, **changes}
    return {name: value for name, value in changed.items() if value is not None}


def set_up(environ: dict[str, str]) -> dict[str, str]:
    return after(environ, environment.set_up(environ))


def undone(environ: dict[str, str]) -> dict[str, str]:
    return after(environ, environment.undo(environ))


def test_commands_and_modules_come_first_on_their_paths() -> None:
    found = set_up({"PATH": PATH, "PYTHONPATH": "/own"})
    assert found["PATH"] == f"{BIN_FOLDER}{os.pathsep}{PATH}"
    assert found["PYTHONPATH"] == f"{PYTHON_FOLDER}{os.pathsep}/own"
    assert found[PYTHON] == sys.executable
    assert {name: found[name] for name in OF_ROS} == OF_ROS


def test_path_that_was_not_set_has_no_empty_part() -> None:
    assert set_up({"PATH": PATH})["PYTHONPATH"] == str(PYTHON_FOLDER)


def test_second_setup_changes_nothing() -> None:
    once = set_up({"PATH": PATH})
    assert set_up(once) == once


@pytest.mark.parametrize(
    "before",
    [
        {"PATH": PATH},
        {"PATH": f"{PATH}{os.pathsep}", "PYTHONPATH": "/own", "HOME": "/home/me"},
        {"PATH": PATH, "ROS_DISTRO": "humble", "ROS_VERSION": "2", "FIBWS_PYTHON": "python9"},
    ],
)
def test_undo_restores_the_variables(before: dict[str, str]) -> None:
    assert undone(set_up(before)) == before
    assert undone(set_up(set_up(before))) == before


def test_undo_keeps_folders_added_after_setup() -> None:
    environ = set_up({"PATH": PATH})
    environ["PATH"] = os.pathsep.join(["/new/bin", environ["PATH"]])
    environ["PYTHONPATH"] = os.pathsep.join(["/new/modules", environ["PYTHONPATH"]])
    assert undone(environ) == {
        "PATH": os.pathsep.join(["/new/bin", PATH]),
        "PYTHONPATH": "/new/modules",
    }


def test_undo_removes_workspaces_and_keeps_other_folders() -> None:
    environ = set_up({"PATH": PATH})
    workspace = {"PYTHONPATH": "/ws/devel/lib", "ROS_PACKAGE_PATH": "/ws/src", "CMAKE": "/ws/devel"}
    environ["PYTHONPATH"] = os.pathsep.join(["/ws/devel/lib", environ["PYTHONPATH"]])
    environ["ROS_PACKAGE_PATH"] = os.pathsep.join(["/own/src", "/ws/src"])
    environ["CMAKE"] = "/ws/devel"
    besides = [(name, Path(folder)) for name, folder in workspace.items()]
    changes = environment.undo(environ, besides)
    assert after(environ, changes) == {"PATH": PATH, "ROS_PACKAGE_PATH": "/own/src"}


def test_undo_without_setup_changes_nothing() -> None:
    assert undone({"PATH": PATH, "ROS_DISTRO": "humble"}) == {"PATH": PATH, "ROS_DISTRO": "humble"}


def test_other_installation_of_fibws_is_replaced() -> None:
    other = "/venv/lib/python3.12/site-packages/fibws/ros1"
    environ = set_up({"PATH": f"{other}/bin{os.pathsep}{PATH}", "PYTHONPATH": f"{other}/python"})
    assert environ["PATH"] == f"{BIN_FOLDER}{os.pathsep}{PATH}"
    assert environ["PYTHONPATH"] == str(PYTHON_FOLDER)


@pytest.mark.parametrize("record", ["", "{", "[]", "8"])
def test_invalid_record_is_ignored(record: str) -> None:
    environ = {"PATH": PATH, SETUP: record}
    assert undone(environ) == {"PATH": PATH}


@pytest.fixture
def roscore(tmp_path: Path) -> Path:
    """The roscore of an installed ROS."""
    program = tmp_path / "noetic" / ("roscore.bat" if os.name == "nt" else "roscore")
    program.parent.mkdir()
    program.touch(mode=0o755)
    return program


def test_other_ros_is_found_by_its_roscore(roscore: Path) -> None:
    environ = {"PATH": str(roscore.parent)}
    assert environment.other_ros(environ) == f"found {roscore}"
    assert environment.other_ros({"PATH": str(roscore.parent.parent)}) is None


def test_roscore_of_fibws_is_not_another_ros() -> None:
    assert environment.other_ros({"PATH": str(BIN_FOLDER)}) is None


@pytest.mark.parametrize("name", ["ROS_ROOT", "ROS_DISTRO"])
def test_other_ros_is_found_by_its_variables(name: str) -> None:
    assert environment.other_ros({"PATH": "", name: "kinetic"}) == f"{name} is kinetic"


def test_variables_of_fibws_are_not_another_ros() -> None:
    assert environment.other_ros(set_up({"PATH": ""})) is None


def test_all_commands_in_a_folder_of_ros_remain_that_fibws_does_not_have(roscore: Path) -> None:
    for name in ("rostopic", "rviz", "image_saver"):
        (roscore.parent / name).touch(mode=0o755)
    (roscore.parent / "notes.txt").touch(mode=0o644)
    environ = set_up({"PATH": str(roscore.parent)})
    assert environment.unreplaced_commands(environ) == ["rviz"]
    (roscore.parent.parent / "_setup_util.py").touch()
    assert environment.unreplaced_commands(environ) == ["image_saver", "rviz"]


def test_commands_of_folders_without_a_roscore_are_not_of_ros(tmp_path: Path) -> None:
    (tmp_path / "rviz").touch(mode=0o755)
    assert environment.unreplaced_commands({"PATH": str(tmp_path)}) == []
    assert environment.unreplaced_commands({"PATH": str(BIN_FOLDER)}) == []


def test_record_with_invalid_values_sets_nothing() -> None:
    record = '{"ROS_DISTRO": 5, "FIBWS_PYTHON": ["a"], "PATH": "/x"}'
    changes = environment.undo({"FIBWS_SETUP": record})
    assert changes["ROS_DISTRO"] is None and changes["FIBWS_PYTHON"] is None
    assert changes["PATH"] is None
