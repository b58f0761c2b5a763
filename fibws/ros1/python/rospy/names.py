"""Resolving names in this process: its node's name, its namespace and its remappings."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Mapping

from rosgraph.names import (
    ANYTYPE,
    GLOBALNS,
    REMAP,
    SEP,
    canonicalize_name,
    get_ros_namespace,
    is_global,
    is_legal_name,
    is_private,
    load_mappings,
    make_global_ns,
    namespace,
    ns_join,
)
from rosgraph.names import resolve_name as resolve_unmapped

from rospy.exceptions import ROSException, ROSInitException

__all__ = [
    "ANYTYPE",
    "GLOBALNS",
    "REMAP",
    "SEP",
    "SERVICE_ANYTYPE",
    "TOPIC_ANYTYPE",
    "canonicalize_name",
    "get_caller_id",
    "get_mappings",
    "get_name",
    "get_namespace",
    "get_resolved_mappings",
    "get_ros_namespace",
    "initialize_mappings",
    "is_global",
    "is_private",
    "load_mappings",
    "make_global_ns",
    "namespace",
    "ns_join",
    "reload_mappings",
    "remap_name",
    "resolve_name",
    "resolve_name_without_node_name",
    "scoped_name",
    "warn_unless_legal",
]

TOPIC_ANYTYPE = ANYTYPE
SERVICE_ANYTYPE = ANYTYPE

_mappings = load_mappings(sys.argv)
_resolved_mappings: dict[str, str] = {}
_namespace = get_ros_namespace()
_name = f"{_namespace}unnamed"


def get_name() -> str:
    """Return the node's global name; before `init_node` it is ``unnamed``."""
    return _name


get_caller_id = get_name


def get_namespace() -> str:
    """Return the namespace of relative names; it ends with ``/``."""
    return _namespace


def get_mappings() -> Mapping[str, str]:
    """Return the remappings as they are written on the command line."""
    return _mappings


def get_resolved_mappings() -> Mapping[str, str]:
    """Return the remappings of global names; empty before `init_node`."""
    return _resolved_mappings


def resolve_name(name: str | None, caller_id: str | None = None) -> str:
    """Return the global name for a name, with remappings applied.

    Args:
        name: the name; an empty one means the namespace.
        caller_id: the node that uses it; by default this one.
    """
    return resolve_unmapped(str(name or ""), caller_id or _name, _resolved_mappings)


def resolve_name_without_node_name(name: str) -> str:
    """Return the global name for a topic or service that is created before `init_node`.

    Raises:
        ValueError: the name is private.
        ROSInitException: it is remapped to a private name.
    """
    if is_private(name):
        raise ValueError("~name topics cannot be created before init_node() has been called")
    any_node = ns_join(_namespace, "node")
    resolved = resolve_unmapped(name, any_node)
    for source, target in _mappings.items():
        if resolve_unmapped(source, any_node) == resolved:
            if is_private(target):
                raise ROSInitException(
                    f"due to the way this node is written, {name} cannot be remapped to a ~name. \n"
                    "The declaration of topics/services must be moved after the call to init_node()"
                )
            return resolve_unmapped(target, any_node)
    return resolved


def remap_name(name: str, caller_id: str | None = None, resolved: bool = True) -> str:
    """Return the remapping of a name, or the name itself if it is not remapped in this spelling.

    Args:
        name: the name.
        caller_id: the node that uses it; by default this one.
        resolved: has no effect, as in rospy.
    """
    if name in _mappings:
        return resolve_unmapped(_mappings[name], caller_id or _name)
    return name


def scoped_name(caller_id: str, name: str) -> str:
    """Return a global name relative to the namespace of a node.

    Raises:
        ROSException: the node's name is not global.
    """
    if not is_global(caller_id):
        raise ROSException("caller_id must be global")
    return canonicalize_name(name)[len(namespace(caller_id)) :]


def warn_unless_legal(name: str, stacklevel: int) -> None:
    """Warn about a name that is not legal in ROS; rospy accepts it all the same."""
    if not is_legal_name(name):
        warnings.warn(
            f"'{name}' is not a legal ROS graph resource name. "
            "This may cause problems with other ROS tools",
            stacklevel=stacklevel,
        )


def reload_mappings(argv: Iterable[str]) -> None:
    """Read the remappings on another command line."""
    global _mappings
    _mappings = load_mappings(argv)


def initialize_mappings(node_name: str) -> None:
    """Apply the remappings from now on, for the node of this global name."""
    global _resolved_mappings
    _resolved_mappings = {}
    for source, target in _mappings.items():
        if not source.startswith("__"):
            source = resolve_unmapped(source, node_name)
            target = resolve_unmapped(target, node_name)
        _resolved_mappings[source] = target


def _set_caller_id(caller_id: str) -> None:
    """Set the global name of the process's node."""
    global _name, _namespace
    _name = caller_id
    _namespace = namespace(caller_id)
