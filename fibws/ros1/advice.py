"""Errors for imports of messages or services that are not found."""

from __future__ import annotations

import os
import sys

from fibws.command_names import command_name
from fibws.definition_folders import VARIABLE, find_unnamed, hold_definitions
from fibws.suggestions import nearest, suggestion

MAKE = "workspace make"
_KINDS = {"msg": "message", "srv": "service"}


def advise(fullname: str) -> None:
    """Explain how to make ``package.msg`` or ``package.srv`` importable.

    Args:
        fullname: the name of any module that was not found.

    Raises:
        ModuleNotFoundError: it is one of these, or ``package`` on the way to one, and imported.
    """
    package, _, rest = fullname.partition(".")
    for kind in _KINDS:
        if rest in ("", kind) and _is_being_imported(f"{package}.{kind}"):
            raise ModuleNotFoundError(_advice(fullname, package, kind), name=fullname)


def no_such_name(package: str, kind: str, name: str, names: list[str]) -> str:
    """Return the error for a name that is not among the ``names`` in ``package.msg``."""
    return (
        f"cannot import name {name!r} from '{package}.{kind}': {package} has no {_KINDS[kind]} of "
        f"this name{suggestion(name, names)}"
    )


def _is_being_imported(name: str) -> bool:
    """Return whether a module is being imported, and not only searched for."""
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        code = frame.f_code
        if code.co_name == "_find_and_load" and code.co_filename.startswith("<frozen importlib"):
            if frame.f_locals.get("name") == name:
                return True
    return False


def _advice(fullname: str, package: str, kind: str) -> str:
    """Return the error for ``package.msg``, with the steps that make it importable."""
    text = f"No module named {fullname!r}"
    if hold_definitions(package):
        return f"{text}: {package} has no .{kind} files"
    folder = find_unnamed(package, kind)
    if folder is not None:
        root = next((each for each in folder.parents if each.name == "src"), None)
        if root is None:
            return f"{text}: set {VARIABLE}={folder.parents[1]}"
        setup = root.parent / "devel" / "setup.bash"
        make = "" if setup.is_file() else f"run {command_name(MAKE)} in {root.parent}, then "
        return f"{text}: {make}source {setup}"
    near = nearest(package, _packages(), cutoff=0.8)
    guess = f"did you mean {near}? Or is " if near else "is "
    return (
        f"{text}: {guess}it in a workspace? Then run {command_name(MAKE)} there and source its "
        f"devel/setup.bash. Or set {VARIABLE} to its folder "
        f"(now: {os.environ.get(VARIABLE) or 'not set'})"
    )


def _packages() -> list[str]:
    """Return the packages with known definitions."""
    from fibws.errors import InterfaceError
    from fibws.msg import default_interfaces

    try:
        return default_interfaces().packages()
    except InterfaceError:  # Importing known messages reports it.
        return []
