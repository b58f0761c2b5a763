"""The definitions that clients bring, kept while they are used, and limits for them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from hashlib import sha256
from itertools import islice
from typing import NamedTuple, TypeAlias

from fibws.errors import (
    DefinitionError,
    DefinitionLimit,
    InterfaceError,
    UnknownPackage,
    UnknownType,
)
from fibws.interfaces import full_text
from fibws.interfaces.catalogue import Definitions, Interfaces
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.folders import KINDS, Kind
from fibws.interfaces.md5sum import message_md5
from fibws.interfaces.resolver import Resolver

LONGEST_TEXT = 2**18
"""How many characters one definition from a client may have."""
MOST_VALUES = 2**16
"""How many values a message of such a type may have when its fixed arrays are full and the others
empty: a short definition can declare millions, which are the defaults in every message."""
MOST_HOLDERS = 3
"""How many users of a definition are named in an error."""

Key: TypeAlias = tuple[Kind, str]
"""A type: its kind and its name, ``package/Name``."""
Shows: TypeAlias = Callable[[str, Kind, str], bool]
"""Takes a client, and the kind and the name of a type that some client brought."""


def show_all(client: str, kind: Kind, name: str) -> bool:
    """Return True: every client may learn every type."""
    return True


class Limits(NamedTuple):
    """Limits for the definitions that are kept.

    ``types`` is their number. ``characters`` are those of all texts. ``fields`` counts fields and
    constants, those of nested messages each time: the checks of each take up to two kilobytes.
    """

    types: int
    characters: int
    fields: int


PER_CLIENT = Limits(types=1000, characters=2**22, fields=80_000)
"""The limits for one client, which must not use up the room of others."""
OF_ALL = Limits(types=4000, characters=2**24, fields=320_000)
"""The limits for all clients together, which must not fill the memory."""


class ClientDefinition(Definitions):
    """A type that a client brought, with all that is needed to use it.

    Types nested in it are its own, as far as no folder has them: it can be used as long as
    someone holds it, even if others add or remove definitions.

    Args:
        base: the types in folders.
        key: the type.
        text: as the client sent it.
        client: the node that brought it.
        messages: the messages that no folder has, by name: itself, or those nested in it.
        service: itself, if it is a service.
        action: itself, if it is an action.
    """

    def __init__(
        self,
        base: Interfaces,
        key: Key,
        text: str,
        client: str,
        messages: Mapping[str, MessageDefinition],
        service: ServiceDefinition | None,
        action: ActionDefinition | None,
    ) -> None:
        super().__init__()
        self.key = key
        self.text = text
        self.client = client
        self.messages = messages
        self._base = base
        self._service = service
        self._action = action
        self.fields = dict(self._count_fields())
        """How many fields and constants each of its types counts for."""

    def _find_message(self, name: str) -> MessageDefinition:
        return self.messages.get(name) or self._base.message(name)

    def _find_service(self, name: str) -> ServiceDefinition:
        return self._service if self._service and self.key[1] == name else self._base.service(name)

    def _find_action(self, name: str) -> ActionDefinition:
        return self._action if self._action and self.key[1] == name else self._base.action(name)

    def _count_fields(self) -> Iterator[tuple[Key, int]]:
        parts: tuple[MessageDefinition, ...] = ()
        if self._service is not None:
            parts = (self._service.request, self._service.response)
        elif self._action is not None:
            parts = (self._action.goal, self._action.result, self._action.feedback)
        if parts:
            yield self.key, sum(map(self._fields_of, parts))
        for name, message in self.messages.items():
            yield ("msg", name), self._fields_of(message)

    def _fields_of(self, definition: MessageDefinition) -> int:
        size = self.size(definition)
        if size.values > MOST_VALUES:
            raise InterfaceError(
                f"{definition.type} has {size.values} values when its fixed arrays are full, "
                f"the limit for definitions from clients is {MOST_VALUES}"
            )
        return size.fields + len(definition.constants)


class Usage:
    """The size of definitions, of one client or of all."""

    def __init__(self) -> None:
        self._types: dict[Key, list[int]] = {}
        """How many definitions have each type, and its fields."""
        self._characters = 0
        self._fields = 0

    def __bool__(self) -> bool:
        return bool(self._types)

    def check_room(self, added: ClientDefinition, limits: Limits, whose: str) -> None:
        """Raise `DefinitionLimit` if one more definition would exceed the limits.

        Args:
            whose: whose definitions these are, for the text.
        """
        new = [fields for key, fields in added.fields.items() if key not in self._types]
        for what, count, limit in (
            ("definitions", len(self._types) + len(new), limits.types),
            ("characters in definitions", self._characters + len(added.text), limits.characters),
            ("fields and constants in definitions", self._fields + sum(new), limits.fields),
        ):
            if count > limit:
                raise DefinitionLimit(
                    f"too many {what} from {whose} to add {added.key[1]} (limit is {limit})"
                )

    def add(self, added: ClientDefinition) -> None:
        """Count a definition."""
        self._characters += len(added.text)
        for key, fields in added.fields.items():
            counted = self._types.setdefault(key, [0, fields])
            if not counted[0]:
                self._fields += fields
            counted[0] += 1

    def remove(self, removed: ClientDefinition) -> None:
        """Count a definition no longer."""
        self._characters -= len(removed.text)
        for key in removed.fields:
            counted = self._types[key]
            counted[0] -= 1
            if not counted[0]:
                self._fields -= counted[1]
                del self._types[key]


class _Refusal(NamedTuple):
    """Why a definition was refused.

    ``revision`` is that of the definitions which were kept then; None for a fault of the text.
    """

    error: InterfaceError
    revision: int | None


class Refusals:
    """The definitions that one client brought and that were refused: none is read twice.

    To read one takes as long as to read one that is kept, and so they have the same limits.
    """

    def __init__(self) -> None:
        self._refusals: dict[bytes, _Refusal] = {}
        """By the digest of the definition."""
        self._characters = 0

    def __len__(self) -> int:
        return len(self._refusals)

    def check(self, digest: bytes, revision: int) -> None:
        """Raise the error with which a definition was refused, if nothing has changed since."""
        found = self._refusals.get(digest)
        if found is not None and found.revision in (None, revision):
            raise _copied(found.error)

    def check_room(self, digest: bytes, name: str, text: str, limits: Limits, whose: str) -> None:
        """Raise `DefinitionLimit` if so many were refused that no others are read."""
        if digest in self._refusals:
            return
        for what, count, limit in (
            ("definitions", len(self._refusals) + 1, limits.types),
            ("characters in definitions", self._characters + len(text), limits.characters),
        ):
            if count > limit:
                raise DefinitionLimit(
                    f"too many {what} from {whose} were refused to read {name} (limit is {limit})"
                )

    def add(self, digest: bytes, text: str, error: InterfaceError, revision: int | None) -> None:
        """Remember a refused definition."""
        if digest not in self._refusals:
            self._characters += len(text)
        self._refusals[digest] = _Refusal(_copied(error), revision)

    def remove(self, digest: bytes, text: str) -> None:
        """Forget a definition that was refused and fits now, if it was."""
        if self._refusals.pop(digest, None) is not None:
            self._characters -= len(text)


def _copied(error: InterfaceError) -> InterfaceError:
    """Return an error without its traceback, which would keep all that was read of a text."""
    copied = type(error).__new__(type(error), *error.args)
    copied.args = error.args
    vars(copied).update(vars(error))
    return copied


class ClientDefinitions:
    """The definitions that clients brought, each kept while someone holds it.

    A type has one definition at a time: that of the folders, or the one that is held.

    Args:
        base: the types in folders.
        shows: returns whether a client may learn a type that clients brought.
    """

    def __init__(self, base: Interfaces, shows: Shows = show_all) -> None:
        self._base = base
        self._shows = shows
        self._by_type: dict[Key, list[ClientDefinition]] = {}
        self._holders: dict[ClientDefinition, dict[Hashable, Callable[[], str]]] = {}
        self._usage: dict[str, Usage] = {}
        """By client."""
        self._usage_of_all = Usage()
        self._refusals: dict[str, Refusals] = {}
        """By client."""
        self._revision = 0
        """Changes with the definitions that are kept."""
        self._watchers: list[Callable[[str], None]] = []

    @property
    def base(self) -> Interfaces:
        """The types in folders."""
        return self._base

    def find(self, kind: Kind, name: str) -> ClientDefinition | None:
        """Return the definition that has a type, ``package/Name``, if clients brought it."""
        found = self._by_type.get((kind, name))
        return found[0] if found else None

    def find_for(self, client: str, kind: Kind, name: str) -> ClientDefinition | None:
        """Return the same for a client, for which types that are hidden from it do not exist."""
        found = self.find(kind, name)
        return found if found is not None and self._shows(client, kind, name) else None

    def all_types(self, client: str) -> list[str]:
        """Return all types that a client may learn, as ROS 2 names them: ``package/msg/Name``."""
        found = {
            (kind, name)
            for kind in KINDS
            for package in self._base.packages()
            for name in self._base.types(package, kind)
        }
        found.update(key for key in self._by_type if self._shows(client, *key))
        return sorted(name.replace("/", f"/{kind}/") for kind, name in found)

    def holding(self, kind: Kind, name: str) -> Iterator[Hashable]:
        """Yield the holders of the definitions that have a type."""
        for definition in self._by_type.get((kind, name), ()):
            yield from self._holders[definition]

    def known_to(self, client: str, kind: Kind, name: str) -> Definitions:
        """Return where a client's type is looked up; as `known`."""
        return self.find_for(client, kind, Interfaces.canonical(name)) or self._base

    def known(self, kind: Kind, name: str) -> Definitions:
        """Return where a type is looked up: in a client's definition, or in the folders.

        Raises:
            InvalidTypeName: the name is invalid.
        """
        return self.find(kind, Interfaces.canonical(name)) or self._base

    def message(self, name: str) -> MessageDefinition:
        """The message of that name; raises as `Interfaces.message` does."""
        return self.known("msg", name).message(name)

    def service(self, name: str) -> ServiceDefinition:
        """The service of that name; raises as `Interfaces.message` does."""
        return self.known("srv", name).service(name)

    def action(self, name: str) -> ActionDefinition:
        """The action of that name; raises as `Interfaces.message` does."""
        return self.known("action", name).action(name)

    def full_text(self, name: str) -> str:
        """The full text of a message; as `Interfaces.full_text`."""
        return self.known("msg", name).full_text(name)

    def watch(self, forgotten: Callable[[str], None]) -> None:
        """Have a function called with the name of each type that is forgotten."""
        self._watchers.append(forgotten)

    def read(self, kind: Kind, name: str, text: str, client: str) -> ClientDefinition | None:
        """Return the definition that a client sent, or None if the folders have the type.

        It is kept, and known to others, only once it is held. One that is refused is remembered
        until `forget_refusals`, or until too many are.

        Args:
            kind: msg, srv or action.
            name: ``package/Name``.
            text: its own text, with nested types that are not known here behind it as in
                `full_text`.
            client: the client's node.

        Raises:
            DefinitionError: the text is wrong, or a type is known here with other fields.
            DefinitionLimit: it would be one too many.
            InterfaceError: it is too large.
        """
        for known in self._by_type.get((kind, name), ()):
            if known.key == (kind, name) and known.text == text:
                return known
        if len(text) > LONGEST_TEXT:
            raise InterfaceError(
                f"The definition of {name} is too long (limit is {LONGEST_TEXT} characters)"
            )
        refusals = self._refusals.get(client, Refusals())
        digest = sha256(f"{kind} {name} {text}".encode("utf-8", "surrogatepass")).digest()
        refusals.check(digest, self._revision)
        refusals.check_room(digest, name, text, PER_CLIENT, client or "one client")
        revision = None
        try:
            parsed = _parse(kind, name, text)
            revision = self._revision
            found = self._compare(kind, name, text, client, parsed)
        except InterfaceError as error:
            if sum(map(len, self._refusals.values())) >= OF_ALL.types:
                self._refusals.clear()
            self._refusals.setdefault(client, refusals).add(digest, text, error, revision)
            raise
        refusals.remove(digest, text)
        return found

    def forget_refusals(self, client: str) -> None:
        """Take note that a client has left."""
        self._refusals.pop(client, None)

    def _compare(
        self, kind: Kind, name: str, text: str, client: str, parsed: _Parsed
    ) -> ClientDefinition | None:
        """Return a definition that does not contradict others, and for which there is room."""
        draft = _Draft(self, name, parsed, client)
        if draft.is_known:
            return self.find(kind, name)
        definition = ClientDefinition(
            self._base, (kind, name), text, client, draft.messages(), draft.service, draft.action
        )
        usage = self._usage.get(client, Usage())
        usage.check_room(definition, PER_CLIENT, client or "one client")
        self._usage_of_all.check_room(definition, OF_ALL, "all clients")
        return definition

    def hold(
        self, definition: ClientDefinition, holder: Hashable, describe: Callable[[], str]
    ) -> None:
        """Keep a definition until the holder releases it.

        Args:
            definition: as `read` or `find` gave it.
            holder: the user of the type.
            describe: returns the holder's name for errors.
        """
        if definition not in self._holders:
            self._revision += 1
            self._holders[definition] = {}
            self._usage.setdefault(definition.client, Usage()).add(definition)
            self._usage_of_all.add(definition)
            for key in definition.fields:
                self._by_type.setdefault(key, []).append(definition)
        self._holders[definition][holder] = describe

    def release(self, definition: ClientDefinition, holder: Hashable) -> bool:
        """Let a holder use a definition no longer; return whether that was the last one.

        The types that no other definition has are forgotten then.
        """
        holders = self._holders.get(definition, {})
        if holders.pop(holder, None) is None or holders:
            return False
        del self._holders[definition]
        self._revision += 1
        usage = self._usage[definition.client]
        usage.remove(definition)
        if not usage:
            del self._usage[definition.client]
        self._usage_of_all.remove(definition)
        for key in definition.fields:
            others = self._by_type[key]
            others.remove(definition)
            if not others:
                del self._by_type[key]
                for forgotten in self._watchers:
                    forgotten(key[1])
        return True

    def holders(self, kind: Kind, name: str) -> str:
        """Return who uses a type, for errors; it is empty for a type of the folders."""
        holders = [
            describe
            for definition in self._by_type.get((kind, name), ())
            for describe in self._holders[definition].values()
        ]
        named = ", ".join(describe() for describe in islice(holders, MOST_HOLDERS))
        more = len(holders) - MOST_HOLDERS
        return f"{named} and {more} more" if more > 0 else named


class _Parsed(NamedTuple):
    """The types that a text defines: perhaps a service or an action, and messages."""

    service: ServiceDefinition | None
    action: ActionDefinition | None
    messages: dict[str, MessageDefinition]


def _parse(kind: Kind, name: str, text: str) -> _Parsed:
    """Return the types that a text defines; raise `DefinitionError` if it is wrong."""
    match kind:
        case "msg":
            return _Parsed(None, None, full_text.read_message(text, name))
        case "srv":
            service, nested = full_text.read_service(text, name)
            return _Parsed(service, None, nested)
        case "action":
            action, nested = full_text.read_action(text, name)
            return _Parsed(None, action, nested)


class _Draft:
    """The types that a text defines, compared to those that are known.

    Raises:
        DefinitionError: a type is known with other fields.
    """

    def __init__(self, known: ClientDefinitions, name: str, parsed: _Parsed, client: str) -> None:
        self.service, self.action, nested = parsed
        self.is_known = False
        """Whether the type is known with the same fields."""
        self._known = known
        self._client = client
        self._known_md5s: dict[str, str] = {}
        self._md5s: dict[str, str] = {}
        self._unknown: dict[str, MessageDefinition] = {}
        self._resolver = Resolver(self._find)
        if self.service is not None:
            self._compare_all(nested)
            self._compare_service(self.service)
        elif self.action is not None:
            # Parts come first, so that an error names a part and not a message with it.
            made = {message.type: message for message in reversed(self.action.messages())}
            self._compare_all(nested | made)
            self._compare_action(self.action)
        else:
            self._compare_all(nested)
            self.is_known = name not in self._unknown

    def messages(self) -> dict[str, MessageDefinition]:
        """Return the messages that no folder has: those of the text, and known ones in them."""
        found = dict(self._unknown)
        names = list(self._resolver.known)
        for name in names:  # It grows: a known type may have others in it than its draft.
            client = self._known.find("msg", name)
            if client is not None and name not in found:
                message = found[name] = client.messages[name]
                names.extend(field.type for field in message.fields if field.is_nested)
        return found

    def _find(self, name: str) -> MessageDefinition:
        draft = self._drafts.get(name)
        return draft or self._known.known_to(self._client, "msg", name).message(name)

    def _compare_all(self, drafts: dict[str, MessageDefinition]) -> None:
        self._drafts = drafts
        for draft in drafts.values():
            self._resolver.message(draft.type)
            try:
                known = self._known.message(draft.type)
            except (UnknownType, UnknownPackage):
                self._unknown[draft.type] = draft
            else:
                self._compare(draft, known, "msg", draft.type)

    def _compare_service(self, service: ServiceDefinition) -> None:
        parts = (service.request, service.response)
        for part in parts:
            self._resolver.check(part)
        try:
            known = self._known.service(service.type)
        except (UnknownType, UnknownPackage):
            return
        self.is_known = True
        for part, other in zip(parts, (known.request, known.response), strict=True):
            self._compare(part, other, "srv", service.type)

    def _compare_action(self, action: ActionDefinition) -> None:
        try:
            self._known.known("action", action.type).action(action.type)
        except (UnknownType, UnknownPackage):
            return
        self.is_known = True  # Its messages have been compared.

    def _compare(
        self, draft: MessageDefinition, known: MessageDefinition, kind: Kind, name: str
    ) -> None:
        """Check that both have the same fields; they are, or belong to, the type of that name."""
        md5 = message_md5(known, self._known.message, self._known_md5s)
        if message_md5(draft, self._resolver.message, self._md5s) == md5:
            return
        fault = f"{draft.type} is known here with other fields"
        if self._known.known_to(self._client, kind, name) is self._known.known(kind, name):
            fault = f"{fault} (md5 {md5})"
        holders = self._known.holders(kind, name)
        if holders:
            fault = f"{fault}, in use by {holders}"
        raise DefinitionError(draft.source, 1, draft.text[:200], fault)
