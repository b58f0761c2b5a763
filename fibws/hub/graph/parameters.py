"""The parameter server: a tree of values that all nodes share.

Its rules are those of ROS 1 (http://wiki.ros.org/Parameter%20Server and rosmaster's
paramserver.py): a name leads through namespaces to a value, a namespace is read and replaced as
one object, and a value gives way to a namespace of its name.

Values are kept as JSON, as they arrive and leave: it is exact for integers and floats alike, nobody
can change it from outside, and its length is the memory it takes. Values of XML-RPC that JSON lacks
are objects with one key, ``{"$binary": "<base64>"}`` and ``{"$date": "2026-01-31T12:00:00"}``;
infinity is a number that no float can hold, and NaN is null. A dict with a key that cannot be a
part of a name, such as ``a/b``, is a value, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Set
from datetime import datetime
from typing import Any, NamedTuple, TypeAlias

from pydantic_core import from_json, to_json

from fibws.errors import InvalidName, ParameterError, ParameterNotSet
from fibws.hub.errors import ParametersFull
from fibws.interfaces import base64text
from fibws.interfaces.json_text import exact_json_of
from fibws.names import MAX_LENGTH

BINARY, DATE = "$binary", "$date"
"""The keys of objects that stand for bytes and for a date with a time."""

DEEPEST = 100
"""Levels of namespaces, objects and lists that may be nested."""
MOST_BITS = 1024
"""Bits of an integer: programs whose numbers are all floats read a larger one as infinity."""
ENTRY_OVERHEAD = 100
"""Bytes that each parameter and namespace counts for besides its name and its value."""

Namespace: TypeAlias = dict[str, "Namespace | bytes"]


class Prepared(NamedTuple):
    """A parameter's new value, or a namespace's, as `Parameters` keeps it."""

    path: list[str]
    tree: Namespace | bytes
    size: int
    """The bytes that it counts for."""


def prepare(name: str, value: object) -> Prepared:
    """Return what `Parameters.put` takes; for large values, in any thread.

    Args:
        value: dicts, lists, strings, bools, numbers, bytes and dates; no None.

    Raises:
        InvalidName: the name, or that of a key in the value, is invalid.
        ParameterError: a parameter cannot have this value.
    """
    path = _path(name)
    _check_depth(name, len(path) - 2)  # That of the namespace it is in.
    tree = _to_tree("/".join(path), value, len(path) - 1)
    if len(path) == 1 and not isinstance(tree, dict):
        raise ParameterError("/ is the namespace of all parameters: set it to an object of names")
    return Prepared(path, tree, _size("/".join(path), tree))


class Parameters:
    """All parameters of one hub, by their global names.

    Names are as ROS's master accepts them: they may have any characters, and empty parts do not
    count, so that ``/a//b/`` is ``/a/b``. ``/`` is the root namespace.

    Args:
        max_bytes: most bytes of all together, names and `ENTRY_OVERHEAD` included.
    """

    def __init__(self, max_bytes: int) -> None:
        # The root is in a namespace like all others: its key is the text before the first /.
        self._above: Namespace = {"": {}}
        self.bytes = _size("", {})
        """Bytes of all together, as far as they count."""
        self._watchers: list[Callable[[str, str], None]] = []
        self.max_bytes = max_bytes

    def watch(self, changed: Callable[[str, str], None]) -> None:
        """Call a function after each change, with the name set or deleted and the node."""
        self._watchers.append(changed)

    def get(self, name: str) -> Any:
        """Return a copy of the value, or of a namespace as a dict.

        Raises:
            ParameterNotSet: the parameter is not set.
            InvalidName: the name is not global, or too long.
        """
        return from_json(self.text(name))

    def text(self, name: str, only: Collection[str] | None = None) -> bytes:
        """Return the value as JSON; raises as `get` does.

        Args:
            only: the names of the parameters of a namespace to return; None for all.
        """
        found = self._find(_path(name))
        if found is None:
            raise ParameterNotSet(name)
        if only is not None:
            found = _without(found, _root(name), frozenset(only)) or {}
        parts: list[bytes] = []
        _write(found, parts)
        return b"".join(parts)

    def tree(self) -> Namespace:
        """Return the root namespace itself, which changes; other threads may read it.

        They iterate over copies of its dicts. Values are JSON, and never change.
        """
        root = self._above[""]
        assert isinstance(root, dict)
        return root

    def has(self, name: str) -> bool:
        """Return whether there is a parameter or namespace of this name; raises `InvalidName`."""
        return self._find(_path(name)) is not None

    def set(self, name: str, value: object, node: str = "") -> None:
        """Set a parameter, replacing a value or a namespace; a dict becomes a namespace.

        Args:
            value: as for `prepare`.
            node: the node that sets it, for those who watch.

        Raises:
            InvalidName, ParameterError: as for `prepare`.
            ParametersFull: all parameters together would exceed the limit.
        """
        self.put(prepare(name, value), node)

    def put(self, prepared: Prepared, node: str = "") -> None:
        """Set a parameter to a value that is prepared; raises `ParametersFull`."""
        path, new, added = prepared
        space, depth = self._above, 0
        while depth < len(path) - 1:
            below = space.get(path[depth])
            if not isinstance(below, dict):
                break
            space, depth = below, depth + 1
        for above in range(len(path) - 1, depth, -1):
            new = {path[above]: new}
            added += _size("/".join(path[:above]), {})
        key = path[depth]
        old = space.get(key)
        needed = self.bytes + added
        if old is not None:
            needed -= _size("/".join(path[: depth + 1]), old)
        if needed > self.max_bytes:
            raise ParametersFull("/".join(path) or "/", needed, self.max_bytes)
        space[key] = new
        self.bytes = needed
        self._report("/".join(path) or "/", node)

    def delete(self, name: str, node: str = "") -> None:
        """Delete a parameter, or a namespace with everything in it; its own namespace remains.

        Args:
            node: the node that deletes it, for those who watch.

        Raises:
            ParameterNotSet: the parameter is not set.
            ParameterError: it is the root namespace.
            InvalidName: the name is not global, or too long.
        """
        *above, key = path = _path(name)
        if len(path) == 1:
            raise ParameterError("/ is the namespace of all parameters: it cannot be deleted")
        space = self._find(above)
        if not isinstance(space, dict) or key not in space:
            raise ParameterNotSet(name)
        self.bytes -= _size("/".join(path), space.pop(key))
        self._report("/".join(path), node)

    def search(
        self, key: str, namespace: str, shows: Callable[[str], bool] = lambda name: True
    ) -> str | None:
        """Return the nearest name of ``key``, searching a namespace and then those above it.

        As in ROS, only the first part of the key is searched for: ``robot/arm`` is found where
        there is a ``robot``, whether or not that has an ``arm``.

        Args:
            key: a relative name; a global one is returned if it is set.
            namespace: where the search begins, as a global name; for a node, its own name.
            shows: returns whether a parameter or a namespace may be found.

        Raises:
            InvalidName: the key is empty, private or too long, or the namespace is not global.
        """
        if key.startswith("/"):
            return key if self.has(key) and shows(key) else None
        if key.startswith("~"):
            raise InvalidName(key, "a private name cannot be searched for")
        _, *parts = _path(f"/{key}")
        if not parts:
            raise InvalidName(key, "it is empty")
        path = _path(namespace)
        node: Namespace | bytes | None = self._above
        found = None
        for depth, part in enumerate(path, 1):
            if not isinstance(node, dict):
                break
            node = node.get(part)
            if isinstance(node, dict) and parts[0] in node:
                found = depth if shows("/".join([*path[:depth], parts[0]])) else found
        return None if found is None else "/".join([*path[:found], *parts])

    def names(self) -> list[str]:
        """Return the names of all parameters, sorted, without namespaces."""
        return sorted(_names("", self._above[""]))

    def below(self, name: str) -> list[str]:
        """Return the names of the parameters in a namespace, or the name itself if it has a value.

        It is empty for names that are not set, and raises `InvalidName`.
        """
        found = self._find(_path(name))
        return [] if found is None else list(_names(_root(name), found))

    def is_leaf(self, name: str) -> bool:
        """Return whether a name has a value, or is a namespace in which there is nothing."""
        found = self._find(_path(name))
        return isinstance(found, bytes) or found == {}

    def leaves(self, name: str) -> list[str]:
        """Return the names as `below` does, and those of namespaces in which there is nothing."""
        found = self._find(_path(name))
        return [] if found is None else list(_names(_root(name), found, with_empty=True))

    def replaced_by(self, name: str) -> list[str]:
        """Return the parameters that would be replaced by one of this name, or else the name."""
        path = _path(name)
        for depth in range(1, len(path)):
            if isinstance(self._find(path[:depth]), bytes):
                return ["/".join(path[:depth])]
        return self.below(name) or [name]

    def _report(self, name: str, node: str) -> None:
        for changed in self._watchers:
            changed(name, node)

    def _find(self, path: list[str]) -> Namespace | bytes | None:
        node: Namespace | bytes | None = self._above
        for key in path:
            if not isinstance(node, dict):
                return None
            node = node.get(key)
        return node


def canonical(name: str) -> str:
    """Return a parameter's name without empty parts: ``/a/b`` for ``/a//b/``."""
    return "/".join(_path(name)) or "/"


def is_namespace(value: dict[Any, Any]) -> bool:
    """Return whether a dict is kept as a namespace, and not as one value.

    It is a value if a key cannot be a part of a name: it is empty, or has a ``/``.
    """
    return all(key and "/" not in key for key in value if isinstance(key, str))


def names_in(name: str, value: dict[str, Any]) -> Iterator[str]:
    """Yield the names of the parameters that a dict would be, set to a namespace's name."""
    if not is_namespace(value):
        yield name
        return
    for key, each in value.items():
        below = f"{_root(name)}/{key}"
        if isinstance(each, dict) and each:
            yield from names_in(below, each)
        else:
            yield below


def _root(name: str) -> str:
    """Return the prefix of all names below a canonical name; it is empty for the root."""
    return "" if name == "/" else name


def _path(name: str) -> list[str]:
    """Return the keys that lead to a name, the root's first."""
    _check_length(name)
    if not name.startswith("/"):
        raise InvalidName(name, "the global name of a parameter begins with /")
    return ["", *(key for key in name.split("/") if key)]


def _check_length(name: str) -> None:
    if len(name) > MAX_LENGTH:
        raise InvalidName(name[:40] + "...", f"it is longer than {MAX_LENGTH} characters")


def native(value: Any) -> Any:
    """Return a parameter's value, read from its JSON, with bytes, dates and NaN as such.

    It changes lists and dicts in place.
    """
    match value:
        case None:
            return math.nan
        case {"$binary": str() as text} if len(value) == 1:
            return base64text.decode(text)
        case {"$date": str() as text} if len(value) == 1:
            return datetime.fromisoformat(text)
        case dict():
            for key, each in value.items():
                value[key] = native(each)
        case list():
            value[:] = map(native, value)
    return value


def _is_special(name: str, value: object) -> bool:
    """Return whether an object stands for bytes or a date; raise `ParameterError` for half ones."""
    if not isinstance(value, dict) or len(value) != 1:
        return False
    ((key, text),) = value.items()
    if key not in (BINARY, DATE) or not isinstance(text, str):
        return False
    try:
        native({key: text})
    except ValueError:
        expected = "base64" if key == BINARY else "an ISO 8601 date"
        fault = f"Parameter [{name}]: invalid {key}, expected {expected}"
        raise ParameterError(fault) from None
    return True


def _marked(value: Any) -> Any:
    """Return a value with objects for bytes and dates."""
    match value:
        case bytes():
            return {BINARY: base64text.encode(value)}
        case datetime():
            return {DATE: value.isoformat()}
        case list():
            return [_marked(each) for each in value]
        case dict():
            return {key: _marked(each) for key, each in value.items()}
    return value


def _to_tree(name: str, value: object, depth: int) -> Namespace | bytes:
    """Return a value as the tree keeps it."""
    if not isinstance(value, dict) or _is_special(name, value) or not is_namespace(value):
        is_plain = _check(name, value, depth)
        return to_json(value) if is_plain else exact_json_of(_marked(value))
    _check_depth(name, depth)
    space: Namespace = {}
    for key, each in value.items():
        below = f"{name}/{key}"
        _check_length(below)
        if not isinstance(key, str):
            raise InvalidName(below, "a key in a namespace is a text")
        space[key] = _to_tree(below, each, depth + 1)
    return space


def _check(name: str, value: object, depth: int) -> bool:
    """Raise `ParameterError` for an invalid value; return whether JSON can hold it as it is."""
    match value:
        case bool() | str():
            return True
        case int():
            if value.bit_length() > MOST_BITS:
                raise ParameterError(f"Parameter [{name}]: an integer has at most {MOST_BITS} bits")
            return True
        case float():
            return math.isfinite(value)
        case bytes() | datetime():
            return False
        case list():
            _check_depth(name, depth)
            return all([_check(name, each, depth + 1) for each in value])
        case dict():
            _check_depth(name, depth)
            _is_special(name, value)
            return all([_check(name, each, depth + 1) for each in value.values()])
        case None:
            raise ParameterError(f"Parameter [{name}]: null cannot be set, delete it instead")
        case _:
            raise ParameterError(f"Parameter [{name}]: JSON has no {type(value).__name__}")


def _check_depth(name: str, depth: int) -> None:
    if depth > DEEPEST:
        raise ParameterError(f"Parameter [{name}]: nested too deeply, limit is {DEEPEST}")


def _size(name: str, node: Namespace | bytes) -> int:
    """The bytes that a parameter counts for, or a namespace with all in it."""
    own = ENTRY_OVERHEAD + len(to_json(name))
    if isinstance(node, bytes):
        return own + len(node)
    return own + sum(_size(f"{name}/{key}", each) for key, each in node.items())


def _write(node: Namespace | bytes, parts: list[bytes]) -> None:
    """Add the node's JSON text to the parts of one."""
    if isinstance(node, bytes):
        parts.append(node)
        return
    before = b"{"
    for key, each in node.items():
        parts += before, to_json(key), b":"
        _write(each, parts)
        before = b","
    parts.append(b"}" if node else b"{}")


def _without(node: Namespace | bytes, name: str, only: Set[str]) -> Namespace | bytes | None:
    """Return the part of a tree that holds some parameters; None if it holds none of them."""
    if isinstance(node, bytes):
        return node if name in only else None
    parts = ((key, _without(each, f"{name}/{key}", only)) for key, each in node.items())
    return {key: part for key, part in parts if part is not None} or None


def _names(name: str, node: Namespace | bytes, *, with_empty: bool = False) -> Iterator[str]:
    if isinstance(node, bytes) or (with_empty and not node):
        yield name
    else:
        for key, each in node.items():
            yield from _names(f"{name}/{key}", each, with_empty=with_empty)
