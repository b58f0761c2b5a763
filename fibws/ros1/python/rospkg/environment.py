"""What the environment says about ROS."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path


def get_ros_root(env: Mapping[str, str] | None = None) -> str | None:
    """Where ROS is, by $ROS_ROOT: nowhere, most likely."""
    return _environment(env).get("ROS_ROOT")


def get_ros_package_path(env: Mapping[str, str] | None = None) -> str | None:
    """The folders with packages in them, as $ROS_PACKAGE_PATH has them."""
    return _environment(env).get("ROS_PACKAGE_PATH")


def get_ros_home(env: Mapping[str, str] | None = None) -> str:
    """The folder for what programs keep: $ROS_HOME, or else ``.ros`` in the user's own."""
    return _environment(env).get("ROS_HOME") or str(Path.home() / ".ros")


def get_log_dir(env: Mapping[str, str] | None = None) -> str:
    """The folder for logs: $ROS_LOG_DIR, or else ``log`` in `get_ros_home`."""
    return _environment(env).get("ROS_LOG_DIR") or str(Path(get_ros_home(env)) / "log")


def get_ros_paths(env: Mapping[str, str] | None = None) -> list[str]:
    """The folders of `get_ros_package_path`, one by one."""
    return [path for path in (get_ros_package_path(env) or "").split(os.pathsep) if path]


def _environment(env: Mapping[str, str] | None) -> Mapping[str, str]:
    return os.environ if env is None else env
