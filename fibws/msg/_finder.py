"""Imports ``fibws.msg.<package>`` for packages that are in the user's folders."""

from __future__ import annotations

import importlib
import os
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, cast

from fibws.interfaces import Interfaces, Message

if TYPE_CHECKING:
    from importlib.abc import Loader

VARIABLE = "FIBWS_INTERFACES"
"""The environment variable that names the user's folders, as PATH does."""

_interfaces = Interfaces()


def default_interfaces() -> Interfaces:
    """The types that this process knows: the standard ones and those of the user's folders.

    The environment is read each time, so that it may change until a type is needed.

    Raises:
        InterfaceError: the environment names a folder that is not there.
    """
    for folder in os.environ.get(VARIABLE, "").split(os.pathsep):
        if folder:
            _interfaces.add_folder(Path(folder))
    return _interfaces


def add_folder(folder: Path) -> None:
    """Let this process know the types of one more folder.

    Raises:
        InterfaceError: there is no such folder.
    """
    _interfaces.add_folder(folder)


def message_class(name: str) -> type[Message]:
    """The Python class of a message type, ``std_msgs/Int32``; its module is imported.

    Raises:
        InterfaceError: there is no such type, or its definition is wrong.
    """
    definition = default_interfaces().message(name)
    module = importlib.import_module(f"fibws.msg.{definition.package}")
    found: type[Message] = getattr(module, definition.name)
    return found


class PackageFinder:
    """Finds the modules of the user's packages; it leaves all others to Python."""

    # Not derived from importlib.abc's classes: their import takes longer than ours.

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module's spec, if it is one of ours; Python calls this for every import."""
        parent, _, package = fullname.rpartition(".")
        if parent != "fibws.msg" or package.startswith("_"):
            return None
        if default_interfaces().is_users(package):
            return ModuleSpec(
                fullname, cast("Loader", _GeneratedLoader), origin="written by its import"
            )
        if PathFinder.find_spec(fullname, path) is None:
            raise ModuleNotFoundError(
                f"No module named {fullname!r}: neither the standard packages nor the folders in "
                f"{VARIABLE} ({os.environ.get(VARIABLE, 'not set')}) define messages of {package}",
                name=fullname,
            )
        return None


class _GeneratedLoader:
    """Loads the module that the generator writes for a package."""

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Python's own kind of module will do."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Write the module's source and run it."""
        from fibws.interfaces.generator import generate  # few nodes need it

        source = generate(module.__name__.rpartition(".")[2], default_interfaces())
        exec(compile(source, f"<{module.__name__}>", "exec"), module.__dict__)
