"""The folders of definitions, found without loading the rest of fibws."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

VARIABLE = "FIBWS_INTERFACES"
"""The environment variable with the user's folders, separated as in PATH."""
STANDARD = Path(__file__).parent / "interfaces" / "definitions"
KINDS = ("msg", "srv", "action")


def named_folders() -> list[str]:
    """Return the user's folders, in the order of the variable."""
    return [each for each in os.environ.get(VARIABLE, "").split(os.pathsep) if each]


def hold_definitions(package: str) -> bool:
    """Return whether a known folder has the package; called for hundreds of modules."""
    if os.path.isdir(os.path.join(STANDARD, package)):
        return True
    for folder in named_folders():
        for place in (os.path.join(folder, package), os.path.realpath(folder)):
            if os.path.basename(place) == package and any(
                os.path.isdir(os.path.join(place, kind)) for kind in KINDS
            ):
                return True
    return False


def are_bare(path: Sequence[str], kind: str) -> bool:
    """Return whether a package has a folder of definitions without Python modules.

    Args:
        path: the folders of the package.
        kind: ``msg``, ``srv`` or ``action``.
    """
    folders = [Path(place) / kind for place in path]
    return any(
        any(folder.glob(f"*.{kind}")) and not (folder / "__init__.py").exists()
        for folder in folders
    )


def find_unnamed(package: str, kind: str) -> Path | None:
    """Find a folder of the package's definitions near the script or the working directory."""
    for start in (Path(sys.path[0] or "."), Path.cwd()):
        for place in (start, *start.absolute().parents):
            for folder in (place / package / kind, place / "src" / package / kind, place / kind):
                if folder.parent.name == package and any(folder.glob(f"*.{kind}")):
                    return folder
    return None
