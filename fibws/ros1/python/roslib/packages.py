"""The old way to ask where packages are; `rospkg` has the new one."""

from __future__ import annotations

import os
from pathlib import Path


class ROSPkgException(Exception):
    """The base of what goes wrong with packages."""


class InvalidROSPkgException(ROSPkgException):
    """There is no such package."""


def get_pkg_dir(
    package: str,
    required: bool = True,
    ros_root: str | None = None,
    ros_package_path: str | None = None,
) -> str | None:
    """The package's folder.

    Args:
        package: its name.
        required: whether it is an error if there is none; else None is returned.
        ros_root: is there for scripts that give it.
        ros_package_path: the folders to look in, if not those of $ROS_PACKAGE_PATH.

    Raises:
        InvalidROSPkgException: there is none.
    """
    from rospkg import ResourceNotFound, RosPack

    paths = None if ros_package_path is None else ros_package_path.split(os.pathsep)
    try:
        return str(RosPack(paths).get_path(package))
    except ResourceNotFound as error:
        if required:
            raise InvalidROSPkgException(f"cannot locate package: {error}") from None
        return None


def get_pkg_subdir(package: str, subdir: str, required: bool = True) -> str | None:
    """A folder in the package's, which is made if need be.

    Args:
        package: the package's name.
        subdir: the folder's.
        required: whether it is an error if there is no such package; else None is returned.

    Raises:
        InvalidROSPkgException: there is no such package.
    """
    folder = get_pkg_dir(package, required)
    if folder is None:
        return None
    path = Path(folder) / subdir
    path.mkdir(parents=True, exist_ok=True)
    return str(path)


def resource_file(package: str, subdir: str, resource_name: str) -> str:
    """The path of a file in a folder of a package.

    Raises:
        InvalidROSPkgException: there is no such package.
    """
    return str(Path(get_pkg_subdir(package, subdir) or "") / resource_name)
