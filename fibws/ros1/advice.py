"""What a script is told that imports messages or services in vain."""

from __future__ import annotations

import os
import sys

from fibws.definition_folders import VARIABLE, find_unnamed, hold_definitions
from fibws.suggestions import nearest

_WORDS = {"msg": "message", "srv": "service"}


def advise(fullname: str) -> None:
    """Say how ``package.msg`` or ``package.srv`` might be found, or ``package`` on the way there.

    Args:
        fullname: what nobody has found, which may be anything.

    Raises:
        ModuleNotFoundError: it is being imported, not only looked for.
    """
    package, _, rest = fullname.partition(".")
    for kind in _WORDS:
        if rest in ("", kind) and _is_being_imported(f"{package}.{kind}"):
            raise ModuleNotFoundError(_advice(fullname, package, kind), name=fullname)


def no_such_name(package: str, kind: str, name: str, names: list[str]) -> str:
    """The text about a name that ``package.msg`` does not hold, although it holds ``names``."""
    near = nearest(name, names)
    return (
        f"cannot import name {name!r} from '{package}.{kind}': {package} has no {_WORDS[kind]} of "
        f"this name{f'; did you mean {near}?' if near else ''}"
    )


def _is_being_imported(name: str) -> bool:
    """Whether a module of this name is wanted; another may only be looked for."""
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        code = frame.f_code
        if code.co_name == "_find_and_load" and code.co_filename.startswith("<frozen importlib"):
            if frame.f_locals.get("name") == name:
                return True
    return False


def _advice(fullname: str, package: str, kind: str) -> str:
    """What would have to be done for ``package.msg``, which cannot be imported as it is."""
    text = f"No module named {fullname!r}"
    if hold_definitions(package):
        return f"{text}: {package} has no .{kind} files"
    folder = find_unnamed(package, kind)
    if folder is not None:
        root = next((each for each in folder.parents if each.name == "src"), None)
        if root is None:
            return f"{text}: name its folder first, {VARIABLE}={folder.parents[1]}"
        setup = root.parent / "devel" / "setup.bash"
        make = "" if setup.is_file() else f"run catkin_make in {root.parent}, then "
        return f"{text}: {make}source {setup}"
    near = nearest(package, _packages(), cutoff=0.8)
    guess = f"did you mean {near}? Or is " if near else "is "
    return (
        f"{text}: {guess}it in a workspace? Then run catkin_make there and source its "
        f"devel/setup.bash ({VARIABLE}, which names folders of messages, is "
        f"{os.environ.get(VARIABLE) or 'not set'})"
    )


def _packages() -> list[str]:
    """The packages whose definitions are known."""
    from fibws.errors import InterfaceError
    from fibws.msg import default_interfaces

    try:
        return default_interfaces().packages()
    except InterfaceError:  # Who imports what is there is told of it.
        return []
