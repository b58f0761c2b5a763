"""Packages, their folders and their dependencies."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

from fibws.ros1.errors import PackageFileError, PackageNotFound
from fibws.ros1.workspace.package_xml import Manifest
from fibws.ros1.workspace.packages import Package, Packages
from rospkg.common import MANIFEST_FILE, ResourceNotFound
from rospkg.environment import get_ros_paths
from rospkg.manifest import InvalidManifest

Names: TypeAlias = list[str]
"""Needed because `RosPack` has a method named ``list``."""


class RosPack:
    """The packages in $ROS_PACKAGE_PATH, and those of fibws.

    Args:
        ros_paths: folders that contain packages, instead of $ROS_PACKAGE_PATH.
    """

    def __init__(self, ros_paths: Sequence[str] | None = None) -> None:
        self.ros_paths = get_ros_paths() if ros_paths is None else list(ros_paths)
        self._packages = Packages([Path(path) for path in self.ros_paths], here=Path.cwd())

    @classmethod
    def get_instance(cls, ros_paths: Sequence[str] | None = None) -> RosPack:
        """Return a new instance; here nothing is cached."""
        return cls(ros_paths)

    def list(self) -> Names:
        """Return the names of all packages."""
        return self._packages.names()

    def get_path(self, name: str) -> str:
        """Return the folder of a package.

        Raises:
            ResourceNotFound: the package is unknown.
        """
        return str(self._find(name).folder)

    def get_manifest(self, name: str) -> Manifest:
        """Return the contents of a package's package.xml.

        Raises:
            ResourceNotFound: the package is unknown.
            InvalidManifest: the file is invalid.
        """
        with _read():
            return self._find(name).manifest

    def get_depends(self, name: str, implicit: bool = True) -> Names:
        """Return the names of the packages that a package depends on.

        Args:
            name: the package.
            implicit: include the dependencies of dependencies, as far as they are known here.

        Raises:
            ResourceNotFound: the package is unknown.
            InvalidManifest: its package.xml is invalid, or that of a dependency.
        """
        found: dict[str, None] = {}
        waiting = _needs(self.get_manifest(name))
        while waiting:
            each = waiting.pop(0)
            if each in found:
                continue
            found[each] = None
            if implicit and self._packages.has(each):
                waiting += _needs(self.get_manifest(each))
        return [*found]

    def get_depends_on(self, name: str, implicit: bool = True) -> Names:
        """Return the packages that depend on a package; skip those with an invalid package.xml."""
        found = []
        for each in self._packages.names():
            try:
                if each != name and name in self.get_depends(each, implicit):
                    found.append(each)
            except InvalidManifest:
                continue
        return found

    def _find(self, name: str) -> Package:
        try:
            return self._packages.find(name)
        except PackageNotFound as error:
            raise ResourceNotFound(str(error), self.ros_paths) from None


def get_package_name(path: str) -> str | None:
    """Return the name of the package that contains a file or a folder, or None.

    Raises:
        InvalidManifest: the package.xml is invalid.
    """
    inside = Path(os.path.abspath(path))
    for folder in (inside, *inside.parents):
        if (folder / MANIFEST_FILE).is_file():
            with _read():
                return Package(folder.name, folder).manifest.name
    return None


def _needs(manifest: Manifest) -> list[str]:
    return list(dict.fromkeys(each.name for each in manifest.depends))


@contextmanager
def _read() -> Iterator[None]:
    try:
        yield
    except (PackageFileError, OSError) as error:
        raise InvalidManifest(str(error)) from None
