"""Stubs of the user's packages: what editors and type checkers read in place of running a program.

A program's classes are made when it imports them (`fibws.msg`), so there is no file that a type
checker could read. A stub describes the same module, and nothing imports it: there is one class of
each type, however the program came to it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from fibws.errors import InterfaceError
from fibws.files import replace_file
from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.folders import KINDS, STANDARD
from fibws.interfaces.generated_modules import GENERATED, MODULES
from fibws.interfaces.generator import generate

_OTHERS = ("hub", "tf")
"""Further packages that `fibws` exports."""


def write_stubs(interfaces: Interfaces, folder: Path) -> Iterator[Path]:
    """Write a stub for each module of the user's packages; yield the paths of what was written.

    Args:
        interfaces: the types, with the user's folders.
        folder: the search path of the type checker: stubs go to ``fibws/msg/PACKAGE.pyi`` in it,
            and so on. A stub of types that are gone is removed.

    Raises:
        InterfaceError: there are no packages of the user, or one of their definitions is wrong.
        OSError: a stub cannot be written.
    """
    packages = [each for each in interfaces.packages() if interfaces.is_users(each)]
    if not packages:
        raise InterfaceError(
            "no packages of your own: name the folder that holds them by --interfaces or "
            "FIBWS_INTERFACES"
        )
    for package in packages:
        for kind in KINDS:
            has_types = bool(interfaces.types(package, kind))
            source = generate(package, interfaces, kind) if has_types else None
            yield from _write(folder / "fibws" / kind / f"{package}.pyi", source)
    yield from _write_parents(folder)


def _write_parents(folder: Path) -> Iterator[Path]:
    """Write stubs of fibws itself, and of the packages in it that it exports, if they are needed.

    Without them mypy takes a standard package's own module, not the stub of the user's package that
    has its name. All other modules are found where fibws is installed, by absolute names alone:
    Pyright looks for relative ones beside the stub.
    """
    names = (each.stem for each in folder.glob("fibws/*/[!_]*.pyi"))
    is_needed = any((STANDARD / name).is_dir() for name in names)
    for package in ("", *KINDS, *_OTHERS):
        stub = folder / "fibws" / package / "__init__.pyi"
        yield from _write(stub, _copied(package) if is_needed else None)


def _copied(package: str) -> str:
    """Return a copy of the stub of fibws, or of a package in it, with absolute names."""
    found = MODULES / package / "__init__.pyi"
    path = found if found.exists() else found.with_suffix(".py")
    name = ".".join(filter(None, ("fibws", package)))
    source = re.sub(r"^from \.(?=\w)", f"from {name}.", path.read_text("utf-8"), flags=re.M)
    return f"# A copy of {path.relative_to(MODULES.parent).as_posix()}, {GENERATED}\n{source}"


def _write(stub: Path, source: str | None) -> Iterator[Path]:
    """Write a stub and yield its path; remove a generated one that has no source.

    Raises:
        OSError: it cannot be written.
    """
    if source is not None:
        stub.parent.mkdir(parents=True, exist_ok=True)
        replace_file(stub, source.encode())
        yield stub
    elif stub.is_file() and GENERATED in stub.read_text("utf-8").partition("\n")[0]:
        stub.unlink()
