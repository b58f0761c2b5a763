"""Graph names: checking and resolving them, anonymous names, remapping.

The rules are those of http://wiki.ros.org/Names and http://wiki.ros.org/Remapping%20Arguments.
Pure: no clock, no environment, no sockets.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from fibws.errors import InvalidName

MAX_LENGTH = 1024
HUB_TOPICS = frozenset(
    ("/client_count", "/connected_clients", "/hub_recorder/state", "/rosout_agg")
)
"""The topics that only a hub may publish."""
_LEGAL = re.compile(r"([A-Za-z]\w*|[~/]\w+)(/\w+)*", re.ASCII)
_LEGAL_BASE = re.compile(r"[A-Za-z]\w*", re.ASCII)


class Resolve(Protocol):
    """`resolve` or `resolve_any`."""

    def __call__(self, name: str, *, namespace: str = "/", node: str = "/") -> str:
        """Return the global name for ``name``."""


def is_legal(name: str) -> bool:
    """Return whether `check` accepts the name."""
    return len(name) <= MAX_LENGTH and _LEGAL.fullmatch(name) is not None


def check_text(name: object) -> None:
    """Raise TypeError unless a name is a string."""
    if isinstance(name, type):
        raise TypeError(f"a name must be a string, got the class {name.__name__}")
    if not isinstance(name, str):
        raise TypeError(f"a name must be a string, got {name!r}")


def check(name: str) -> str:
    """Return ``name`` if it is a legal graph name; raise `InvalidName` otherwise."""
    check_text(name)
    if not name:
        raise InvalidName(name, "it is empty")
    if len(name) > MAX_LENGTH:
        raise InvalidName(name[:40] + "...", f"it is longer than {MAX_LENGTH} characters")
    if not _LEGAL.fullmatch(name):
        raise InvalidName(
            name, "write a to z, digits, _ and /; begin with a letter, / or ~; do not end in / or ~"
        )
    return name


def check_base(name: str) -> str:
    """Return ``name`` if it can name a node: a legal name without a namespace."""
    if "/" in name:
        raise InvalidName(name, "namespaces are not allowed in node names; use __ns:=/NAMESPACE")
    if not _LEGAL_BASE.fullmatch(name) or len(name) > MAX_LENGTH:
        raise InvalidName(name, "a node's name is a letter of a to z, then letters, digits and _")
    return name


def resolve(name: str, *, namespace: str = "/", node: str = "/") -> str:
    """Return the global name for ``name``.

    Args:
        name: global (``/a/b``), relative to the namespace (``b``) or private to the node (``~b``).
        namespace: a global name such as ``/robot``, or ``/``.
        node: the node's own global name.

    Raises:
        InvalidName: the name is not legal.
    """
    check(name)
    if name.startswith("/"):
        return name
    if name.startswith("~"):
        return join(node, name[1:])
    return join(namespace, name)


def resolve_any(name: str, *, namespace: str = "/", node: str = "/") -> str:
    """Return the global name for ``name``, which need not be legal.

    rospy accepts names such as ``/a-b`` with a warning. Empty parts are ignored, as by
    rosgraph.names.canonicalize_name: ``/x//y`` and ``/x/y/`` are ``/x/y``.

    Args:
        name: as in `resolve`.
        namespace: as in `resolve`.
        node: as in `resolve`.

    Raises:
        InvalidName: the name is empty or too long, or has whitespace or control characters, which
            would confuse terminals and tools.
    """
    if is_legal(name) or not name or len(name) > MAX_LENGTH:
        return resolve(name, namespace=namespace, node=node)
    if " " in name or not name.isprintable():
        raise InvalidName(name, "names have no whitespace or control characters")
    parts = "/".join(filter(None, name.removeprefix("~").split("/")))
    if not parts:
        raise InvalidName(name, f"expected a name after {name}")
    if name.startswith("/"):
        return f"/{parts}"
    return join(node if name.startswith("~") else namespace, parts)


def join(namespace: str, name: str) -> str:
    """Return ``/robot/arm`` for ``/robot`` and ``arm``; the root is ``/``."""
    return f"{namespace.rstrip('/')}/{name}"


def anonymous(name: str, *, pid: int, random: bytes) -> str:
    """Return a node name that no other node has, of rospy's form: ``name_<pid>_<13 digits>``.

    rospy's digits are the milliseconds since 1970. Nodes in containers, which start together and
    have equal pids, would get equal names from these.

    Args:
        random: at least 8 random bytes.
    """
    digits = 10**12 + int.from_bytes(random) % (9 * 10**12)
    return f"{name}_{pid}_{digits}"


def anonymous_on_host(name: str, *, host: str, pid: int, random: bytes) -> str:
    """Return a unique name of the form of roslaunch's ``$(anon)``: ``name_<host>_<pid>_<number>``.

    Args:
        random: at least 8 random bytes; containers may have equal host names, pids and clocks.
    """
    unique = f"{name}_{host}_{pid}_{int.from_bytes(random)}"
    return "".join(each if each.isalnum() and each.isascii() else "_" for each in unique)


@dataclass(frozen=True, slots=True)
class Remapping:
    """The ``from:=to`` arguments of a command line.

    ``__name`` and ``__ns`` name the node and its namespace; ``names`` holds the others as they
    were spelled. ``parameters`` are the private ones, ``_rate:=10``, without the underscore; their
    values are YAML.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    node_name: str | None = None
    namespace: str | None = None
    parameters: Mapping[str, str] = field(default_factory=dict)

    def apply(
        self, name: str, *, namespace: str, node: str, resolver: Resolve | None = None
    ) -> str:
        """Resolve ``name``, then replace it if it was remapped.

        Args:
            name: as the next ones, an argument of `resolve`.
            namespace: another one.
            node: another one.
            resolver: resolves names; by default `resolve`, which takes legal ones only.
        """
        resolver = resolver or resolve
        resolved = resolver(name, namespace=namespace, node=node)
        for source, target in self.names.items():
            if resolver(source, namespace=namespace, node=node) == resolved:
                return resolver(target, namespace=namespace, node=node)
        return resolved


def parse_remappings(arguments: Iterable[str]) -> Remapping:
    """Read ``from:=to`` arguments; keys that begin with ``__`` are ROS's special ones.

    ``__name`` and ``__ns`` are used; other special keys are ignored.

    Raises:
        InvalidName: an argument is not a remapping, or a name in it is not legal.
    """
    names: dict[str, str] = {}
    special: dict[str, str] = {}
    parameters: dict[str, str] = {}
    for argument in arguments:
        source, mark, target = argument.partition(":=")
        if not mark:
            raise InvalidName(argument, "a remapping is written from:=to")
        if source.startswith("__"):
            special[source] = target
        elif source.startswith("_"):
            parameters[check(source[1:])] = target
        elif not target:
            raise InvalidName(argument, "expected a name after :=")
        else:
            names[check(source)] = check(target)
    node_name = special.get("__name")
    namespace = special.get("__ns")
    return Remapping(
        names=names,
        node_name=check_base(node_name) if node_name is not None else None,
        namespace=check_namespace(namespace) if namespace is not None else None,
        parameters=parameters,
    )


def check_namespace(name: str) -> str:
    """Return a namespace as a global name: ``/`` or ``/a/b``."""
    check_text(name)
    stripped = name.strip("/")
    if stripped.startswith("~"):
        raise InvalidName(name, "a namespace cannot be private")
    return resolve(stripped) if stripped else "/"
