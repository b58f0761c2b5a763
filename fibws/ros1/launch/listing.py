"""What is told of a launch before anything runs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from fibws.ros1.launch.model import Argument, Launch, Node

LONGEST_VALUE = 20
"""Characters of a parameter's value in the summary."""


def summary(launch: Launch) -> Iterator[str]:
    """The lines of what is going to be: parameters, and nodes by their namespaces."""
    yield from ("", "SUMMARY", "========")
    if launch.cleared:
        yield from ("", "CLEAR PARAMETERS")
        yield from sorted(f" * {name.rstrip('/')}/" for name in launch.cleared)
    yield from ("", "PARAMETERS")
    yield from sorted(f" * {name}: {_short(each)}" for name, each in launch.parameters.items())
    yield from ("", "NODES")
    nodes = [node for node in launch.nodes.values() if not node.is_test]
    for namespace in sorted({node.namespace for node in nodes}):
        yield f"  {namespace.rstrip('/')}/"
        yield from sorted(_named(node) for node in nodes if node.namespace == namespace)
    yield ""


def arguments(known: Iterable[Argument]) -> Iterator[str]:
    """The lines of what may be given on the command line."""
    given = sorted((each for each in known if not each.has_value), key=lambda each: each.name)
    if not given:
        yield "No arguments."
    needed = [each for each in given if not each.default]
    if needed:
        yield "Required Arguments:"
        yield from (f"  {each.name}: {each.doc or 'undocumented'}" for each in needed)
    if len(needed) < len(given):
        yield "Optional Arguments:"
        for each in given:
            if each.default:
                yield f'  {each.name} (default "{each.default}"): {each.doc or "undocumented"}'


def _named(node: Node) -> str:
    return f"    {node.name} ({node.package}/{node.type})"


def _short(value: Any) -> str:
    text = str(value)
    if len(text) > LONGEST_VALUE:
        text = f"{text[: LONGEST_VALUE - 3]}..."
    text = text.rstrip()
    return text if text.isprintable() else "<...>"
