"""The files of the standard packages' modules: whether they are up to date, and writing them.

They are not in git. Builds of the package write them; in a checkout, an import writes a module that
is missing, or older than what it is made of. A module has the time of its newest source.
"""

from __future__ import annotations

import os
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from fibws.interfaces.folders import KINDS, STANDARD

if TYPE_CHECKING:
    from fibws.interfaces.folders import Kind

GENERATED = "written by fibws.interfaces.generator: do not edit."
"""The end of the first line of each module."""

MODULES = Path(__file__).parents[1]
"""The folder of the folders msg, srv and action, which hold the modules."""

_DEFINED_BY: dict[Kind, tuple[Kind, ...]] = {
    "msg": ("msg", "action"),  # An action has seven messages.
    "srv": ("srv",),
    "action": ("action",),
}


def path(package: str, kind: Kind) -> str:
    """Return the path of a package's module, which may be missing."""
    return os.path.join(MODULES, kind, f"{package}.py")


def is_current(package: str, kind: Kind) -> bool:
    """Return whether a package's module exists, and no source of it is newer."""
    try:
        return os.stat(path(package, kind)).st_mtime_ns >= _newest_source(package, kind)
    except FileNotFoundError:
        return False


def write_module(package: str, kind: Kind, folder: Path = MODULES) -> Path:
    """Write the module of a standard package in one step; return its path.

    Args:
        folder: the folder of the folders msg, srv and action.

    Raises:
        InterfaceError: there is no such package, or one of its definitions is wrong.
        OSError: the module cannot be written.
    """
    from importlib.util import cache_from_source

    from fibws.files import replace_file
    from fibws.interfaces.catalogue import Interfaces
    from fibws.interfaces.generator import generate

    # The definitions are read after the clock and not taken from a cache: a source that changes
    # meanwhile is newer than the module.
    newest = _newest_source(package, kind)
    source = generate(package, Interfaces(), kind)
    module = folder / kind / f"{package}.py"
    module.parent.mkdir(parents=True, exist_ok=True)
    replace_file(module, source.encode())
    os.utime(module, ns=(newest, newest))
    # Bytecode counts as current if the time in seconds and the size are the same.
    with suppress(OSError, NotImplementedError):
        os.unlink(cache_from_source(module))
    return module


def write_modules(folder: Path = MODULES) -> None:
    """Write the modules of all standard packages, and remove those of packages that are gone.

    Args:
        folder: the folder of the folders msg, srv and action.

    Raises:
        InterfaceError: a definition is wrong.
        OSError: a module cannot be written.
    """
    from fibws.interfaces.catalogue import Interfaces

    interfaces = Interfaces()
    for kind in KINDS:
        packages = [each for each in interfaces.packages() if interfaces.types(each, kind)]
        written = {write_module(package, kind, folder) for package in packages}
        for other in set((folder / kind).glob("[!_]*.py")) - written:
            if GENERATED in other.read_text("utf-8", errors="replace").partition("\n")[0]:
                other.unlink()


def _newest_source(package: str, kind: Kind) -> int:
    """Return when the last change was made to what a module is made of, in nanoseconds.

    Raises:
        FileNotFoundError: there is no such package.
    """
    folder = os.path.join(STANDARD, package)
    times = [_generator_time(), os.stat(folder).st_mtime_ns]
    for each in _DEFINED_BY[kind]:
        subfolder = os.path.join(folder, each)
        with suppress(FileNotFoundError), os.scandir(subfolder) as files:
            # A folder's own time changes if a file is removed.
            times.append(os.stat(subfolder).st_mtime_ns)
            times += [file.stat().st_mtime_ns for file in files]
    return max(times)


@cache
def _generator_time() -> int:
    names = ("builtin", "class_source", "definition", "generator", "parser", "python_names")
    return max(os.stat(Path(__file__).with_name(f"{name}.py")).st_mtime_ns for name in names)
