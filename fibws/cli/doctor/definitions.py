"""Checks of the user's folders of definitions."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fibws.cli.doctor.finding import Finding, ok, warning, wrong
from fibws.definition_folders import VARIABLE, named_folders
from fibws.errors import DefinitionError, FibwsError

if TYPE_CHECKING:
    from fibws.interfaces import Interfaces
    from fibws.interfaces.folders import InterfacePackage

MAX_LISTED = 20
"""Maximum number of errors that are listed."""


def checks() -> Iterator[Finding]:
    """Check each folder of $FIBWS_INTERFACES."""
    if folders := named_folders():
        yield from check_folders([Path(each) for each in folders])


def check_folders(folders: list[Path]) -> Iterator[Finding]:
    """Check folders, which may use each other's types."""
    there = [folder for folder in folders if folder.is_dir()]
    for folder in folders:
        if folder not in there:
            yield wrong(
                "definitions",
                f"{folder} in ${VARIABLE} is not a folder",
                f"Create it, or remove it from ${VARIABLE}; folders are separated by {os.pathsep}",
            )
    from fibws.interfaces import Interfaces  # It loads pydantic.
    from fibws.interfaces.folders import find_packages

    interfaces = Interfaces(there)
    read = 0
    faults: dict[str, None] = {}
    for folder in there:
        packages = list(find_packages(folder))
        if not packages and not _is_built(folder):
            yield warning(
                "definitions",
                f"{folder} contains no definitions",
                "Expected packages in it: PACKAGE/msg/Type.msg, PACKAGE/srv/Type.srv.",
            )
        for package in packages:
            for fault in _faults(interfaces, package):
                read += fault is None
                faults.update({fault: None} if fault else {})
    for fault in list(faults)[:MAX_LISTED]:
        yield wrong("definitions", fault, "Fix the file; the hub and nodes reject this type.")
    if len(faults) > MAX_LISTED:
        yield wrong(
            "definitions", f"and {len(faults) - MAX_LISTED} more", "Fix the errors above first."
        )
    if read:
        yield ok("definitions", f"Valid types in ${VARIABLE}: {read}")


def _is_built(folder: Path) -> bool:
    """Return whether `fibws workspace` created the folder; its packages may define nothing."""
    from fibws.ros1.workspace.build import RECORD

    return (folder.parent / RECORD).is_file()


def _faults(interfaces: Interfaces, package: InterfacePackage) -> Iterator[str | None]:
    """Yield the error of each type of a package, or None for a valid type."""
    for kind in ("msg", "srv", "action"):
        for path in sorted((package.folder / kind).glob(f"*.{kind}")):
            name = f"{package.name}/{path.stem}"
            try:
                if kind == "msg":
                    interfaces.message(name)
                elif kind == "srv":
                    interfaces.service(name)
                else:
                    interfaces.action(name)
                yield None
            except DefinitionError as error:
                yield str(error)
            except (FibwsError, OSError) as error:
                yield f"{path}: {error}"
