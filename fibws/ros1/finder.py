"""Imports ``<package>.msg`` and ``<package>.srv`` from definitions, as a script of ROS 1 does.

A package whose definitions are known goes before a folder of its name that holds no Python. A
Python package of its name is imported as ever, but for its ``msg`` and ``srv``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

from fibws.definition_folders import VARIABLE, are_bare, hold_definitions
from fibws.ros1.advice import advise, no_such_name

if TYPE_CHECKING:
    from importlib.abc import Loader

    from fibws.interfaces.folders import Kind

_KINDS: dict[str, Kind] = {"msg": "msg", "srv": "srv"}


def install() -> None:
    """Have the imports of this process find the definitions; called again, it does nothing."""
    if PackageFinder not in sys.meta_path:
        sys.meta_path.insert(0, PackageFinder)
        sys.meta_path.append(AdviceFinder)


class PackageFinder:
    """Finds the packages whose definitions are known, and the classes in them."""

    # Nothing of fibws is loaded for the imports of others, of which there are hundreds.

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module's spec, if it is one of ours; Python calls this for every import.

        Raises:
            ImportError: it is one of ours and cannot be there.
        """
        package, _, rest = fullname.partition(".")
        kind, _, name = rest.partition(".")
        if rest and kind not in _KINDS:
            return None
        if hold_definitions(package):
            if not rest:
                return _package_spec(package)
            return _module_spec(fullname, package, _KINDS[kind], name)
        if rest and not name and are_bare(path or [], kind):
            advise(fullname)  # Python would take the folder for a module, in which nothing is.
        return None


class AdviceFinder:
    """Comes after all others: says what is needed to import messages that nobody has found."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> None:
        """Raise ModuleNotFoundError if ``<package>.msg`` or ``<package>.srv`` is being imported."""
        advise(fullname)


class _PackageLoader:
    """Loads a package, in which there is nothing but its modules."""

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Python's own kind of module will do."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """There is nothing to be run."""


class _ClassesLoader(_PackageLoader):
    """Loads ``<package>.msg`` or ``<package>.srv``, whose classes are made when they are used."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Give the module its names."""
        package, _, kind = module.__name__.partition(".")
        owners = _owners(package, cast("Kind", kind))

        def find(name: str) -> Any:
            if name == "__all__":
                value: Any = _sound(package, kind, owners)
            elif name in owners:
                value = _class(package, kind, name, owners[name])
            else:
                text = f"module {module.__name__!r} has no attribute {name!r}"
                raise AttributeError(text, name=name, obj=module)
            setattr(module, name, value)
            return value

        vars(module).update(__getattr__=find, __dir__=lambda: sorted({*vars(module), *owners}))


class _ClassLoader(_PackageLoader):
    """Loads ``<package>.msg._Type``, where a class says that it is."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Make the class, or the three of a service."""
        package, kind, type_ = module.__name__.split(".")
        for name, owner in _owners(package, cast("Kind", kind)).items():
            if owner == type_[1:]:
                setattr(module, name, _class(package, kind, name, owner))


def _package_spec(package: str) -> ModuleSpec | None:
    """The spec of the package itself, if Python does not find one."""
    if package in sys.builtin_module_names:
        return None
    found = PathFinder.find_spec(package)
    spec = ModuleSpec(package, cast("Loader", _PackageLoader), is_package=True)
    if found is None:
        return spec
    places = found.submodule_search_locations
    if found.origin is None:  # A folder without Python of its own; there may be some deeper in it.
        spec.submodule_search_locations = None if places is None else list(places)
        return spec
    if places is not None:
        return None
    if _is_running(found.origin):  # A node named as its package; as a module it would run again.
        return spec
    found.submodule_search_locations = []
    return found


def _is_running(path: str) -> bool:
    """Whether this is the script that Python was started with."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    return script is not None and os.path.realpath(script) == os.path.realpath(path)


def _module_spec(fullname: str, package: str, kind: Kind, name: str) -> ModuleSpec | None:
    """The spec of ``package.msg``, or of what is imported from it as a module."""
    owners = _owners(package, kind)
    if not owners:
        return None
    origin = f"the definitions of {package}"
    if not name:
        return ModuleSpec(fullname, cast("Loader", _ClassesLoader), origin=origin, is_package=True)
    if name.startswith("_"):
        if name[1:] not in owners.values():
            return None
        return ModuleSpec(fullname, cast("Loader", _ClassLoader), origin=origin)
    if name in owners:
        return None
    raise ImportError(no_such_name(package, kind, name, list(owners)), name=fullname)


def _owners(package: str, kind: Kind) -> dict[str, str]:
    """What ``package.msg`` holds, each with the name of the type that defines it."""
    from fibws.errors import InterfaceError, UnknownPackage
    from fibws.msg import default_interfaces

    try:
        types = default_interfaces().types(package, kind)
    except UnknownPackage:
        return {}
    except InterfaceError as error:
        raise ImportError(f"{VARIABLE}: {error}", name=f"{package}.{kind}") from None
    names = [type_.partition("/")[2] for type_ in types]
    if kind == "msg":
        return {name: name for name in names}
    parts = {f"{name}{part}": name for name in names for part in ("Request", "Response")}
    return parts | {name: name for name in names}


def _class(package: str, kind: str, name: str, owner: str) -> Any:
    """The class of that name, which the type ``owner`` defines."""
    from genpy.classes import message_class, service_class

    from fibws.errors import InterfaceError

    try:
        if kind == "msg":
            return message_class(f"{package}/{name}")
        service: Any = service_class(f"{package}/{owner}")
    except InterfaceError as error:
        text = f"cannot import name {name!r} from '{package}.{kind}': {error}"
        raise ImportError(text, name=f"{package}.{kind}") from None
    if name == owner:
        return service
    return service.Request if name.endswith("Request") else service.Response


def _sound(package: str, kind: str, owners: dict[str, str]) -> list[str]:
    """The names of which classes can be made: what is wrong with one is no other's fault."""
    import warnings

    sound = []
    for name, owner in owners.items():
        try:
            _class(package, kind, name, owner)
        except ImportError as error:
            warnings.warn(str(error), stacklevel=3)
        else:
            sound.append(name)
    return sound
