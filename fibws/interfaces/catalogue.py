"""Types by name: standard types and those in the user's folders."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterable
from pathlib import Path

from fibws.errors import InterfaceError, InvalidTypeName, UnknownPackage, UnknownType
from fibws.interfaces import builtin, full_text, md5sum
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.folders import STANDARD as STANDARD
from fibws.interfaces.folders import Folders, Kind, standard_folders
from fibws.interfaces.resolver import Resolver, Size

_TYPE_NAME = re.compile(r"([A-Za-z]\w{0,99})(?:/(?:msg|srv|action))?/([A-Za-z]\w{0,99})", re.ASCII)


class Definitions(ABC):
    """Definitions by the names of their types, each checked on first use."""

    def __init__(self) -> None:
        self._clear()

    def _clear(self) -> None:
        self._resolver = Resolver(self._find_message)
        self._services: dict[str, ServiceDefinition] = {}
        self._md5s: dict[str, str] = {}

    @staticmethod
    def canonical(name: str) -> str:
        """Return ``package/Type``, also for ROS 2's ``package/msg/Type``, /srv/ and /action/.

        Raises:
            InvalidTypeName: the name has another form.
        """
        found = _TYPE_NAME.fullmatch(name)
        if found is None:
            raise InvalidTypeName(name if len(name) <= 200 else f"{name[:200]}...")
        return f"{found[1]}/{found[2]}"

    def message(self, name: str) -> MessageDefinition:
        """The message of that name; all nested types exist.

        Raises:
            InvalidTypeName, UnknownPackage, UnknownType: there is no such message.
            DefinitionError: its definition, or that of a nested type, is wrong.
        """
        return self._resolver.known.get(name) or self._resolver.message(self.canonical(name))

    def default_values(self, name: str) -> int:
        """How many values a message of only defaults has, at least 1; raises as `message` does."""
        return max(1, self._resolver.size(self.message(name).type).values)

    def size(self, definition: MessageDefinition) -> Size:
        """How large a message is; it may be a service's request. Raises as `message` does."""
        return self._resolver.check(definition)

    def has_floats(self, definition: MessageDefinition) -> bool:
        """Whether messages may hold floats; as `size`."""
        return self.size(definition).has_floats

    def has_sequenced_header(self, definition: MessageDefinition) -> bool:
        """Whether rospy numbers these messages: they begin with a header that begins with ``seq``.

        A Header of ROS 2 has no ``seq``. Raises as `message` does.
        """
        return definition.has_header and [
            (field.name, field.full_type) for field in self.message(builtin.HEADER).fields[:1]
        ] == [("seq", "uint32")]

    def service(self, name: str) -> ServiceDefinition:
        """The service of that name; raises as `message` does."""
        name = self.canonical(name)
        if name not in self._services:
            service = self._find_service(name)
            self._resolver.check(service.request)
            self._resolver.check(service.response)
            self._services[name] = service
        return self._services[name]

    def action(self, name: str) -> ActionDefinition:
        """The action of that name; raises as `message` does."""
        action = self._find_action(self.canonical(name))
        for message in action.messages():
            self.message(message.type)
        return action

    def md5(self, name: str) -> str:
        """The md5 of a message, as ROS 1 computes it; raises as `message` does."""
        definition, md5s = self.message(name), self._md5s
        if definition.type not in md5s:
            md5s[definition.type] = md5sum.message_md5(definition, self.message, md5s)
        return md5s[definition.type]

    def service_md5(self, name: str) -> str:
        """The md5 of a service, as ROS 1 computes it; raises as `message` does."""
        return md5sum.service_md5(self.service(name), self.message, self._md5s)

    def md5_of(self, kind: Kind, name: str) -> str:
        """The md5 that stands for a type; of an action, those of goal, feedback and result."""
        if kind == "msg":
            return self.md5(name)
        if kind == "srv":
            return self.service_md5(name)
        action = self.action(name)
        return ",".join(
            self.md5(each.type) for each in (action.goal, action.feedback, action.result)
        )

    def full_text(self, name: str) -> str:
        """The text of a message and of all types in it, as genmsg writes it for other programs."""
        return full_text.write_message(self.message(name), self.message)

    def service_text(self, name: str) -> str:
        """The text of a service and of all types in it, as clients send it."""
        return full_text.write_service(self.service(name), self.message)

    def action_text(self, name: str) -> str:
        """The text of an action and of all types in it, as clients send it."""
        return full_text.write_action(self.action(name), self.message)

    @abstractmethod
    def _find_message(self, name: str) -> MessageDefinition:
        """The definition of a message; types nested in it may be unknown."""

    @abstractmethod
    def _find_service(self, name: str) -> ServiceDefinition:
        """The definition of a service, as `_find_message`."""

    @abstractmethod
    def _find_action(self, name: str) -> ActionDefinition:
        """The definition of an action, as `_find_message`."""


class Interfaces(Definitions):
    """The types of the standard packages and of the user's, each read on first use.

    Args:
        folders: the user's own; each holds packages side by side, or is one. Of two packages of
            one name the later one counts; its types hide those of the standard one.

    Raises:
        InterfaceError: there is no such folder.
    """

    def __init__(self, folders: Iterable[Path] = ()) -> None:
        self._folders = standard_folders()
        super().__init__()
        for folder in folders:
            self.add_folder(folder)

    def add_folder(self, folder: Path) -> None:
        """Add the types of one more folder, unless it is known.

        Raises:
            InterfaceError: there is no such folder.
        """
        if self._folders is standard_folders():
            self._folders = Folders()
        if self._folders.add(folder):
            self._clear()

    @property
    def is_standard(self) -> bool:
        """Whether there are no folders of the user."""
        return self._folders.is_standard

    def packages(self) -> list[str]:
        """The names of all packages, sorted."""
        return sorted(self._folders.packages())

    def nearest(self, package: str) -> str | None:
        """The package with the most similar name, or None."""
        return self._folders.nearest(package)

    def is_users(self, package: str) -> bool:
        """Whether the package is in one of the user's folders."""
        return self._folders.is_users(package)

    def meant(self, kind: Kind, name: str) -> str | None:
        """The type that a name of an unknown package likely stands for, if there is one."""
        error = self._folders.unknown(kind, name)
        return error.meant if isinstance(error, UnknownPackage) else None

    def has(self, kind: Kind, name: str) -> bool:
        """Whether there is a type of this name, ``package/Type``, even with a wrong definition."""
        folders = self._folders
        finds = {
            "msg": folders.find_message,
            "srv": folders.find_service,
            "action": folders.find_action,
        }
        try:
            return finds[kind](name) is not None
        except InterfaceError:
            return True

    def messages(self, package: str) -> list[str]:
        """The package's messages as ``package/Name``, sorted, with those made from its actions.

        Raises:
            UnknownPackage: there is no such package.
        """
        return self.types(package, "msg")

    def services(self, package: str) -> list[str]:
        """The package's services as ``package/Name``, sorted; raises as `messages` does."""
        return self.types(package, "srv")

    def actions(self, package: str) -> list[str]:
        """The package's actions as ``package/Name``, sorted; raises as `messages` does."""
        return self.types(package, "action")

    def types(self, package: str, kind: Kind) -> list[str]:
        """The package's types of one kind, sorted; raises as `messages` does."""
        if package not in self._folders.packages():
            raise UnknownPackage(package, self._folders.nearest(package))
        return sorted(set(self._folders.names(kind, package)))

    def _find_message(self, name: str) -> MessageDefinition:
        found = self._folders.find_message(name)
        if found is None:
            raise self._folders.unknown("msg", name)
        return found

    def _find_service(self, name: str) -> ServiceDefinition:
        found = self._folders.find_service(name)
        if found is None:
            raise self._folders.unknown("srv", name)
        return found

    def _find_action(self, name: str) -> ActionDefinition:
        found = self._folders.find_action(name)
        if found is None:
            raise self._folders.unknown("action", name)
        return found


class TextDefinitions(Definitions):
    """The definitions in the full text of a message type, as connections and bags carry it.

    They are independent of those that are installed, whose types may have changed.

    Args:
        name: the type, ``package/Type``.
        text: its definition, followed by those of the types nested in it.

    Raises:
        InterfaceError: the name or the text is invalid.
    """

    def __init__(self, name: str, text: str) -> None:
        super().__init__()
        # The type was part of roslib once, and some bags still name it so.
        text = text.replace("roslib/Header", "std_msgs/Header")
        self.types = full_text.read_message(text, self.canonical(name))

    def _find_message(self, name: str) -> MessageDefinition:
        if name not in self.types:
            raise self._unknown("message", name)
        return self.types[name]

    def _find_service(self, name: str) -> ServiceDefinition:
        raise self._unknown("service", name)

    def _find_action(self, name: str) -> ActionDefinition:
        raise self._unknown("action", name)

    @staticmethod
    def _unknown(kind: str, name: str) -> UnknownType:
        package, _, short = name.partition("/")
        return UnknownType(kind, package, short, None)
