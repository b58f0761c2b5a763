"""Conflicts: what is shown, and told, of topics that are used with more than one type."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice
from typing import TYPE_CHECKING, TypeAlias

from fibws.hub.graph.topic import Conflict, Sink, Source, Topic
from fibws.hub.graph.type_group import TypeGroup

if TYPE_CHECKING:
    from fibws.hub.graph.view import GraphView

ConflictReport: TypeAlias = Callable[[str], object]
"""Takes the reason why messages do not pass to others, or an empty text once they do."""

MOST_NAMED = 3
"""How many nodes of a type are named."""
MOST_TYPES = 64
"""Types of one topic, after which subscribers with others are refused. Publishers are not: no
subscription keeps them out."""


class ConflictReports:
    """Tells the members of groups of the conflicts in which they are.

    Args:
        view: returns the graph as a node sees it.
        later: does work step by step, some of it possibly later.
    """

    def __init__(
        self, view: Callable[[str], GraphView], later: Callable[[Iterator[None]], object]
    ) -> None:
        self._view = view
        self._later = later

    def settle(self, topic: Topic) -> None:
        """Tell the members of each group when the types have changed with which it conflicts."""
        groups = topic.groups
        if len(groups) == 1 and not groups[0].told:
            return
        for group in groups:
            news = summary(topic, group)
            if news != group.told:
                group.told = news
                if group.reports:
                    self._later(self._tell(group, news))

    def _tell(self, group: TypeGroup, news: tuple[tuple[str, bool], ...]) -> Iterator[None]:
        for member in tuple(group.reports):
            if group.told is not news:
                return  # They are told of something newer.
            self._report(group, member)
            yield

    def _report(self, group: TypeGroup, member: Source | Sink) -> None:
        report = group.reports.get(member)
        if report is not None:
            topic = group.topic
            is_over = not group.told
            report("" if is_over else describe(topic, group, self._view(member.node)))

    def report_to(
        self, group: TypeGroup, member: Source | Sink, report: ConflictReport | None
    ) -> None:
        """Have a member of a group told of conflicts from now on."""
        if report is not None:
            group.reports[member] = report
            if group.told:
                self._report(group, member)


def rivals(topic: Topic, group: TypeGroup) -> list[TypeGroup]:
    """Return the groups with which a group is in conflict; some of them, if they are many.

    Those that publish count, or the main group if none does: what a subscriber alone expects is of
    no concern to a publisher.
    """
    main = topic.main
    if main.sources:
        found = (each for each in topic.groups if each.sources and each is not group)
        return list(islice(found, MOST_NAMED))
    return [main] if main is not group and main.is_held else []


def summary(topic: Topic, group: TypeGroup) -> tuple[tuple[str, bool], ...]:
    """Return the types of the rivals of a group, and whether they publish.

    The members of the group are told of a conflict again when this changes.
    """
    found = rivals(topic, group)
    return tuple((_label(each, group), bool(each.sources)) for each in found)


def describe(topic: Topic, group: TypeGroup, view: GraphView) -> str:
    """Return why a group exchanges no messages with others, for a node that sees the view."""
    found = rivals(topic, group)
    others = " and ".join(
        f"type {_label(each, group)}{_users(topic, each, view)}" for each in found
    )
    own = _name(group)
    if own in map(_name, found):
        own = f"{own} (md5sum {_md5sum(group)})"
    return f"{topic.name} has {others}: no messages pass from or to type {own}"


def _label(group: TypeGroup, other: TypeGroup) -> str:
    """Return the name of a group's type, and how it differs from another type of that name."""
    name = _name(group)
    return name if name != _name(other) else f"{name} with other fields (md5sum {_md5sum(group)})"


def _name(group: TypeGroup) -> str:
    return group.type.name if group.type is not None else ""


def _md5sum(group: TypeGroup) -> str:
    type_ = group.type
    return (type_.claimed or type_.md5sum if type_ is not None else None) or "unknown"


def list_conflicts(topic: Topic, view: GraphView) -> Iterator[Conflict]:
    """Yield the nodes that use a topic with another type than it has, as far as they are seen."""
    if topic.held:
        names = Counter(map(_name, topic.groups))
        for group in topic.groups[1:]:
            if group.type is not None:
                fault = describe(topic, group, view)
                md5sum = _md5sum(group) if names[_name(group)] > 1 else ""
                for publishes, nodes in ((True, group.sources), (False, group.naming())):
                    for node in nodes:
                        if view.sees_user(topic, node):
                            yield Conflict(node, group.type.name, publishes, fault, md5sum)
    yield from (each for each in topic.unattached if view.sees_user(topic, each.node))


def _users(topic: Topic, group: TypeGroup, view: GraphView) -> str:
    """Return who uses a type, in brackets; nothing if the view hides them."""
    seen = [each for each in group.members() if view.sees_user(topic, each)]
    if not seen:
        return ""
    more = f" and {len(seen) - MOST_NAMED} more" if len(seen) > MOST_NAMED else ""
    use = "published" if group.sources else "subscribed to"
    return f" ({use} by {', '.join(islice(seen, MOST_NAMED))}{more})"
