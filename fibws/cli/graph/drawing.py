"""A drawing of the graph in characters: publishers, topic and subscribers from left to right.

::

    /talker ────┬─> [/chatter std_msgs/String] ─┬─> /listener
    /talker_2 ──┘                               └─> /recorder
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from fibws.cli.output import counted, visible
from fibws.client.graph_view import DrawnAction, DrawnTopic, View

NO_PUBLISHER, NO_SUBSCRIBER = "(no publisher)", "(no subscriber)"


@dataclass(frozen=True, slots=True)
class Pen:
    """The characters of lines; the names of corners say which sides they join."""

    dash: str
    join: str
    """Left, right and below: the first one of several."""
    left_middle: str
    left_last: str
    right_middle: str
    right_last: str


LINES = Pen("─", "┬", "┤", "┘", "├", "└")
ASCII = Pen("-", "+", "+", "+", "+", "+")


def drawing(view: View, pen: Pen, width: int) -> Iterator[tuple[str, bool]]:
    """Yield the lines of a drawing, and for each whether it is a heading.

    Args:
        view: the nodes, topics, services and actions to draw.
        pen: the characters of lines.
        width: the maximum length of a line, if possible.
    """
    sections = [
        ("Topics", topics(view.topics, pen, width)),
        ("Services", _columns([(each.name, each.type, each.node) for each in view.services])),
        ("Actions", _columns([_action(each) for each in view.actions])),
        ("Other nodes", view.idle()),
        ("Conflicts", [f"{each.node} on {each.topic}: {each.text}" for each in view.conflicts]),
        ("Unreachable nodes", [f"{node}: {why}" for node, why in view.unreachable.items()]),
    ]
    for head, lines in sections:
        if lines:
            yield head, True
            # A name with line breaks, from another kind of server, must not look like several.
            yield from ((f"  {visible(line, keep='')}", False) for line in lines)
            yield "", False
    yield from ((line, False) for line in _summary(view))


def topics(found: Sequence[DrawnTopic], pen: Pen, width: int) -> list[str]:
    """Return the lines of topics: in columns, or one below the other if there is no room."""
    room = width - 2
    left = max((len(name) for topic in found for name in _publishers(topic)), default=0)
    middle = max((len(_box(topic)) for topic in found), default=0)
    columns = [_beside(topic, pen, left, middle) for topic in found]
    if _fits(columns, room):
        return _joined(columns)
    apart = [_beside(topic, pen, 0, 0) for topic in found]
    if _fits(apart, room):
        return _joined(apart)
    return _joined([_below(topic, pen) for topic in found])


def _beside(topic: DrawnTopic, pen: Pen, left: int, middle: int) -> list[str]:
    """Return a topic between its publishers and subscribers, in columns of a minimum width."""
    publishers, subscribers = _publishers(topic), _subscribers(topic)
    left = max(left, *map(len, publishers))
    middle = max(middle, len(_box(topic)))
    lines = []
    for number, (publisher, subscriber) in enumerate(zip_longest(publishers, subscribers)):
        arrives = _corner(number, len(publishers), pen.join, pen.left_middle, pen.left_last, pen)
        leaves = _corner(number, len(subscribers), pen.join, pen.right_middle, pen.right_last, pen)
        first = number == 0
        line = (
            " " * (left + 3) if publisher is None else _dashed(publisher, left + 2, pen) + arrives
        )
        line += f"{pen.dash}> " if first else "   "
        line += _dashed(_box(topic), middle + 2, pen) if first else " " * (middle + 2)
        line += "" if subscriber is None else f"{leaves}{pen.dash}> {subscriber}"
        lines.append(line.rstrip())
    return lines


def _below(topic: DrawnTopic, pen: Pen) -> list[str]:
    """Return a topic above its publishers and its subscribers."""
    return [
        _box(topic),
        *(f"  <{pen.dash * 2} {name}" for name in _publishers(topic)),
        *(f"  {pen.dash * 2}> {name}" for name in _subscribers(topic)),
    ]


def _corner(number: int, total: int, first: str, middle: str, last: str, pen: Pen) -> str:
    """Return the character where the line of a name meets those of others."""
    if total == 1:
        return pen.dash
    return first if number == 0 else last if number == total - 1 else middle


def _dashed(name: str, width: int, pen: Pen) -> str:
    return f"{name} ".ljust(width, pen.dash)


def _box(topic: DrawnTopic) -> str:
    type_ = topic.type or "type unknown"
    return f"[{topic.name} {type_}{'' if topic.checked or not topic.type else ', unchecked'}]"


def _publishers(topic: DrawnTopic) -> list[str]:
    return topic.publishers or [NO_PUBLISHER]


def _subscribers(topic: DrawnTopic) -> list[str]:
    return topic.subscribers or [NO_SUBSCRIBER]


def _columns(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Return lines of names, types and nodes."""
    boxes = [(name, f"[{type_ or 'type unknown'}]", node) for name, type_, node in rows]
    names = max((len(name) for name, _, _ in boxes), default=0)
    types = max((len(box) for _, box, _ in boxes), default=0)
    return [f"{name:{names}}  {box:{types}}  by {node}" for name, box, node in boxes]


def _action(action: DrawnAction) -> tuple[str, str, str]:
    goals = f", goals from {', '.join(action.clients)}" if action.clients else ""
    return action.name, action.type, f"{action.node or '(no server)'}{goals}"


def _fits(blocks: list[list[str]], width: int) -> bool:
    return all(len(line) <= width for block in blocks for line in block)


def _joined(blocks: list[list[str]]) -> list[str]:
    return [line for block in blocks for line in block]


def _summary(view: View) -> Iterator[str]:
    parts = [counted(len(view.nodes), "node"), counted(len(view.topics), "topic")]
    parts += [counted(len(view.services), "service"), counted(len(view.actions), "action")]
    yield f"{', '.join(parts)}."
    numbers = (view.hidden_nodes, view.hidden_topics, view.hidden_services)
    nouns = ("node", "topic", "service")
    hidden = [counted(*each) for each in zip(numbers, nouns, strict=True) if each[0]]
    if hidden:
        yield f"Hidden: {', '.join(hidden)} of the hub and its tools; --all shows them."
