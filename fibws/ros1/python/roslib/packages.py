"""Former functions for finding packages; use `rospkg` in new scripts."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

MANIFEST_FILE, PACKAGE_FILE = "manifest.xml", "package.xml"


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
    from fibws.ros1.errors import PackageNotFound
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


def get_dir_pkg(d: str) -> tuple[str, str] | tuple[None, None]:
    """Return the folder and the name of the package that a folder is in; twice None if it is not.

    The name is that of the folder.
    """
    folder = Path(d).resolve()
    for each in (folder, *folder.parents):
        if (each / MANIFEST_FILE).exists() or (each / PACKAGE_FILE).exists():
            return str(each), each.name
    return None, None


def find_resource(
    pkg: str,
    resource_name: str,
    filter_fn: Callable[[str], object] | None = None,
    rospack: Any = None,
) -> list[str]:
    """Return the paths of a package's files of one name, those that catkin_make has built first.

    Args:
        pkg: the package's name.
        resource_name: the file's name, perhaps with folders.
        filter_fn: returns whether a path is wanted.
        rospack: the `rospkg.RosPack` to ask; by default a new one.

    Raises:
        ResourceNotFound: the package is unknown.
    """
    import rospkg

    from fibws.ros1.workspace.discovery import find_files
    from fibws.ros1.workspace.packages import PREFIXES

    folder = (rospack or rospkg.RosPack()).get_path(pkg)
    prefixes = filter(None, os.environ.get(PREFIXES, "").split(os.pathsep))
    built = [Path(prefix) / kind / pkg for prefix in prefixes for kind in ("lib", "share")]
    paths = (
        str(path) for place in (*built, Path(folder)) for path in find_files(place, resource_name)
    )
    return list(dict.fromkeys(each for each in paths if filter_fn is None or filter_fn(each)))


def find_node(pkg: str, node_type: str, rospack: Any = None) -> list[str]:
    """Return the paths of a package's programs of one name.

    Raises:
        ResourceNotFound: the package is unknown.
    """
    return find_resource(pkg, node_type, lambda path: os.access(path, os.X_OK), rospack)
