"""Whether the user's folders of definitions are there, and every file in them can be read."""

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
    from fibws.interfaces.folders import Package

MOST = 20
"""Files that are told of one by one."""


def checks() -> Iterator[Finding]:
    """Look at each folder of $FIBWS_INTERFACES."""
    if folders := named_folders():
        yield from of([Path(each) for each in folders])


def of(folders: list[Path]) -> Iterator[Finding]:
    """Look at these folders, which may need each other's types."""
    there = [folder for folder in folders if folder.is_dir()]
    for folder in folders:
        if folder not in there:
            yield wrong(
                "definitions",
                f"{folder} is in ${VARIABLE} and is no folder",
                f"Make it, or take it out: folders are divided by {os.pathsep}",
            )
    from fibws.interfaces import Interfaces  # which takes pydantic
    from fibws.interfaces.folders import find_packages

    interfaces = Interfaces(there)
    read = 0
    faults: dict[str, None] = {}
    for folder in there:
        packages = list(find_packages(folder))
        if not packages and not _is_built(folder):
            yield warning(
                "definitions",
                f"{folder} has no definitions",
                "A folder holds packages: PACKAGE/msg/Type.msg, PACKAGE/srv/Type.srv.",
            )
        for package in packages:
            for fault in _faults(interfaces, package):
                read += fault is None
                faults.update({fault: None} if fault else {})
    for fault in list(faults)[:MOST]:
        yield wrong("definitions", fault, "Mend the file; the hub and the nodes refuse this type.")
    if len(faults) > MOST:
        yield wrong("definitions", f"and {len(faults) - MOST} more", "Mend those above first.")
    if read:
        yield ok("definitions", f"types of ${VARIABLE} that are well defined: {read}")


def _is_built(folder: Path) -> bool:
    """Whether catkin_make here made it, for which no package needs to define anything."""
    from fibws.ros1.workspace.build import RECORD

    return (folder.parent / RECORD).is_file()


def _faults(interfaces: Interfaces, package: Package) -> Iterator[str | None]:
    """What is wrong with each type of a package: None if nothing is."""
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
