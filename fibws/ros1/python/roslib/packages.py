"""Former functions for finding packages; use `rospkg` in new scripts."""

from __future__ import annotations

import os
from pathlib import Path


class ROSPkgException(Exception):
    """The base of errors about packages."""


class InvalidROSPkgException(ROSPkgException):
    """The package is unknown."""


def get_pkg_dir(
    package: str,
    required: bool = True,
    ros_root: str | None = None,
    ros_package_path: str | None = None,
) -> str | None:
    """Return the folder of a package.

    Args:
        package: its name.
        required: raise an error if the package is unknown; otherwise return None.
        ros_root: has no effect.
        ros_package_path: the folders to search; by default $ROS_PACKAGE_PATH.

    Raises:
        InvalidROSPkgException: the package is unknown.
    """
    from fibws.errors import PackageNotFound
    from fibws.ros1.workspace.packages import PATH, Packages

    path = os.environ.get(PATH, "") if ros_package_path is None else ros_package_path
    folders = [Path(folder) for folder in path.split(os.pathsep) if folder]
    try:
        return str(Packages(folders, here=Path.cwd()).find(package).folder)
    except PackageNotFound as error:
        if required:
            raise InvalidROSPkgException(f"cannot locate package: {error}") from None
        return None


def get_pkg_subdir(package: str, subdir: str, required: bool = True) -> str | None:
    """Return a folder in that of a package; create it if it is missing.

    Args:
        package: the package's name.
        subdir: the folder's path in it.
        required: raise an error if the package is unknown; otherwise return None.

    Raises:
        InvalidROSPkgException: the package is unknown.
    """
    folder = get_pkg_dir(package, required)
    if folder is None:
        return None
    path = Path(folder) / subdir
    path.mkdir(parents=True, exist_ok=True)
    return str(path)


def resource_file(package: str, subdir: str, resource_name: str) -> str:
    """Return the path of a file in a folder of a package.

    Raises:
        InvalidROSPkgException: the package is unknown.
    """
    return str(Path(get_pkg_subdir(package, subdir) or "") / resource_name)
