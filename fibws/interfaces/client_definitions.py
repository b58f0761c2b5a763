"""The definitions that clients send, and limits for them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol

from fibws.errors import DefinitionError, InterfaceError, UnknownPackage, UnknownType
from fibws.interfaces import full_text
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.fingerprint import message_md5
from fibws.interfaces.package import Kind
from fibws.interfaces.resolver import Resolver, Size

MOST = 1000
"""How many types clients may send, so that they cannot fill the memory."""
MOST_TEXT = 2**22
"""How many characters the texts of all of them may have together."""
MOST_FIELDS = 80_000
"""How many fields and constants all of them may have together, those of nested messages counted
each time: the checks of each field take up to two kilobytes."""
MOST_VALUES = 2**16
"""How many values a message of such a type may have when its fixed arrays are full and the others
empty: a short definition can declare millions, which are the defaults in every message."""
LONGEST_TEXT = 2**18
"""How many characters one definition from a client may have."""


class Known(Protocol):
    """The types that are known already; each method raises an error if there is no such type."""

    def message(self, name: str) -> MessageDefinition:
        """The message of that name."""

    def service(self, name: str) -> ServiceDefinition:
        """The service of that name."""

    def action(self, name: str) -> ActionDefinition:
        """The action of that name."""


class ClientDefinitions:
    """The definitions that clients sent.

    A type is added with all other types that its text defines, or nothing is added. Types that are
    known already must be the same in the text.
    """

    def __init__(self) -> None:
        self._messages: dict[str, MessageDefinition] = {}
        self._services: dict[str, ServiceDefinition] = {}
        self._actions: dict[str, ActionDefinition] = {}
        self._texts: dict[tuple[Kind, str], str] = {}
        self._text = 0
        self._fields = 0

    def find_message(self, name: str) -> MessageDefinition | None:
        """The message of that name, if a client sent it."""
        return self._messages.get(name)

    def find_service(self, name: str) -> ServiceDefinition | None:
        """The service of that name, if a client sent it."""
        return self._services.get(name)

    def find_action(self, name: str) -> ActionDefinition | None:
        """The action of that name, if a client sent it."""
        return self._actions.get(name)

    def names(self, kind: Kind, package: str) -> Iterator[str]:
        """The types of one kind in a package as ``package/Name``."""
        known: Iterable[str]
        match kind:
            case "msg":
                known = self._messages
            case "srv":
                known = self._services
            case "action":
                known = self._actions
        return (name for name in known if name.startswith(f"{package}/"))

    def packages(self) -> Iterator[str]:
        """The packages that the types belong to."""
        for names in (self._messages, self._services, self._actions):
            yield from (name.partition("/")[0] for name in names)

    def learn_message(self, name: str, text: str, known: Known) -> None:
        """Add a message.

        Args:
            name: ``package/Name``.
            text: its full text, which may leave out nested types that are known.
            known: the types that are known already, these among them.

        Raises:
            DefinitionError: a text is wrong, or a type is already defined differently.
            InterfaceError: a limit is exceeded.
        """
        if self._texts.get(("msg", name)) == text:
            return
        _check_length(name, text)
        drafts = _Drafts(known, full_text.read_message(text, name))
        self._make_room("msg", name, text, drafts)
        self._messages.update(drafts.unknown)

    def learn_service(self, name: str, text: str, known: Known) -> None:
        """Add a service; arguments and errors as with `learn_message`."""
        if self._texts.get(("srv", name)) == text:
            return
        _check_length(name, text)
        service, nested = full_text.read_service(text, name)
        drafts = _Drafts(known, nested)
        parts = (service.request, service.response)
        for part in parts:
            drafts.check(part)
        services = {}
        try:
            existing = known.service(name)
        except (UnknownType, UnknownPackage):
            services[name] = service
        else:
            drafts.compare(service.request, existing.request)
            drafts.compare(service.response, existing.response)
        self._make_room("srv", name, text, drafts, parts if services else ())
        self._messages.update(drafts.unknown)
        self._services.update(services)

    def learn_action(self, name: str, text: str, known: Known) -> None:
        """Add an action and its seven messages; as `learn_message`."""
        if self._texts.get(("action", name)) == text:
            return
        _check_length(name, text)
        action, nested = full_text.read_action(text, name)
        # Parts come first, so that an error names a part and not a message that contains it.
        made = {message.type: message for message in reversed(action.messages())}
        drafts = _Drafts(known, nested | made)
        actions = {}
        try:
            known.action(name)
        except (UnknownType, UnknownPackage):
            actions[name] = action
        parts = (action.goal, action.result, action.feedback)
        self._make_room("action", name, text, drafts, parts if actions else ())
        self._messages.update(drafts.unknown)
        self._actions.update(actions)

    def _make_room(
        self,
        kind: Kind,
        name: str,
        text: str,
        drafts: _Drafts,
        parts: tuple[MessageDefinition, ...] = (),
    ) -> None:
        """Count what a text defines; ``parts`` are those of a new service or action."""
        additions = len(drafts.unknown) + bool(parts)
        if not additions:
            return
        fields = 0
        for definition in (*drafts.unknown.values(), *parts):
            size = drafts.check(definition)
            fields += size.fields + len(definition.constants)
            if size.values > MOST_VALUES:
                raise InterfaceError(
                    f"{definition.type} has {size.values} values when its fixed arrays are full, "
                    f"the limit for definitions from clients is {MOST_VALUES}"
                )
        if len(self._messages) + len(self._services) + len(self._actions) + additions > MOST:
            raise InterfaceError(
                f"too many definitions from clients to add {name} (limit is {MOST})"
            )
        if self._text + len(text) > MOST_TEXT:
            raise InterfaceError(
                f"definitions from clients are too long to add {name} "
                f"(limit is {MOST_TEXT} characters in total)"
            )
        if self._fields + fields > MOST_FIELDS:
            raise InterfaceError(
                f"too many fields and constants in definitions from clients to add {name} "
                f"(limit is {MOST_FIELDS} in total, with those of nested messages)"
            )
        self._text += len(text)
        self._fields += fields
        self._texts[kind, name] = text


class _Drafts:
    """The messages that a text defines, compared to those that are known already."""

    def __init__(self, known: Known, drafts: dict[str, MessageDefinition]) -> None:
        self._known = known.message
        self._resolver = Resolver(lambda name: drafts.get(name) or known.message(name))
        self._known_md5s: dict[str, str] = {}
        self._md5s: dict[str, str] = {}
        self.unknown: dict[str, MessageDefinition] = {}
        for draft in drafts.values():
            self._resolver.message(draft.type)
            try:
                existing = known.message(draft.type)
            except (UnknownType, UnknownPackage):
                self.unknown[draft.type] = draft
            else:
                self.compare(draft, existing)

    def check(self, draft: MessageDefinition) -> Size:
        """Check that all nested types exist; return the size of the message."""
        return self._resolver.check(draft)

    def compare(self, draft: MessageDefinition, known: MessageDefinition) -> None:
        """Check that both have the same fields."""
        md5 = message_md5(known, self._known, self._known_md5s)
        if message_md5(draft, self._resolver.message, self._md5s) != md5:
            fault = f"{draft.type} is known here with other fields (md5 {md5})"
            raise DefinitionError(draft.source, 1, draft.text[:200], fault)


def _check_length(name: str, text: str) -> None:
    if len(text) > LONGEST_TEXT:
        raise InterfaceError(
            f"The definition of {name} is too long (limit is {LONGEST_TEXT} characters)"
        )
