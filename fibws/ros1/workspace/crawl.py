"""Where the packages below a folder are, as rospack and catkin look for them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from fibws.ros1.workspace.manifest import FILE

IGNORED = {"CATKIN_IGNORE", "AMENT_IGNORE", "COLCON_IGNORE", "rospack_nosubdirs"}
"""A folder that holds one of these is not looked into."""


def find_folders(root: Path) -> Iterator[Path]:
    """The folders below ``root``, it included, that hold a package.xml, sorted.

    There is none within a package, in a hidden folder, or in one that says it is to be ignored, as
    what catkin has built does. Symbolic links are followed, to each folder once.
    """
    yield from _find(root, set())


def _find(folder: Path, seen: set[str]) -> Iterator[Path]:
    real = os.path.realpath(folder)
    if real in seen:
        return
    seen.add(real)
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return  # It is no folder, or not for us to read: there is nothing to be found.
    names = {entry.name for entry in entries}
    if names & IGNORED or ".catkin" in names:
        return
    if FILE in names:
        yield folder
        return
    for entry in entries:
        # Not entry.is_dir(), which raises for a link that leads to itself.
        if not entry.name.startswith(".") and os.path.isdir(folder / entry.name):
            yield from _find(folder / entry.name, seen)
