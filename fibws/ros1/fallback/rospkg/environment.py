"""ROS's environment variables."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

ROS_DISTRO = "ROS_DISTRO"
ROS_HOME = "ROS_HOME"
ROS_LOG_DIR = "ROS_LOG_DIR"
ROS_PACKAGE_PATH = "ROS_PACKAGE_PATH"
ROS_ROOT = "ROS_ROOT"
ROS_TEST_RESULTS_DIR = "ROS_TEST_RESULTS_DIR"


def get_ros_root(env: Mapping[str, str] | None = None) -> str | None:
    """Return $ROS_ROOT, which is rarely set."""
    return _environment(env).get(ROS_ROOT)


def get_ros_package_path(env: Mapping[str, str] | None = None) -> str | None:
    """Return $ROS_PACKAGE_PATH: folders that contain packages."""
    return _environment(env).get(ROS_PACKAGE_PATH)


def get_ros_home(env: Mapping[str, str] | None = None) -> str:
    """Return the folder for data of programs: $ROS_HOME, by default ``~/.ros``."""
    return _environment(env).get(ROS_HOME) or str(Path.home() / ".ros")


def get_log_dir(env: Mapping[str, str] | None = None) -> str:
    """Return the folder for logs: $ROS_LOG_DIR, by default ``log`` in `get_ros_home`."""
    return _environment(env).get(ROS_LOG_DIR) or str(Path(get_ros_home(env)) / "log")


def get_test_results_dir(env: Mapping[str, str] | None = None) -> str:
    """Return the folder for results of tests, $ROS_TEST_RESULTS_DIR.

    The default is ``test_results`` in `get_ros_home`.
    """
    found = _environment(env).get(ROS_TEST_RESULTS_DIR)
    return found or str(Path(get_ros_home(env)) / "test_results")


def get_ros_paths(env: Mapping[str, str] | None = None) -> list[str]:
    """Return the folders of `get_ros_package_path` as a list."""
    return [path for path in (get_ros_package_path(env) or "").split(os.pathsep) if path]


def _environment(env: Mapping[str, str] | None) -> Mapping[str, str]:
    return os.environ if env is None else env
