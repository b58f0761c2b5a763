"""In which order packages are built: each behind those that it depends on."""

from __future__ import annotations

from collections.abc import Mapping

from fibws.errors import WorkspaceError


def in_order(depends: Mapping[str, set[str]]) -> list[str]:
    """The names, each behind those that it depends on, and else by the alphabet.

    Args:
        depends: which others each depends on; those that are no key do not matter.

    Raises:
        WorkspaceError: some depend on each other in a circle; its text draws that.
    """
    left = {name: others & depends.keys() - {name} for name, others in depends.items()}
    order: list[str] = []
    while left:
        ready = sorted(name for name, others in left.items() if not others & left.keys())
        if not ready:
            circle = " -> ".join(_circle(left))
            raise WorkspaceError(f"these packages depend on each other in a circle: {circle}")
        order.append(ready[0])
        del left[ready[0]]
    return order


def with_needed(names: set[str], depends: Mapping[str, set[str]]) -> set[str]:
    """The names, and all that they depend on, as far as those are keys."""
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name in depends and name not in found:
            found.add(name)
            pending += depends[name]
    return found


def _circle(left: Mapping[str, set[str]]) -> list[str]:
    """A way through packages of which each depends on another one, that comes back to itself."""
    path = [min(left)]
    while path[-1] not in path[:-1]:
        path.append(min(left[path[-1]] & left.keys()))
    return path[path.index(path[-1]) :]
