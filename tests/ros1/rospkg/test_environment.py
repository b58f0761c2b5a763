"""Environment variables of ROS."""

from __future__ import annotations

import os
from pathlib import Path

import rospkg
from rospkg.environment import get_ros_paths


def test_folders_come_from_the_environment() -> None:
    env = {"ROS_HOME": "/h", "ROS_ROOT": "/r", "ROS_PACKAGE_PATH": f"/a{os.pathsep}/b"}
    assert rospkg.get_ros_home(env) == "/h"
    assert rospkg.get_log_dir(env) == str(Path("/h/log"))
    assert rospkg.get_log_dir({**env, "ROS_LOG_DIR": "/l"}) == "/l"
    assert rospkg.get_ros_root(env) == "/r"
    assert rospkg.get_ros_package_path(env) == f"/a{os.pathsep}/b"
    assert get_ros_paths(env) == ["/a", "/b"]


def test_folders_default_to_the_home_folder() -> None:
    assert rospkg.get_ros_home({}) == str(Path.home() / ".ros")
    assert rospkg.get_ros_root({}) is None
    assert get_ros_paths({}) == []
    assert rospkg.get_ros_package_path() == os.environ.get("ROS_PACKAGE_PATH")
