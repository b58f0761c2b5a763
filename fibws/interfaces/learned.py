"""The types that clients bring: what is taken over, and how much of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from fibws.errors import DefinitionError, InterfaceError, UnknownPackage, UnknownType
from fibws.interfaces import full_text
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.fingerprint import message_md5
from fibws.interfaces.linker import Linker, Size
from fibws.interfaces.package import Kind

if TYPE_CHECKING:
    from fibws.interfaces.catalogue import Interfaces

MOST = 1000
"""How many types clients may bring, so that they cannot fill the memory."""
MOST_TEXT = 2**22
"""How many characters the texts of all of them may have together."""
MOST_FIELDS = 80_000
"""How many fields and constants all of them may have together, those of nested messages counted
each time: the checks of each field take up to two kilobytes."""
MOST_VALUES = 2**16
"""How many values a message of such a type may have when its fixed arrays are full and the others
empty: a few letters declare millions, which every message that leaves them out would have."""
LONGEST_TEXT = 2**18
"""How many characters a definition that a client brings may have."""


class Learned:
    """The types that are known from clients alone.

    A type is taken over with all else that its text defines, or nothing is. What is known already
    must be the same in the text.

    Args:
        interfaces: all types, these among them.
    """

    def __init__(self, interfaces: Interfaces) -> None:
        self._interfaces = interfaces
        self.messages: dict[str, MessageDefinition] = {}
        self.services: dict[str, ServiceDefinition] = {}
        self.actions: dict[str, ActionDefinition] = {}
        self._texts: dict[tuple[Kind, str], str] = {}
        self._text = 0
        self._fields = 0

    def names(self, kind: Kind) -> Iterable[str]:
        """The types of one kind as ``package/Name``."""
        match kind:
            case "msg":
                return self.messages
            case "srv":
                return self.services
            case "action":
                return self.actions

    def packages(self) -> Iterator[str]:
        """The packages that the types belong to."""
        for names in (self.messages, self.services, self.actions):
            yield from (name.partition("/")[0] for name in names)

    def learn_message(self, name: str, text: str) -> None:
        """Take over a message.

        Args:
            name: ``package/Name``.
            text: its full text, which may leave out nested types that are known.

        Raises:
            DefinitionError: a text is wrong, or a type is already defined otherwise.
            InterfaceError: there is no room for more.
        """
        if self._texts.get(("msg", name)) == text:
            return
        _check_length(name, text)
        trial = _Trial(self._interfaces, full_text.read_message(text, name))
        self._make_room("msg", name, text, trial)
        self.messages.update(trial.unknown)

    def learn_service(self, name: str, text: str) -> None:
        """Take over a service; arguments and errors are as with `learn_message`."""
        if self._texts.get(("srv", name)) == text:
            return
        _check_length(name, text)
        service, nested = full_text.read_service(text, name)
        trial = _Trial(self._interfaces, nested)
        parts = (service.request, service.response)
        for part in parts:
            trial.check(part)
        services = {}
        try:
            known = self._interfaces.service(name)
        except (UnknownType, UnknownPackage):
            services[name] = service
        else:
            trial.compare(service.request, known.request)
            trial.compare(service.response, known.response)
        self._make_room("srv", name, text, trial, parts if services else ())
        self.messages.update(trial.unknown)
        self.services.update(services)

    def learn_action(self, name: str, text: str) -> None:
        """Take over an action and its seven messages; it is as with `learn_message`."""
        if self._texts.get(("action", name)) == text:
            return
        _check_length(name, text)
        action, nested = full_text.read_action(text, name)
        # Backwards, so that what is at fault is the part and not what is made of it.
        made = {message.type: message for message in reversed(action.messages())}
        trial = _Trial(self._interfaces, nested | made)
        actions = {}
        try:
            self._interfaces.action(name)
        except (UnknownType, UnknownPackage):
            actions[name] = action
        parts = (action.goal, action.result, action.feedback)
        self._make_room("action", name, text, trial, parts if actions else ())
        self.messages.update(trial.unknown)
        self.actions.update(actions)

    def _make_room(
        self,
        kind: Kind,
        name: str,
        text: str,
        trial: _Trial,
        parts: tuple[MessageDefinition, ...] = (),
    ) -> None:
        """Count what a text defines; ``parts`` are those of a new service or action."""
        additions = len(trial.unknown) + bool(parts)
        if not additions:
            return
        fields = 0
        for definition in (*trial.unknown.values(), *parts):
            size = trial.check(definition)
            fields += size.fields + len(definition.constants)
            if size.values > MOST_VALUES:
                raise InterfaceError(
                    f"{definition.type} has {size.values} values when its fixed arrays are full, "
                    f"a type that a client brings may have {MOST_VALUES}"
                )
        if len(self.messages) + len(self.services) + len(self.actions) + additions > MOST:
            raise InterfaceError(f"Clients have brought {MOST} types, {name} is too many")
        if self._text + len(text) > MOST_TEXT:
            raise InterfaceError(
                f"The types that clients bring may have {MOST_TEXT} characters together, "
                f"{name} is too many"
            )
        if self._fields + fields > MOST_FIELDS:
            raise InterfaceError(
                f"The types that clients bring may have {MOST_FIELDS} fields and constants "
                f"together, those of nested messages counted each time, {name} is too many"
            )
        self._text += len(text)
        self._fields += fields
        self._texts[kind, name] = text


class _Trial:
    """The messages that a text defines, linked with those that are known and compared to them."""

    def __init__(self, interfaces: Interfaces, drafts: dict[str, MessageDefinition]) -> None:
        self._known = interfaces.message
        self._linker = Linker(lambda name: drafts.get(name) or interfaces.message(name))
        self._known_md5s: dict[str, str] = {}
        self._md5s: dict[str, str] = {}
        self.unknown: dict[str, MessageDefinition] = {}
        for draft in drafts.values():
            self._linker.message(draft.type)
            try:
                known = interfaces.message(draft.type)
            except (UnknownType, UnknownPackage):
                self.unknown[draft.type] = draft
            else:
                self.compare(draft, known)

    def check(self, draft: MessageDefinition) -> Size:
        """Make sure that all that a message holds is there, and tell how large it is."""
        return self._linker.check(draft)

    def compare(self, draft: MessageDefinition, known: MessageDefinition) -> None:
        """Make sure that both have the same fields."""
        md5 = message_md5(known, self._known, self._known_md5s)
        if message_md5(draft, self._linker.message, self._md5s) != md5:
            fault = f"{draft.type} is known here with other fields (md5 {md5})"
            raise DefinitionError(draft.source, 1, draft.text[:200], fault)


def _check_length(name: str, text: str) -> None:
    if len(text) > LONGEST_TEXT:
        raise InterfaceError(f"The definition of {name} has more than {LONGEST_TEXT} characters")
