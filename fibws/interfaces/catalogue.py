"""Which types there are: the standard ones, those of the user's folders, those clients brought."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from pathlib import Path

from fibws.errors import InterfaceError, InvalidTypeName, UnknownPackage, UnknownType
from fibws.interfaces import fingerprint, full_text, parser
from fibws.interfaces.definition import (
    ACTION_SUFFIXES,
    ActionDefinition,
    MessageDefinition,
    ServiceDefinition,
)
from fibws.interfaces.learned import Learned
from fibws.interfaces.linker import MOST_VALUES, Linker
from fibws.interfaces.package import Kind, Package, find_packages

STANDARD = Path(__file__).parent / "definitions"
"""The folder of the standard packages."""

_TYPE_NAME = re.compile(r"([A-Za-z]\w{0,99})(?:/(?:msg|srv|action))?/([A-Za-z]\w{0,99})", re.ASCII)


class Interfaces:
    """All types by name, each read when first asked for.

    Args:
        folders: the user's own; each holds packages side by side, or is one. Of two packages of
            one name the later one counts, and each of them before the standard one.

    Raises:
        InterfaceError: there is no such folder.
    """

    def __init__(self, folders: Iterable[Path] = ()) -> None:
        self._folders = [STANDARD]
        self._learned = Learned(self)
        self._forget()
        for folder in folders:
            self.add_folder(folder)

    def add_folder(self, folder: Path) -> None:
        """Know the types of one more folder; nothing happens if it is known.

        Raises:
            InterfaceError: there is no such folder.
        """
        if folder in self._folders:
            return
        if not folder.is_dir():
            raise InterfaceError(f"There is no folder {folder} of definitions")
        self._folders.append(folder)
        self._forget()

    def _forget(self) -> None:
        self._packages: dict[str, Package] = {}
        self._linker = Linker(self._read)
        self._services: dict[str, ServiceDefinition] = {}
        self._actions: dict[str, ActionDefinition] = {}
        self._md5s: dict[str, str] = {}

    @staticmethod
    def canonical(name: str) -> str:
        """``package/Type`` for it and for ROS 2's ``package/msg/Type``, /srv/ and /action/ too.

        Raises:
            InvalidTypeName: the name has another form.
        """
        found = _TYPE_NAME.fullmatch(name)
        if found is None:
            raise InvalidTypeName(name if len(name) <= 200 else f"{name[:200]}...")
        return f"{found[1]}/{found[2]}"

    def message(self, name: str) -> MessageDefinition:
        """The message of that name, whose nested types are sure to exist.

        Raises:
            InvalidTypeName, UnknownPackage, UnknownType: there is none.
            DefinitionError: its definition, or that of a nested type, is wrong.
        """
        return self._linker.known.get(name) or self._linker.message(self.canonical(name))

    def most_elements(self, name: str) -> int:
        """How many messages of a type one array may hold; it raises as `message` does."""
        return MOST_VALUES // self._linker.size(self.message(name).type).values

    def service(self, name: str) -> ServiceDefinition:
        """The service of that name; it raises as `message` does."""
        name = self.canonical(name)
        if name not in self._services:
            service = self._learned.services.get(name)
            service = service or parser.parse_service(*self._file(name, "srv"))
            self._linker.check(service.request)
            self._linker.check(service.response)
            self._services[name] = service
        return self._services[name]

    def action(self, name: str) -> ActionDefinition:
        """The action of that name; it raises as `message` does."""
        action = self._read_action(self.canonical(name))
        for message in action.messages():
            self.message(message.type)
        return action

    def packages(self) -> list[str]:
        """The names of all packages, sorted."""
        return sorted({*self._all_packages(), *self._learned.packages()})

    def is_users(self, package: str) -> bool:
        """Whether the package is in one of the user's folders, not among the standard ones."""
        if len(self._folders) == 1:
            return False  # without a look at the folder of the standard ones
        found = self._all_packages().get(package)
        return found is not None and found.folder.parent != STANDARD

    def messages(self, package: str) -> list[str]:
        """The package's messages as ``package/Name``, sorted, with those made from its actions.

        Raises:
            UnknownPackage: there is none of that name.
        """
        return self.types(package, "msg")

    def services(self, package: str) -> list[str]:
        """The package's services as ``package/Name``, sorted; it raises as `messages` does."""
        return self.types(package, "srv")

    def actions(self, package: str) -> list[str]:
        """The package's actions as ``package/Name``, sorted; it raises as `messages` does."""
        return self.types(package, "action")

    def types(self, package: str, kind: Kind) -> list[str]:
        """The package's types of one kind as ``package/Name``, sorted; it raises as `messages`."""
        if package not in self._all_packages() and package not in self.packages():
            raise UnknownPackage(package)
        learned = {name for name in self._learned.names(kind) if name.startswith(f"{package}/")}
        return sorted(learned.union(self._in_files(package, kind)))

    def md5(self, name: str) -> str:
        """The md5 of a message, as ROS 1 computes it; it raises as `message` does."""
        definition, md5s = self.message(name), self._md5s
        if definition.type not in md5s:
            md5s[definition.type] = fingerprint.message_md5(definition, self.message, md5s)
        return md5s[definition.type]

    def service_md5(self, name: str) -> str:
        """The md5 of a service, as ROS 1 computes it; it raises as `message` does."""
        return fingerprint.service_md5(self.service(name), self.message, self._md5s)

    def full_text(self, name: str) -> str:
        """The text of a message and of all types in it, as genmsg writes it for other programs."""
        return full_text.write_message(self.message(name), self.message)

    def service_text(self, name: str) -> str:
        """The text of a service and of all types in it, as `learn_service` takes it."""
        return full_text.write_service(self.service(name), self.message)

    def action_text(self, name: str) -> str:
        """The text of an action and of all types in it, as `learn_action` takes it."""
        return full_text.write_action(self.action(name), self.message)

    def learn(self, name: str, text: str) -> MessageDefinition:
        """Take over a definition that a client brings, and its dependencies: all or nothing.

        Args:
            name: the type's.
            text: its own text, with nested types that are not known here behind it as in
                `full_text`.

        Raises:
            InvalidTypeName: the name is none.
            DefinitionError: a text is wrong, or a type is already defined otherwise.
            InterfaceError: there is no room for more.
        """
        self._learned.learn_message(self.canonical(name), text)
        return self.message(name)

    def learn_service(self, name: str, text: str) -> ServiceDefinition:
        """Take over a service that a client brings; it does as `learn`."""
        self._learned.learn_service(self.canonical(name), text)
        return self.service(name)

    def learn_action(self, name: str, text: str) -> ActionDefinition:
        """Take over an action that a client brings, with its messages; it does as `learn`."""
        self._learned.learn_action(self.canonical(name), text)
        return self.action(name)

    def _read(self, name: str) -> MessageDefinition:
        """The definition of a message, whose nested types may not exist."""
        if name in self._learned.messages:
            return self._learned.messages[name]
        package, _, short = name.partition("/")
        for suffix in ACTION_SUFFIXES:
            base = short.removesuffix(suffix)
            if base != short and base in self._names(package, "action"):
                messages = self._read_action(f"{package}/{base}").messages()
                return next(message for message in messages if message.type == name)
        return parser.parse_message(*self._file(name, "msg"))

    def _read_action(self, name: str) -> ActionDefinition:
        if name not in self._actions:
            action = self._learned.actions.get(name)
            self._actions[name] = action or parser.parse_action(*self._file(name, "action"))
        return self._actions[name]

    def _file(self, name: str, kind: Kind) -> tuple[str, str, str, str]:
        """The text that defines a type, its package, its own name and the file's name."""
        package, _, short = name.partition("/")
        if package not in self._all_packages():
            # Some of its types may have been brought by a client, which says nothing of the others.
            raise UnknownPackage(package)
        path = self._names(package, kind).get(short)
        if path is None:
            raise UnknownType(kind, package, short, self._nearest(name, kind))
        # Windows' editors begin a file with a mark; a comment in Latin-1 does no harm.
        return path.read_text("utf-8-sig", errors="replace"), package, short, str(path)

    def _nearest(self, name: str, kind: Kind) -> str | None:
        package, _, short = name.partition("/")
        # Not among the types that clients brought: there may be hundreds, to be compared each time.
        files = self._in_files(package, kind)
        by_lower = {other.partition("/")[2].lower(): other for other in files}
        nearest = get_close_matches(short.lower(), by_lower, 1)
        return by_lower[nearest[0]] if nearest else None

    def _in_files(self, package: str, kind: Kind) -> Iterator[str]:
        """The types of one kind as ``package/Name`` that the package's files define."""
        yield from (f"{package}/{name}" for name in self._names(package, kind))
        if kind == "msg":
            for name in self._names(package, "action"):
                yield from (f"{package}/{name}{suffix}" for suffix in ACTION_SUFFIXES)

    def _names(self, package: str, kind: Kind) -> dict[str, Path]:
        """The files of one kind in a package by the name of what they define."""
        found = self._all_packages().get(package)
        return found.files(kind) if found else {}

    def _all_packages(self) -> dict[str, Package]:
        if not self._packages:
            # All at once: in rospy's programs several threads ask.
            self._packages = {
                found.name: found for folder in self._folders for found in find_packages(folder)
            }
        return self._packages
