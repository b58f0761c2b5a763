"""Imports ``<package>.msg`` and ``<package>.srv`` from definitions, for scripts of ROS 1.

A package with known definitions hides a folder of its name that has no Python files. A Python
package of its name is imported as usual, except its ``msg`` and ``srv``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

from fibws.definition_folders import VARIABLE, are_bare, hold_definitions
from fibws.ros1.advice import advise, advise_submodule, no_such_name

if TYPE_CHECKING:
    from importlib.abc import Loader

    from fibws.interfaces.folders import Kind

FALLBACK = os.path.join(os.path.dirname(__file__), "fallback")
"""The folder of modules that are used if no other folder has them."""
_KINDS: dict[str, Kind] = {"msg": "msg", "srv": "srv"}


def install() -> None:
    """Make this process import definitions; further calls do nothing."""
    if PackageFinder not in sys.meta_path:
        sys.meta_path.insert(0, PackageFinder)
        sys.meta_path += [FallbackFinder, AdviceFinder]


class PackageFinder:
    """Finds packages with known definitions, and their classes."""

    # No other module of fibws is loaded for the many imports of other packages.

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a module from definitions, or None; Python calls this for each import.

        Raises:
            ImportError: the package has definitions, but not of this name.
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
            advise(fullname)  # Python would import the folder as an empty package.
        return None


class FallbackFinder:
    """Finds modules of fibws that are used only if no other folder on the path has them: rospkg.

    PyPI's rospkg has more, which rosdep needs, and is preferred if it is installed.
    """

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of such a module, or None."""
        return PathFinder.find_spec(fullname, [FALLBACK]) if path is None else None


class AdviceFinder:
    """The last finder: explains how to import messages that no other finder found."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> None:
        """Raise ModuleNotFoundError if ``<package>.msg`` or ``<package>.srv`` is imported."""
        advise(fullname)


class _PackageLoader:
    """Loads a package that contains only modules."""

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Let Python create the module."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Set a function that explains where the package's types are."""

        def find(name: str) -> Any:
            text = f"module {module.__name__!r} has no attribute {name!r}"
            for kind in _KINDS:
                if name in _owners(module.__name__, _KINDS[kind]):
                    if sys._getframe(1).f_code.co_name == "_handle_fromlist":  # from ... import
                        advise_submodule(module.__name__, kind, name)
                    text += f": write from {module.__name__}.{kind} import {name}"
            raise AttributeError(text, name=name, obj=module)

        vars(module)["__getattr__"] = find


class _ClassesLoader(_PackageLoader):
    """Loads ``<package>.msg`` or ``<package>.srv``, whose classes are created when first used."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Set the functions that find the module's names."""
        package, _, kind = module.__name__.partition(".")
        owners = _owners(package, cast("Kind", kind))

        def find(name: str) -> Any:
            if name == "__all__":
                value: Any = _importable(package, kind, owners)
            elif name in owners:
                value = _class(package, kind, name, owners[name])
            else:
                text = f"module {module.__name__!r} has no attribute {name!r}"
                raise AttributeError(text, name=name, obj=module)
            setattr(module, name, value)
            return value

        vars(module).update(__getattr__=find, __dir__=lambda: sorted({*vars(module), *owners}))


class _ClassLoader(_PackageLoader):
    """Loads ``<package>.msg._Type``, which classes have as their ``__module__``."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Create the class, or the three classes of a service."""
        package, kind, type_ = module.__name__.split(".")
        for name, owner in _owners(package, cast("Kind", kind)).items():
            if owner == type_[1:]:
                setattr(module, name, _class(package, kind, name, owner))


def _package_spec(package: str) -> ModuleSpec | None:
    """Return the spec of the package itself, or None if Python finds one."""
    if package in sys.builtin_module_names:
        return None
    python_spec = PathFinder.find_spec(package)
    spec = ModuleSpec(package, cast("Loader", _PackageLoader), is_package=True)
    if python_spec is None:
        return spec
    folders = python_spec.submodule_search_locations
    if python_spec.origin is None:  # A folder without an __init__.py; there may be modules in it.
        spec.submodule_search_locations = None if folders is None else list(folders)
        return spec
    if folders is not None:
        return None
    if _is_running(python_spec.origin):  # A node with its package's name would run again.
        return spec
    python_spec.submodule_search_locations = []
    return python_spec


def _is_running(path: str) -> bool:
    """Return whether this is the script that Python was started with."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    return script is not None and os.path.realpath(script) == os.path.realpath(path)


def _module_spec(fullname: str, package: str, kind: Kind, name: str) -> ModuleSpec | None:
    """Return the spec of ``package.msg``, or of a module in it."""
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
    """Return the names in ``package.msg``, each with the type that defines it."""
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
    """Return the class of this name, which the type ``owner`` defines."""
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


def _importable(package: str, kind: str, owners: dict[str, str]) -> list[str]:
    """Return the names of all classes that can be created; warn about the others."""
    import warnings

    names = []
    for name, owner in owners.items():
        try:
            _class(package, kind, name, owner)
        except ImportError as error:
            warnings.warn(str(error), stacklevel=3)
        else:
            names.append(name)
    return names
