"""Finding packages: ``rospkg.RosPack().get_path("fibonacci")``.

Used only where PyPI's rospkg is not installed. It has the names that scripts use; rosdep needs
PyPI's.
"""

from __future__ import annotations

from rospkg.common import MANIFEST_FILE, ResourceNotFound
from rospkg.environment import (
    get_log_dir,
    get_ros_home,
    get_ros_package_path,
    get_ros_root,
    get_test_results_dir,
)
from rospkg.manifest import InvalidManifest
from rospkg.rospack import RosPack, get_package_name

__all__ = [
    "MANIFEST_FILE",
    "InvalidManifest",
    "ResourceNotFound",
    "RosPack",
    "get_log_dir",
    "get_package_name",
    "get_ros_home",
    "get_ros_package_path",
    "get_ros_root",
    "get_test_results_dir",
]
