"""Imports ``fibws.msg.<package>`` for packages that are in the user's folders.

It does the same for the services in fibws.srv and the actions in fibws.action. In a checkout of
fibws, it also writes the modules of the standard packages that are missing or out of date.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence
from functools import partial
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn, cast

from fibws.interfaces import Action, Interfaces, Message, Service
from fibws.suggestions import suggestion

if TYPE_CHECKING:
    from importlib.abc import Loader

    from fibws.interfaces import ActionDefinition, MessageDefinition, ServiceDefinition
    from fibws.interfaces.folders import Kind

_PARENTS: dict[str, Kind] = {"fibws.msg": "msg", "fibws.srv": "srv", "fibws.action": "action"}
"""The Python packages whose modules are found here, with the kind of types that each holds."""

VARIABLE = "FIBWS_INTERFACES"
"""The environment variable that names the user's folders, as PATH does."""

IS_CHECKOUT = Path(__file__).parents[2].joinpath("hatch_build.py").exists()
"""Whether the standard definitions may change: those of an installed package never do."""

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


Message._find_interfaces = default_interfaces


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
    found: type[Message] = _found("msg", default_interfaces().message(name))
    return found


def service_class(name: str) -> type[Service[Any, Any]]:
    """The Python class of a service type, ``std_srvs/Trigger``; it does as `message_class`."""
    found: type[Service[Any, Any]] = _found("srv", default_interfaces().service(name))
    return found


def action_class(name: str) -> type[Action[Any, Any, Any]]:
    """The Python class of an action type, ``tf2_msgs/LookupTransform``; as `message_class`."""
    found: type[Action[Any, Any, Any]] = _found("action", default_interfaces().action(name))
    return found


def _found(kind: Kind, definition: MessageDefinition | ServiceDefinition | ActionDefinition) -> Any:
    """The class that a definition became."""
    module = importlib.import_module(f"fibws.{kind}.{definition.package}")
    return getattr(module, definition.name)


class ModuleFinder:
    """Finds the modules of the user's packages; it leaves all others to Python."""

    # Not derived from importlib.abc's classes: their import takes longer than ours.

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module's spec, if it is one of ours; Python calls this for every import."""
        parent, _, package = fullname.rpartition(".")
        if parent not in _PARENTS or package.startswith("_"):
            return None
        kind, interfaces = _PARENTS[parent], default_interfaces()
        is_users = interfaces.is_users(package)
        if not is_users:
            found = PathFinder.find_spec(fullname, path)
            if found is not None and not _is_outdated(found, package, kind):
                return _with_suggestions(found)
        if package in interfaces.packages() and interfaces.types(package, kind):
            written = None if is_users else _write(fullname, package, kind)
            return _with_suggestions(written) or ModuleSpec(
                fullname, cast("Loader", _GeneratedLoader), origin="written by its import"
            )
        raise ModuleNotFoundError(
            f"No module named {fullname!r}: neither the standard packages nor the folders in "
            f"{VARIABLE} ({os.environ.get(VARIABLE, 'not set')}) hold {kind} files of {package}"
            f"{_misplaced(package, kind) or _other_package(package)}",
            name=fullname,
        )


def _is_outdated(found: ModuleSpec, package: str, kind: Kind) -> bool:
    """Return whether a module is of this checkout, and older than its definitions."""
    if not IS_CHECKOUT:
        return False
    from fibws.interfaces import generated_modules

    is_ours = found.origin == generated_modules.path(package, kind)
    return is_ours and not generated_modules.is_current(package, kind)


def _write(fullname: str, package: str, kind: Kind) -> ModuleSpec | None:
    """Write a module of this checkout, and return its spec; None if it is not writable.

    Raises:
        InterfaceError: one of the package's definitions is wrong.
    """
    if not IS_CHECKOUT:
        return None
    from fibws.interfaces import generated_modules

    try:
        generated_modules.write_module(package, kind)
    except OSError:
        return None
    return spec_from_file_location(fullname, generated_modules.path(package, kind))


def _misplaced(package: str, kind: Kind) -> str:
    """Return the end of an error about a package whose files are elsewhere than expected."""
    for text in filter(None, os.environ.get(VARIABLE, "").split(os.pathsep)):
        folder = Path(text).resolve()
        if folder.name in _PARENTS.values() and folder.parent.name == package:
            return f"; name {folder.parent.parent} in place of {text}"
        if any((folder / package).glob(f"*.{kind}")):
            return f"; move {folder / package}/*.{kind} to {folder / package / kind}"
    return ""


def _other_package(package: str) -> str:
    """Return the end of an error about a package that has no types of a kind."""
    interfaces = default_interfaces()
    if package in interfaces.packages():
        others = [f"fibws.{kind}" for kind in _PARENTS.values() if interfaces.types(package, kind)]
        return f"; {' and '.join(others)} have it" if len(others) > 1 else f"; {others[0]} has it"
    near = interfaces.nearest(package)
    return f"; did you mean {near}?" if near else ""


def _with_suggestions(spec: ModuleSpec | None) -> ModuleSpec | None:
    """Let a standard package's module suggest names, if it is read from an ordinary file."""
    if spec is not None and type(spec.loader) is SourceFileLoader:
        spec.loader = _StandardLoader(spec.loader.name, spec.loader.path)
    return spec


class _StandardLoader(SourceFileLoader):
    """Loads the module of a standard package."""

    def exec_module(self, module: ModuleType) -> None:
        """Run the module."""
        super().exec_module(module)
        module.__getattr__ = partial(_no_such_class, module)  # type: ignore[method-assign]


def _no_such_class(module: ModuleType, name: str) -> NoReturn:
    """Raise the error for a class that a module does not have; Python calls it for each such name.

    Raises:
        ImportError: the name is being imported.
        AttributeError: it is not.
    """
    parent, _, package = module.__name__.rpartition(".")
    kind = _PARENTS[parent]
    if not _is_imported(name):
        raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
    hint = suggestion(name, module.__all__)
    for other, others in _PARENTS.items():
        if others != kind and f"{package}/{name}" in default_interfaces().types(package, others):
            hint = f"; it is in {other}.{package}"
    raise ImportError(
        f"cannot import name {name!r} from {module.__name__!r}: there is no "
        f"{package}/{kind}/{name}{hint}",
        name=module.__name__,
        path=getattr(module, "__file__", None),
    )


def no_such_package(parent: ModuleType, name: str) -> NoReturn:
    """Raise the error for a name that fibws.msg, srv or action does not have, as `_no_such_class`.

    Raises:
        ImportError: the name is being imported.
        AttributeError: it is not.
    """
    # Packages that import each other: Python has the module, and the attribute a little later.
    is_loading = f"{parent.__name__}.{name}" in sys.modules
    if is_loading or not _is_imported(name):
        raise AttributeError(f"module {parent.__name__!r} has no attribute {name!r}")
    kind, interfaces = _PARENTS[parent.__name__], default_interfaces()
    holders = [
        package
        for package in interfaces.packages()
        if f"{package}/{name}" in interfaces.types(package, kind)
    ]
    lines = [f"from {parent.__name__}.{package} import {name}" for package in holders]
    hint = f": write {' or '.join(lines)}" if lines else _other_package(name)
    raise ImportError(
        f"cannot import name {name!r} from {parent.__name__!r}{hint}", name=parent.__name__
    )


def _is_imported(name: str) -> bool:
    """Return whether the caller's module function answers ``from ... import NAME``."""
    from opcode import opmap

    frame = sys._getframe(2)
    is_import = frame.f_code.co_code[frame.f_lasti] == opmap["IMPORT_FROM"]
    return is_import and not name.startswith("_")


class _GeneratedLoader:
    """Loads the module that the generator writes for a package."""

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Python's own kind of module will do."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Write the module's source and run it."""
        from fibws.interfaces.generator import generate  # few nodes need it

        parent, _, package = module.__name__.rpartition(".")
        source = generate(package, default_interfaces(), _PARENTS[parent])
        exec(compile(source, f"<{module.__name__}>", "exec"), module.__dict__)
        module.__getattr__ = partial(_no_such_class, module)  # type: ignore[method-assign]
