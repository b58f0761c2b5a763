"""Definitions of message, service and action types, in the lines of rosmsg show."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from fibws.definition_folders import named_folders
from fibws.suggestions import nearest
from fibws.values.typedefs import TIMES, Typedefs

if TYPE_CHECKING:
    from fibws.interfaces import MessageDefinition
    from fibws.interfaces.folders import Kind


class Definition(NamedTuple):
    """The definition of a type."""

    text: str
    """The definition as written, with comments."""
    lines: list[str]
    """The lines of rosmsg show, which include nested types."""


class InstalledTypes:
    """The types of one kind that are defined on this machine: standard ones and the user's own.

    Args:
        kind: msg, srv or action.
        folders: folders of definitions besides those in $FIBWS_INTERFACES.

    Raises:
        InterfaceError: a folder does not exist.
    """

    def __init__(self, kind: Kind, folders: Sequence[Path] = ()) -> None:
        from fibws.interfaces import Interfaces  # 0.1 s

        self._interfaces = Interfaces([*map(Path, named_folders()), *folders])
        self._kind = kind

    def packages(self) -> list[str]:
        """Return the packages that have such types, sorted."""
        return [name for name in self._interfaces.packages() if self.names(name)]

    def names(self, package: str) -> list[str]:
        """Return a package's types as ``package/Type``, sorted; raise `UnknownPackage`."""
        return self._interfaces.types(package, self._kind)

    def all(self) -> Iterator[str]:
        """Yield all types, sorted."""
        for package in self._interfaces.packages():
            yield from self.names(package)

    def find(self, short: str) -> list[str]:
        """Return the types of a name without a package, in all packages."""
        return [name for name in self.all() if name.partition("/")[2] == short]

    def nearest(self, name: str) -> str | None:
        """Return the type with the most similar name, in its package or in any other one."""
        known = list(self.all())
        if found := nearest(name, known):
            return found
        shorts = {each.partition("/")[2]: each for each in reversed(known)}
        short = nearest(name.rpartition("/")[2], shorts, 0.8)
        return shorts[short] if short else None

    def definition(self, name: str) -> Definition:
        """Return the definition of a type; raise as `Interfaces.message`."""
        parts = self._parts(name)
        lines: list[str] = []
        for part in parts:
            if part is not parts[0]:
                lines.append("---")
            lines += _lines(_members(part), self._members_of)
        return Definition("\n---\n".join(part.text for part in parts), lines)

    def md5(self, name: str) -> str:
        """Return the MD5 of a message or service type, as in ROS 1; raise as `definition`."""
        if self._kind == "srv":
            return self._interfaces.service_md5(name)
        return self._interfaces.md5(name)

    def _parts(self, name: str) -> list[MessageDefinition]:
        if self._kind == "msg":
            return [self._interfaces.message(name)]
        if self._kind == "srv":
            service = self._interfaces.service(name)
            return [service.request, service.response]
        action = self._interfaces.action(name)
        return [action.goal, action.result, action.feedback]

    def _members_of(self, type_: str) -> list[_DefinitionMember]:
        return _members(self._interfaces.message(type_))


def typedefs_lines(typedefs: Typedefs) -> Iterator[str]:
    """Yield the lines of a type as the hub reports it, without the types of its constants."""

    def members(type_: str) -> list[_DefinitionMember]:
        constants = typedefs.constants(type_).items()
        return [_DefinitionMember(f"{name}={value}") for name, value in constants] + [
            _DefinitionMember(
                f"{each.written_type} {each.name}",
                each.type if each.type in typedefs and each.type not in TIMES else None,
            )
            for each in typedefs.fields(type_)
        ]

    return _lines(members(typedefs.root), members)


class _DefinitionMember(NamedTuple):
    """A line of a definition: a constant or a field."""

    line: str
    nested: str | None = None
    """The field's type, if it is a message."""


_MembersOf: TypeAlias = Callable[[str], list[_DefinitionMember]]
"""Returns the members of a message type: constants first, then fields."""


def _members(definition: MessageDefinition) -> list[_DefinitionMember]:
    constants = [
        _DefinitionMember(f"{each.type} {each.name}={each.text}") for each in definition.constants
    ]
    fields = [
        _DefinitionMember(f"{each.full_type} {each.name}", each.type if each.is_nested else None)
        for each in definition.fields
    ]
    return constants + fields


def _lines(
    members: list[_DefinitionMember], members_of: _MembersOf, indent: str = ""
) -> Iterator[str]:
    """Yield the lines of members, each followed by those of its nested type, indented."""
    for line, nested in members:
        yield indent + line
        if nested is not None:
            yield from _lines(members_of(nested), members_of, f"{indent}  ")
