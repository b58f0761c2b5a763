"""Names of the graph, as rosgraph has them, and names of resources: ``package/Name``."""

from __future__ import annotations

import re

from rosgraph.names import (
    ANYTYPE,
    GLOBALNS,
    PRIV_NAME,
    REMAP,
    SEP,
    anonymous_name,
    canonicalize_name,
    get_ros_namespace,
    is_global,
    is_legal_base_name,
    is_legal_name,
    is_private,
    load_mappings,
    make_caller_id,
    make_global_ns,
    namespace,
    ns_join,
    resolve_name,
)

__all__ = [
    "ANYTYPE",
    "GLOBALNS",
    "PRIV_NAME",
    "PRN_SEPARATOR",
    "REMAP",
    "SEP",
    "TYPE_SEPARATOR",
    "anonymous_name",
    "canonicalize_name",
    "get_ros_namespace",
    "is_global",
    "is_legal_base_name",
    "is_legal_name",
    "is_legal_resource_base_name",
    "is_legal_resource_name",
    "is_private",
    "load_mappings",
    "make_caller_id",
    "make_global_ns",
    "namespace",
    "ns_join",
    "package_resource_name",
    "resolve_name",
    "resource_name",
    "resource_name_base",
    "resource_name_package",
]

PRN_SEPARATOR = "/"
TYPE_SEPARATOR = PRN_SEPARATOR

_RESOURCE_NAME = re.compile(r"[A-Za-z][\w/]*")


def is_legal_resource_name(name: str | None) -> bool:
    """Return whether a name is legal for a resource: ``std_msgs/String``."""
    return name is not None and _RESOURCE_NAME.fullmatch(name) is not None and "//" not in name


def is_legal_resource_base_name(name: str | None) -> bool:
    """Return whether a name is legal for a resource without its package: ``String``."""
    return is_legal_base_name(name)


def resource_name(res_pkg_name: str, name: str, my_pkg: str | None = None) -> str:
    """Return ``package/name``; only the name if the package is empty or ``my_pkg``."""
    if not res_pkg_name or res_pkg_name == my_pkg:
        return name
    return f"{res_pkg_name}{PRN_SEPARATOR}{name}"


def resource_name_base(name: str) -> str:
    """Return a resource's name without its package."""
    return name.rpartition(PRN_SEPARATOR)[2]


def resource_name_package(name: str) -> str | None:
    """Return the package in a resource's name; None without one."""
    return name.partition(PRN_SEPARATOR)[0] if PRN_SEPARATOR in name else None


def package_resource_name(name: str) -> tuple[str, str]:
    """Return the package, which may be empty, and the rest of a resource's name.

    Raises:
        ValueError: the name has more than one slash.
    """
    package, slash, rest = name.partition(PRN_SEPARATOR)
    if not slash:
        return "", name
    if PRN_SEPARATOR in rest:
        raise ValueError(f"invalid name [{name}]")
    return package, rest
