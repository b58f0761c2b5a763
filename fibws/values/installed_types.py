"""The types whose definitions are on this machine: the standard ones and the user's own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fibws.definition_folders import named_folders
from fibws.suggestions import nearest
from fibws.values import type_text

if TYPE_CHECKING:
    from fibws.interfaces import MessageDefinition
    from fibws.interfaces.folders import Kind


class Shown(NamedTuple):
    """A type's definition."""

    text: str
    """As it is written, comments and all."""
    lines: list[str]
    """With what is in it, as rosmsg show has it."""


class Installed:
    """The types of one kind: msg, srv or action.

    Args:
        folders: the user's, besides those of $FIBWS_INTERFACES.

    Raises:
        InterfaceError: there is no such folder.
    """

    def __init__(self, kind: Kind, folders: Sequence[Path] = ()) -> None:
        from fibws.interfaces import Interfaces  # 0.1 s

        self._interfaces = Interfaces([*map(Path, named_folders()), *folders])
        self._kind = kind

    def packages(self) -> list[str]:
        """The packages that have such types, sorted."""
        return [name for name in self._interfaces.packages() if self.names(name)]

    def names(self, package: str) -> list[str]:
        """A package's types as ``package/Type``, sorted; it raises `UnknownPackage`."""
        return self._interfaces.types(package, self._kind)

    def all(self) -> Iterator[str]:
        """All types, sorted."""
        for package in self._interfaces.packages():
            yield from self.names(package)

    def find(self, short: str) -> list[str]:
        """The types that are called so in whichever package."""
        return [name for name in self.all() if name.partition("/")[2] == short]

    def nearest(self, name: str) -> str | None:
        """The type that is called almost so, in its package or in any other one."""
        known = list(self.all())
        if found := nearest(name, known):
            return found
        shorts = {each.partition("/")[2]: each for each in reversed(known)}
        short = nearest(name.rpartition("/")[2], shorts)
        return shorts[short] if short else None

    def show(self, name: str) -> Shown:
        """The definition of a type; it raises as `Interfaces.message`."""
        parts = self._parts(name)
        lines: list[str] = []
        for part in parts:
            if part is not parts[0]:
                lines.append("---")
            lines += type_text.lines(type_text.of_definition(part), self._members)
        return Shown("\n---\n".join(part.text for part in parts), lines)

    def md5(self, name: str) -> str:
        """The md5 of a message or a service, as ROS 1 computes it; raises as `show`."""
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

    def _members(self, type_: str) -> list[type_text.Member]:
        return type_text.of_definition(self._interfaces.message(type_))
