"""The definitions that clients bring, kept while they are used, and limits for them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from hashlib import sha256
from typing import NamedTuple, TypeAlias

from fibws.errors import DefinitionLimit, InterfaceError
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

Key: TypeAlias = tuple[Kind, str]
"""A type: its kind and its name, ``package/Name``."""
Shows: TypeAlias = Callable[[str, Hashable], bool]
"""Takes a client and a holder; returns whether the client may learn a definition that it holds."""


def show_all(client: str, holder: Hashable) -> bool:
    """Return True: every client may learn every type."""
    return True


class DefinitionLimits(NamedTuple):
    """Limits for the definitions that are kept.

    ``types`` is their number. ``characters`` are those of all texts. ``fields`` counts fields and
    constants, those of nested messages each time: the checks of each take up to two kilobytes.
    """

    types: int
    characters: int
    fields: int


PER_CLIENT = DefinitionLimits(types=1000, characters=2**22, fields=80_000)
"""The limits for one client, which must not use up the room of others."""
OF_ALL = DefinitionLimits(types=4000, characters=2**24, fields=320_000)
"""The limits for all clients together, which must not fill the memory."""


class ClientDefinition(Definitions):
    """A type that a client brought, with all that is needed to use it.

    Types nested in it are its own, as far as no folder has them with the same fields: it can be
    used as long as someone holds it, even if others add or remove definitions.

    Args:
        base: the types in folders.
        key: the type.
        text: as the client sent it.
        client: the node that brought it.
        messages: the messages that no folder has so, by name: itself, or those nested in it.
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
        self.md5s = {key: self.md5_of(*key) for key in self.fields}
        """The md5 of each of its types."""

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
        self._types: dict[tuple[Key, str], list[int]] = {}
        """How many definitions have each type, and its fields, by its key and md5."""
        self._characters = 0
        self._fields = 0

    def __bool__(self) -> bool:
        return bool(self._types)

    def check_room(self, added: ClientDefinition, limits: DefinitionLimits, whose: str) -> None:
        """Raise `DefinitionLimit` if one more definition would exceed the limits.

        Args:
            whose: whose definitions these are, for the text.
        """
        new = [
            fields
            for key, fields in added.fields.items()
            if (key, added.md5s[key]) not in self._types
        ]
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
            counted = self._types.setdefault((key, added.md5s[key]), [0, fields])
            if not counted[0]:
                self._fields += fields
            counted[0] += 1

    def remove(self, removed: ClientDefinition) -> None:
        """Count a definition no longer."""
        self._characters -= len(removed.text)
        for type_ in removed.md5s.items():
            counted = self._types[type_]
            counted[0] -= 1
            if not counted[0]:
                self._fields -= counted[1]
                del self._types[type_]


class _Refusal(NamedTuple):
    """Why a definition was refused.

    ``revision`` is that of the definitions which were kept then; None for a fault of the text.
    """

    error: InterfaceError
    revision: int | None


class RefusedDefinitions:
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

    def check_room(
        self, digest: bytes, name: str, text: str, limits: DefinitionLimits, whose: str
    ) -> None:
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

    Types of one name and other fields, whose md5s differ, are different types. A name alone stands
    for the type of the folders, or else for the first one that is held.

    Args:
        base: the types in folders.
        shows: returns whether a client may learn the definitions of a holder.
    """

    def __init__(self, base: Interfaces, shows: Shows = show_all) -> None:
        self._base = base
        self._shows = shows
        self._by_type: dict[Key, list[ClientDefinition]] = {}
        self._holders: dict[ClientDefinition, dict[Hashable, None]] = {}
        self._usage: dict[str, Usage] = {}
        """By client."""
        self._usage_of_all = Usage()
        self._refusals: dict[str, RefusedDefinitions] = {}
        """By client."""
        self._revision = 0
        """Changes with the definitions that are kept."""

    @property
    def base(self) -> Interfaces:
        """The types in folders."""
        return self._base

    def find(self, kind: Kind, name: str) -> ClientDefinition | None:
        """Return what a name, ``package/Name``, stands for, if clients brought the type."""
        found = self._by_type.get((kind, name))
        return found[0] if found and not self._base.has(kind, name) else None

    def find_for(
        self, client: str, kind: Kind, name: str, md5sum: str | None = None
    ) -> ClientDefinition | None:
        """Return what `find` does for one client; types that are hidden from it do not exist.

        Args:
            md5sum: that of the type, if it is to be this one alone.
        """
        key: Key = (kind, name)
        if key not in self._by_type or (md5sum is None and self._base.has(kind, name)):
            return None
        return next((each for each in self._shown(client, key, md5sum)), None)

    def _shown(self, client: str, key: Key, md5sum: str | None) -> Iterator[ClientDefinition]:
        """Yield the definitions that have a type, as far as a client may learn them."""
        for each in self._by_type[key]:
            if md5sum in (None, each.md5s[key]):
                if any(self._shows(client, holder) for holder in self._holders[each]):
                    yield each

    def all_types(self, client: str) -> list[str]:
        """Return all types that a client may learn, as ROS 2 names them: ``package/msg/Name``."""
        found = {
            (kind, name)
            for kind in KINDS
            for package in self._base.packages()
            for name in self._base.types(package, kind)
        }
        found.update(key for key in self._by_type if any(self._shown(client, key, None)))
        return sorted(name.replace("/", f"/{kind}/") for kind, name in found)

    def known_to(
        self, client: str, kind: Kind, name: str, md5sum: str | None = None
    ) -> Definitions:
        """Return where a client's type is looked up; as `known`, and `find_for`."""
        return self.find_for(client, kind, Interfaces.canonical(name), md5sum) or self._base

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

    def read(self, kind: Kind, name: str, text: str, client: str) -> ClientDefinition | None:
        """Return the definition that a client sent, or None if the folders have the same type.

        It is kept, and known to others, only once it is held. One that is refused is remembered
        until `forget_refusals`, or until too many are.

        Args:
            kind: msg, srv or action.
            name: ``package/Name``.
            text: its own text, with nested types that are not known here, or not with these
                fields, behind it as in `full_text`.
            client: the client's node.

        Raises:
            DefinitionError: the text is wrong.
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
        refusals = self._refusals.get(client, RefusedDefinitions())
        digest = sha256(f"{kind} {name} {text}".encode("utf-8", "surrogatepass")).digest()
        refusals.check(digest, self._revision)
        refusals.check_room(digest, name, text, PER_CLIENT, client or "one client")
        revision = None
        try:
            parsed = _parse(kind, name, text)
            revision = self._revision
            found = self._find_same(kind, name, text, client, parsed)
        except InterfaceError as error:
            if sum(map(len, self._refusals.values())) >= OF_ALL.types:
                self._refusals.clear()
            self._refusals.setdefault(client, refusals).add(digest, text, error, revision)
            raise
        refusals.remove(digest, text)
        return found

    def forget_refusals(self, client: str) -> None:
        """Called when a client has left."""
        self._refusals.pop(client, None)

    def _find_same(
        self, kind: Kind, name: str, text: str, client: str, parsed: _Parsed
    ) -> ClientDefinition | None:
        """Return a definition that has this md5, or a new one for which there is room."""
        key: Key = (kind, name)
        definition = ClientDefinition(
            self._base, key, text, client, self._messages(parsed, client), *parsed[:2]
        )
        md5sum = definition.md5_of(kind, name)
        if self._base.has(kind, name) and self._base.md5_of(kind, name) == md5sum:
            return None
        for known in self._by_type.get(key, ()):
            if known.md5s[key] == md5sum:
                return known
        usage = self._usage.get(client, Usage())
        usage.check_room(definition, PER_CLIENT, client or "one client")
        self._usage_of_all.check_room(definition, OF_ALL, "all clients")
        return definition

    def _messages(self, parsed: _Parsed, client: str) -> dict[str, MessageDefinition]:
        """Return the messages that belong to parsed definitions and that no folder has so."""
        service, action, drafts = parsed
        if action is not None:
            # Parts come first, so that an error names a part and not a message with it.
            drafts = drafts | {each.type: each for each in reversed(action.messages())}

        def find(name: str) -> MessageDefinition:
            return drafts.get(name) or self.known_to(client, "msg", name).message(name)

        resolver = Resolver(find)
        for draft in drafts.values():
            resolver.message(draft.type)
        for part in (service.request, service.response) if service is not None else ():
            resolver.check(part)
        md5s: dict[str, str] = {}
        return {
            name: message
            for name, message in resolver.known.items()
            if not self._base.has("msg", name)
            or self._base.md5(name) != message_md5(message, resolver.message, md5s)
        }

    def hold(self, definition: ClientDefinition, holder: Hashable) -> None:
        """Keep a definition until the holder, a user of the type, releases it.

        Args:
            definition: as `read` or `find` gave it.
        """
        if definition not in self._holders:
            self._revision += 1
            self._holders[definition] = {}
            self._usage.setdefault(definition.client, Usage()).add(definition)
            self._usage_of_all.add(definition)
            for key in definition.fields:
                self._by_type.setdefault(key, []).append(definition)
        self._holders[definition][holder] = None

    def release(self, definition: ClientDefinition, holder: Hashable) -> bool:
        """Let a holder use a definition no longer; return whether that was the last one.

        The types that no other definition has are forgotten then.
        """
        holders = self._holders.get(definition, {})
        if holder not in holders:
            return False
        del holders[holder]
        if holders:
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
        return True


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
