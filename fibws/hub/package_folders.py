"""The folders of packages on the hub's machine: of an installed ROS, and of its workspaces.

Nothing is read before a package is looked for.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from glob import glob
from pathlib import Path
from threading import Lock

DISTRIBUTIONS = "/opt/ros/*/share"
DEBIAN = "/usr/share"
"""Where Debian's own packages of ROS have their files."""

FRESH_FOR = 10.0
"""Seconds for which a list of the packages in source trees is used for packages not in it."""
MOST_FOLDERS = 20_000
"""Folders of source trees that are looked at."""
IGNORE = {"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE"}
"""Files that keep ROS's tools out of a folder."""
MANIFEST = "package.xml"

_PACKAGE_NAME = re.compile(r"<name>\s*(\w+)\s*</name>", re.ASCII)


class PackageFolders:
    """Finds the folders of packages by name, in any thread.

    They are looked for in this order: the folders of $ROS_PACKAGE_PATH, ``share`` in those of the
    variables with prefixes, all folders below those of $ROS_PACKAGE_PATH, ``/opt/ros/*/share``, and
    ``/usr/share``.

    Args:
        environment: has the variables.
        prefixes: the names of variables whose folders have packages in ``share``.
    """

    def __init__(
        self, environment: Mapping[str, str], prefixes: Sequence[str] = ("CMAKE_PREFIX_PATH",)
    ) -> None:
        self._trees = _paths(environment.get("ROS_PACKAGE_PATH", ""))
        self._prefixes = [
            each for variable in prefixes for each in _paths(environment.get(variable, ""))
        ]
        self._in_trees: dict[str, list[Path]] = {}
        """The packages of the source trees, by name."""
        self._listed = -FRESH_FOR
        self._lock = Lock()

    def find(self, name: str) -> Iterator[Path]:
        """Yield the folders that may be a package's; they need not exist."""
        for tree in self._trees:
            yield tree / name
        for prefix in self._prefixes:
            yield prefix / "share" / name
        if self._trees:
            yield from self._find_in_trees(name)
        for share in sorted(glob(DISTRIBUTIONS), reverse=True):
            yield Path(share, name)
        yield Path(DEBIAN, name)

    def _find_in_trees(self, name: str) -> list[Path]:
        with self._lock:
            if name not in self._in_trees and time.monotonic() - self._listed >= FRESH_FOR:
                self._in_trees = {}
                for package, folder in _list_packages(self._trees):
                    self._in_trees.setdefault(package, []).append(folder)
                self._listed = time.monotonic()
            return self._in_trees.get(name, [])


def name_of(package: Path) -> str:
    """Return the name of the package in a folder with a package.xml; the folder's may differ."""
    try:
        with (package / MANIFEST).open(encoding="utf-8", errors="replace") as file:
            found = _PACKAGE_NAME.search(file.read(2**16))
    except OSError:
        found = None
    return found[1] if found else package.name


def _list_packages(trees: Iterable[Path]) -> Iterator[tuple[str, Path]]:
    """Yield the packages below some folders, with their names, as rospack finds them."""
    seen: set[str] = set()
    for tree in trees:
        for top, folders, files in os.walk(tree, followlinks=True):
            real = os.path.realpath(top)
            if real in seen or len(seen) >= MOST_FOLDERS or IGNORE.intersection(files):
                folders.clear()
                continue
            seen.add(real)
            if MANIFEST in files:
                folders.clear()
                yield name_of(Path(top)), Path(top)
            folders[:] = sorted(each for each in folders if not each.startswith("."))


def _paths(variable: str) -> tuple[Path, ...]:
    return tuple(Path(each) for each in variable.split(os.pathsep) if each)
