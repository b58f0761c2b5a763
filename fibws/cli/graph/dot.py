"""The graph for Graphviz: nodes are ellipses, topics are boxes."""

from __future__ import annotations

from collections.abc import Iterator

from fibws.cli.output import visible
from fibws.client.graph_view import View


def dot(view: View) -> Iterator[str]:
    """Yield the lines of a file for ``dot``."""
    yield "digraph graph_of_nodes {"
    yield "  rankdir=LR;"
    ends = {node for topic in view.topics for node in (*topic.publishers, *topic.subscribers)}
    ends |= {each.node for each in view.services} | {each.node for each in view.actions}
    ends |= {client for each in view.actions for client in each.clients}
    for node in sorted({*view.nodes, *ends}):
        if node in view.unreachable:
            yield _vertex("node", node, f"{node}\nunreachable", "shape=ellipse, style=dashed")
        else:
            yield _vertex("node", node, node, "shape=ellipse")
    for topic in view.topics:
        label = f"{topic.name}\n{topic.type}"
        style = "shape=box" if topic.checked else "shape=box, style=dashed"
        yield _vertex("topic", topic.name, label, style)
        for node in topic.publishers:
            yield _edge(("node", node), ("topic", topic.name))
        for node in topic.subscribers:
            yield _edge(("topic", topic.name), ("node", node))
    for conflict in view.conflicts:
        start, end = ("node", conflict.node), ("topic", conflict.topic)
        attributes = f"style=dotted, label={_quoted(conflict.text)}"
        yield _edge(*((start, end) if conflict.publishes else (end, start)), attributes)
    for service in view.services:
        yield _vertex("service", service.name, f"{service.name}\n{service.type}", "shape=cds")
        yield _edge(("service", service.name), ("node", service.node), "style=dashed")
    for action in view.actions:
        label = f"{action.name}\n{action.type}"
        yield _vertex("action", action.name, label, "shape=box, style=rounded")
        yield _edge(("action", action.name), ("node", action.node), "style=dashed")
        for client in action.clients:
            yield _edge(("node", client), ("action", action.name), "style=dashed")
    yield "}"


def _vertex(kind: str, name: str, label: str, attributes: str) -> str:
    return f"  {_id(kind, name)} [label={_quoted(label)}, {attributes}];"


def _edge(start: tuple[str, str], end: tuple[str, str], attributes: str = "") -> str:
    return f"  {_id(*start)} -> {_id(*end)}{f' [{attributes}]' if attributes else ''};"


def _id(kind: str, name: str) -> str:
    """Return an id; a node and a topic may have the same name."""
    return _quoted(f"{kind} {name}")


def _quoted(text: str) -> str:
    """Return a string of Graphviz, in which a backslash begins an escape."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{visible(escaped, keep="")}"'
