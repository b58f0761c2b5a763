"""The groups of topics: which one a node joins by the type that it names, and when groups end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial

from fibws.errors import InterfaceError
from fibws.hub.errors import DefinitionMismatch
from fibws.hub.graph.conflicts import ConflictReports
from fibws.hub.graph.numbers import Numbers
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.type_group import TypeGroup
from fibws.hub.graph.types import ANY_TYPE, MessageType, Types
from fibws.interfaces import Interfaces


class TopicGroups:
    """Finds, numbers and removes the groups of topics.

    Args:
        topics: the topics of the graph, by name.
        internal: the hub's own nodes.
        later: does work step by step, some of it possibly later.
        touch: called when something has changed that is no user of a topic.
        changed: called when the users or the type of a topic have changed.
    """

    def __init__(
        self,
        topics: dict[str, Topic],
        types: Types,
        internal: set[str],
        conflicts: ConflictReports,
        *,
        later: Callable[[Iterator[None]], object],
        touch: Callable[[], object],
        changed: Callable[[Topic], object],
    ) -> None:
        self._topics = topics
        self._types = types
        self._internal = internal
        self._conflicts = conflicts
        self._later = later
        self._touch = touch
        self._changed = changed
        self._numbers = Numbers()

    def join(
        self,
        topic: Topic,
        type_: str,
        definition: str | None,
        md5sum: str | None,
        node: str,
        own: TypeGroup | None = None,
    ) -> tuple[TypeGroup, MessageType, MessageType | None]:
        """Return the group of the type that a node names, its type, and that which it had before.

        A group keeps its type when a node names another type with equal fields: as in ROS 1, where
        the md5 counts when nodes connect.

        Args:
            own: the group that the node is in already and may not leave.
        """
        name = Interfaces.canonical(type_)
        known = cache(partial(self._known_type, name, definition, md5sum, node))
        is_exact = definition is not None or md5sum not in (None, ANY_TYPE)
        group = _named_group(topic, name, own) if not is_exact else None
        group = group or self._find_group(topic, name, known)
        present = group.type if group is not None else None
        if group is not None and present is not None and (group.is_held or group is own):
            wanted = present
            if present.name == name and not present.checked:
                wanted = _updated(present, known, needs_definition=definition is not None)
        else:
            wanted = known()
        _check_md5sum(wanted, md5sum)
        if group is None:
            group = topic.add_group()
            if topic.main.number:
                self._number(group)
        if wanted is not present:
            self._change_type(group, wanted)
        return group, wanted, present

    def _known_type(
        self, name: str, definition: str | None, md5sum: str | None, node: str
    ) -> MessageType:
        """Return the type that a node means."""
        if node in self._internal:
            return self._types.own_message(name)
        return self._types.message(name, definition, node, md5sum)

    def _find_group(
        self, topic: Topic, name: str, known: Callable[[], MessageType]
    ) -> TypeGroup | None:
        """Return the group of a type, or one whose fields are unknown, or that has no type.

        Types of one name with other fields are other types.
        """
        try:
            md5sum = _identity(known())
        except InterfaceError:
            md5sum = None
        named = [each for each in topic.groups if each.type is not None and each.type.name == name]
        for group in (*named, *topic.groups):
            if md5sum is not None and group.type is not None and _identity(group.type) == md5sum:
                return group
        for group in named:
            if group.type is not None and _identity(group.type) is None:
                return group
        return next((each for each in topic.groups if each.type is None), None)

    def _change_type(self, group: TypeGroup, type_: MessageType | None) -> None:
        """Set a group's type, or None, and hold its definition."""
        self._touch()
        older, group.type = group.type, type_
        if type_ is not None and type_.checked:
            sort = (type_.name, type_.md5sum)
            if group.number and group.last_type not in (None, sort):
                # Messages of both types may be on their way to one client.
                self._number(group)
            group.last_type = sort
            for source in group.sources.values():
                source.type = type_
        if older is not None:
            self._types.release(older, group)
        if type_ is not None:
            self._types.hold(type_, group)

    def keep(self, topic: Topic) -> None:
        """Add a topic to the graph, since it has a user."""
        if self._topics.get(topic.name) is not topic:
            self._topics[topic.name] = topic
            for group in topic.groups:
                self._number(group)

    def _number(self, group: TypeGroup) -> None:
        """Give a group of a topic of the graph another number."""
        self._numbers.give_back(group.number)
        group.number = self._numbers.take()

    def _take_number(self, group: TypeGroup) -> None:
        self._numbers.give_back(group.number)
        group.number = 0

    def remove_idle(self, topic: Topic) -> None:
        """Remove a topic that has no user left."""
        if topic.idle and self._topics.get(topic.name) is topic:
            del self._topics[topic.name]
            for group in topic.groups:
                self._take_number(group)

    def settle(self, topic: Topic) -> None:
        """Remove the topic, its types, or their definitions if they have no holder left."""
        self.remove_idle(topic)
        for group in tuple(topic.groups):
            if group.type is not None and not group.needs_definition:
                type_ = self._types.without_definition(group.type) if group.is_used else None
                if type_ is not group.type:
                    self._change_type(group, type_)
        if len(topic.groups) > 1:
            self._settle_groups(topic)
            self._move_followers(topic)
        self._conflicts.settle(topic)
        self._changed(topic)

    def _settle_groups(self, topic: Topic) -> None:
        """Remove the groups that nobody uses any more, and choose the main one."""
        used = [each for each in topic.groups if each.is_used] or topic.groups[:1]
        for group in topic.groups:
            if group not in used:
                self._take_number(group)
        main = next((each for each in used if each.sources), None)
        main = main or next((each for each in used if each.is_held), used[0])
        topic.groups = [main, *(each for each in used if each is not main)]

    def _move_followers(self, topic: Topic) -> None:
        """Let sinks follow the publishers of the type that they name to another definition."""
        for group in topic.groups:
            if group.followers and not group.sources and not group.is_left:
                name = group.type.name if group.type is not None else ""
                if any(each.sources and _has_name(each, name) for each in topic.groups):
                    group.is_left = True
                    self._later(_leave(group))


def type_name(group: TypeGroup | None) -> str:
    """Return the name of a group's type; empty if it has none."""
    return group.type.name if group is not None and group.type is not None else ""


def _identity(type_: MessageType) -> str | None:
    """Return the md5 of a type, also of one that is known by its md5 alone."""
    return type_.md5sum if type_.claimed is None else type_.claimed


def _check_md5sum(type_: MessageType, md5sum: str | None) -> None:
    """Refuse a client whose definition of a type is another one."""
    if md5sum is not None and type_.md5sum is not None and md5sum not in (type_.md5sum, ANY_TYPE):
        raise DefinitionMismatch(type_.name, md5sum, type_.md5sum)


def _named_group(topic: Topic, name: str, own: TypeGroup | None) -> TypeGroup | None:
    """Return the group of a type that is only named: the node's own, or one that publishes.

    A type of which only the md5 is known is none that a name stands for: its messages are not
    checked.
    """
    if own is not None and type_name(own) == name:
        return own
    named = [each for each in topic.groups if _has_name(each, name)]
    held = [each for each in named if each.is_held]
    return next((each for each in held if each.sources), held[0] if held else None)


def _has_name(group: TypeGroup, name: str | None) -> bool:
    """Return whether a name may stand for the type of a group."""
    type_ = group.type
    return type_ is not None and type_.name == name and type_.claimed is None


def _updated(
    type_: MessageType, known: Callable[[], MessageType], *, needs_definition: bool
) -> MessageType:
    """Return a type of unknown fields, or the one in its place if they have become known."""
    try:
        found = known()
    except InterfaceError:
        if needs_definition:
            raise
        return type_
    return found if found.checked or found.fault else type_


def _leave(group: TypeGroup) -> Iterator[None]:
    """Let the followers of a group subscribe again, one by one."""
    for sink in tuple(group.followers):
        follow = group.followers.get(sink)
        if follow is not None and not group.sources:
            follow()
        yield
    group.is_left = False
