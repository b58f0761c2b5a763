"""Graph names by the rules of ROS's Python libraries, which are laxer than the hub's."""

from __future__ import annotations

import os
import re
import socket
import sys
from collections.abc import Iterable, Mapping, Sequence

from fibws.names import anonymous_on_host
from rosgraph.rosenv import ROS_NAMESPACE

MSG_EXT = ".msg"
SRV_EXT = ".srv"
SEP = "/"
GLOBALNS = "/"
PRIV_NAME = "~"
REMAP = ":="
ANYTYPE = "*"

_NAME = re.compile(r"[~/A-Za-z][\w/]*")
_BASE_NAME = re.compile(r"[A-Za-z]\w*")
_REMAPPING = re.compile(r"([~/A-Za-z]|__?)[\w/]*:=.*")


def is_global(name: str) -> bool:
    """Return whether a name is global: it begins with ``/``."""
    return name.startswith(SEP)


def is_private(name: str) -> bool:
    """Return whether a name is private to a node: it begins with ``~``."""
    return name.startswith(PRIV_NAME)


def is_legal_name(name: str | None) -> bool:
    """Return whether a name is legal; an empty one is."""
    if name is None:
        return False
    return not name or (_NAME.fullmatch(name) is not None and "//" not in name)


def is_legal_base_name(name: str | None) -> bool:
    """Return whether a name is legal for a node: it has no namespace."""
    return name is not None and _BASE_NAME.fullmatch(name) is not None


def is_legal_remap(arg: str | None) -> bool:
    """Return whether a command-line argument is a remapping: ``from:=to``."""
    return arg is not None and _REMAPPING.fullmatch(arg) is not None


def get_ros_namespace(
    env: Mapping[str, str] | None = None, argv: Sequence[str] | None = None
) -> str:
    """Return the namespace in ``__ns:=`` or $ROS_NAMESPACE; it ends with ``/``."""
    for argument in sys.argv if argv is None else argv:
        name, mark, value = argument.partition(REMAP)
        if mark and name == "__ns":
            return make_global_ns(value)
    return make_global_ns((os.environ if env is None else env).get(ROS_NAMESPACE, GLOBALNS))


def make_global_ns(name: str) -> str:
    """Return a name as a global namespace: ``/robot/`` for ``robot``.

    Raises:
        ValueError: the name is private.
    """
    if is_private(name):
        raise ValueError(f"cannot turn [{name}] into a global name")
    inside = name.strip(SEP)
    return f"/{inside}/" if inside else GLOBALNS


def make_caller_id(name: str) -> str:
    """Return the global name of a node in this program's namespace."""
    return make_global_ns(ns_join(get_ros_namespace(), name))


def namespace(name: str) -> str:
    """Return the namespace of a name: ``/robot/`` for ``/robot/arm``."""
    if not isinstance(name, str):
        raise TypeError("name")
    return name.removesuffix(SEP).rpartition(SEP)[0] + SEP


def ns_join(ns: str, name: str) -> str:
    """Return a name in a namespace; global and private names are returned unchanged."""
    if is_private(name) or is_global(name) or not ns:
        return name
    if ns == PRIV_NAME or ns.endswith(SEP):
        return ns + name
    return f"{ns}/{name}"


def canonicalize_name(name: str) -> str:
    """Return a name without redundant slashes: ``/a/b`` for ``/a//b/``."""
    if not name or name == SEP:
        return name
    inside = SEP.join(part for part in name.split(SEP) if part)
    return SEP + inside if is_global(name) else inside


def resolve_name(name: str, namespace_: str, remappings: Mapping[str, str] | None = None) -> str:
    """Return the global name for a name.

    Args:
        name: the name.
        namespace_: the global name of the node that uses it.
        remappings: the replacements of global names.
    """
    if not name:
        return namespace(namespace_)
    name = canonicalize_name(name)
    if is_private(name):
        name = canonicalize_name(f"{namespace_}/{name[1:]}")
    elif not is_global(name):
        name = namespace(namespace_) + name
    return (remappings or {}).get(name, name)


def script_resolve_name(script_name: str, name: str) -> str:
    """Return the global name for a name in a program that is not a node."""
    if not name:
        return get_ros_namespace()
    if is_global(name):
        return name
    if is_private(name):
        return ns_join(make_caller_id(script_name), name[1:])
    return get_ros_namespace() + name


def load_mappings(argv: Iterable[str]) -> dict[str, str]:
    """Return the remappings on a command line, without the node's parameters (``_x:=1``)."""
    mappings = {}
    for argument in argv:
        if not is_legal_remap(argument):
            continue
        source, _, target = (part.strip() for part in argument.partition(REMAP))
        if REMAP in target:
            sys.stderr.write(f"ERROR: Invalid remapping argument '{argument}'\n")
        elif source and target and (not source.startswith("_") or source.startswith("__")):
            mappings[source] = target
    return mappings


def anonymous_name(id: str) -> str:
    """Return a unique name, ``id_<host>_<pid>_<number>``."""
    host, pid = socket.gethostname(), os.getpid()
    return anonymous_on_host(id, host=host, pid=pid, random=os.urandom(8))
