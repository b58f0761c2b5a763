"""The types of topics, services and actions, which check and encode their messages.

A type of an unknown package is unchecked: its messages are relayed as they come.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NoReturn, Protocol, TypeAlias

import cbor2

from fibws.errors import (
    DefinitionLimit,
    InterfaceError,
    InvalidMessage,
    OperationError,
    UnknownPackage,
)
from fibws.hub.errors import DefinitionMismatch, UnknownDefinition
from fibws.interfaces import Interfaces, MessageDefinition, base64text
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.cbor import CborEncoders
from fibws.interfaces.client_definitions import (
    ClientDefinition,
    ClientDefinitions,
    Shows,
    show_all,
)
from fibws.interfaces.folders import Kind
from fibws.interfaces.long_integers import Convert, LongIntegers
from fibws.interfaces.serialization import FEWEST_BYTES, Serializer, Serializers
from fibws.interfaces.validators import Validate, Validators

_MD5 = re.compile(r"[0-9a-f]{32}")
_SCALARS = frozenset({str, int, float, bool, type(None)})

ANY_TYPE = "*"
"""The name of a type that is still to be learned, as in ROS 1's connection headers."""

Buffer: TypeAlias = bytes | bytearray | memoryview
"""Serialized bytes; they must not be changed."""


def read_values(
    serializer: Serializer,
    data: Buffer,
    errors: Literal["replace", "strict"] = "replace",
    *,
    is_checked: bool = False,
) -> dict[str, Any]:
    """Return the values of a request, a response or a goal that came from outside.

    Args:
        errors: what becomes of strings that are not UTF-8, as for ``bytes.decode``; with
            ``"strict"`` they are invalid.
        is_checked: whether the bytes are known to fit the type.

    Raises:
        InvalidMessage: the bytes do not fit the type.
        OperationError: their values would keep the hub busy for too long.
    """
    if not is_checked:
        serializer.check(data)
    if len(data) > FEWEST_BYTES and serializer.is_heavy(data, numbers=True):
        text = f"a message of {len(data)} bytes of type {serializer.type} has too many values"
        raise OperationError(f"{text} for JSON")
    try:
        return serializer.deserialize(data, errors)
    except UnicodeDecodeError:
        raise InvalidMessage(f"a string of {serializer.type} is not UTF-8") from None


class MessageType(Protocol):
    """The type of a topic's messages: a `CheckedType` or an `UncheckedType`."""

    name: str
    """``package/Type``."""
    checked: bool
    """Whether the fields are known, so that messages are checked."""
    fault: str
    """Why a definition that a client brought was not taken, if one did."""
    meant: str
    """The known type that is likely meant, if the package's name is misspelled."""
    claimed: str | None
    """The md5 that clients have given for a type without its definition, if it is another one than
    that of the known type of this name."""
    sequenced: bool
    """Whether publishers count their messages in ``header.seq``, as rospy's do."""
    validate: Validate

    @property
    def codecs(self) -> Codecs | None:
        """The codecs of its definition, if the fields are known."""

    @property
    def has_floats(self) -> bool:
        """Whether a message may hold NaN or infinity."""

    @property
    def md5sum(self) -> str | None:
        """The md5 of the definition, as ROS 1 computes it, if it is known."""

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """Return the fields that a valid message leaves to their defaults: ``pose.x``.

        At most 100 are listed; ``...`` stands for the rest.
        """

    def cbor(self, values: dict[str, Any]) -> bytes:
        """Return valid values as CBOR."""

    def cbor_of(self, data: Buffer) -> tuple[bytes, bool]:
        """Return checked bytes as CBOR, and whether a string in them was not UTF-8."""

    @property
    def long_integers(self) -> Convert | None:
        """The function that makes 64-bit integers strings; None without any, or if unknown."""

    def check_known(self) -> None:
        """Raise `UnknownDefinition` if the fields are unknown, so that nothing is serialized."""

    def check(self, data: Buffer) -> None:
        """Raise `InvalidMessage` unless bytes are a message in ROS 1's serialization."""

    def serialize(self, values: dict[str, Any]) -> Buffer:
        """Return valid values in ROS 1's serialization."""

    def deserialize(self, data: Buffer) -> tuple[dict[str, Any], bool]:
        """Return the values of checked bytes, and whether a string in them was not UTF-8.

        Bytes that are not UTF-8 become U+FFFD.
        """


class CheckedType:
    """A type whose fields are known.

    Args:
        name: ``package/Type``.
        codecs: where its encoders are compiled when they are first needed: most topics are only
            ever used by JSON clients.
    """

    checked = True
    fault = ""
    meant = ""
    claimed: str | None = None

    def __init__(self, name: str, codecs: Codecs) -> None:
        validator = codecs.validators.of(name)
        self.codecs = codecs
        self.name = validator.type
        self.validate: Validate = validator.validate
        self.missing = validator.missing
        self.sequenced = validator.has_sequenced_header

    @cached_property
    def md5sum(self) -> str | None:
        return self.codecs.definitions.md5(self.name)

    @cached_property
    def has_floats(self) -> bool:
        definitions = self.codecs.definitions
        return definitions.has_floats(definitions.message(self.name))

    @cached_property
    def check(self) -> Callable[[Buffer], None]:
        return self._serializer.check

    @cached_property
    def serialize(self) -> Callable[[dict[str, Any]], Buffer]:
        return self._serializer.serialize

    @cached_property
    def cbor(self) -> Callable[[dict[str, Any]], bytes]:
        return self.codecs.cbor.of(self.name).encode

    @cached_property
    def long_integers(self) -> Convert | None:
        return self.codecs.long_integers.of(self.name)

    @cached_property
    def _serializer(self) -> Serializer:
        return self.codecs.serializers.of(self.name)

    def cbor_of(self, data: Buffer) -> tuple[bytes, bool]:
        """Return checked bytes as CBOR, and whether a string in them was not UTF-8."""
        if len(data) > FEWEST_BYTES:
            self._check_weight(data, "CBOR", "cbor-raw", numbers=False)
        try:
            return self._serializer.to_cbor(data), False
        except UnicodeDecodeError:
            return self._serializer.to_cbor(data, "replace"), True

    def check_known(self) -> None:
        """Do nothing: the fields are known."""

    def deserialize(self, data: Buffer) -> tuple[dict[str, Any], bool]:
        """Return the values of checked bytes, and whether a string in them was not UTF-8."""
        if len(data) > FEWEST_BYTES:
            self._check_weight(data, "JSON", "cbor or cbor-raw", numbers=True)
        try:
            return self._serializer.deserialize(data), False
        except UnicodeDecodeError:
            return self._serializer.deserialize(data, "replace"), True

    def _check_weight(self, data: Buffer, form: str, better: str, *, numbers: bool) -> None:
        """Raise `OperationError` if the values would keep the hub busy for too long."""
        if self._serializer.is_heavy(data, numbers=numbers):
            raise OperationError(
                f"a message of {len(data)} bytes of type {self.name} has too many values for "
                f"{form}; subscribe with compression {better}"
            )


class UncheckedType:
    """A type whose fields are unknown: its messages are relayed as they come.

    Args:
        name: ``package/Type``.
        fault: why a definition that a client brought was not taken, if one did.
        meant: the known type that is likely meant, if the package's name is misspelled.
        claimed: the md5 by which clients know a type whose definition none of them has brought,
            beside another one of this name that is known.
    """

    checked = False
    codecs: Codecs | None = None
    sequenced = False
    has_floats = True
    long_integers: Convert | None = None
    md5sum: str | None = None

    def __init__(
        self, name: str, fault: str = "", meant: str = "", claimed: str | None = None
    ) -> None:
        self.name = name
        self.fault = fault
        self.meant = meant
        self.claimed = claimed
        self.validate: Validate = _relayed(name)

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """Return nothing: the fields are unknown."""
        return []

    def cbor(self, values: dict[str, Any]) -> bytes:
        """Return values as CBOR."""
        return cbor2.dumps(values)

    def check_known(self) -> NoReturn:
        """Raise `UnknownDefinition`."""
        raise UnknownDefinition(self.name, self.fault)

    def check(self, data: Buffer) -> NoReturn:
        """Raise `UnknownDefinition`."""
        self.check_known()

    def cbor_of(self, data: Buffer) -> NoReturn:
        """Raise `UnknownDefinition`."""
        self.check_known()

    def serialize(self, values: dict[str, Any]) -> NoReturn:
        """Raise `UnknownDefinition`."""
        self.check_known()

    def deserialize(self, data: Buffer) -> NoReturn:
        """Raise `UnknownDefinition`."""
        self.check_known()


@dataclass(frozen=True, slots=True, eq=False)
class ServiceType:
    """A service's type, which checks its requests and responses.

    ``arguments`` are the request's fields in order, ``md5sum`` stands for the definition, and
    ``codecs`` are those of the definition, if they are known. ``fault`` is the reason why a
    definition that the client brought was refused, and ``meant`` the known type that is likely
    meant, if the package's name is misspelled.
    """

    name: str
    request: Validate
    response: Validate
    arguments: tuple[str, ...] | None = None
    md5sum: str | None = None
    codecs: Codecs | None = None
    fault: str = ""
    meant: str = ""
    is_known: bool = True
    """Whether requests can be checked; else the server does it, once it has learned the type."""

    def serializer(self, message: int) -> Serializer:
        """Return the serializer of the request (0) or the response (1).

        Raises:
            UnknownDefinition: the fields are unknown.
        """
        if self.codecs is None:
            raise UnknownDefinition(self.name, self.fault)
        return self.codecs.service_serializers(self.name)[message]

    def fill_request(self, args: object) -> dict[str, Any]:
        """Return the request that ``args`` stand for: an object, or a list of fields in order.

        Anything else counts as no arguments, as with the real rosbridge server.

        Raises:
            InvalidMessage: a field does not fit the type.
        """
        return self.request(_by_name(args, self.arguments, self.name))


@dataclass(frozen=True, slots=True, eq=False)
class ActionType:
    """An action's type, which checks its goals, feedback and results.

    ``arguments`` are the goal's fields in order, and ``md5sums`` stand for the definitions of goal,
    feedback and result, if they are known. ``codecs``, ``fault`` and ``meant`` are as
    of `ServiceType`.
    """

    name: str
    goal: Validate
    feedback: Validate
    result: Validate
    arguments: tuple[str, ...] | None = None
    md5sums: tuple[str, str, str] | None = None
    codecs: Codecs | None = None
    fault: str = ""
    meant: str = ""

    @property
    def md5sum(self) -> str | None:
        """The md5s of goal, feedback and result, with commas between them."""
        return ",".join(self.md5sums) if self.md5sums is not None else None

    def serializer(self, message: int) -> Serializer:
        """Return the serializer of the goal (0), the feedback (1) or the result (2).

        Raises:
            UnknownDefinition: the fields are unknown.
        """
        if self.codecs is None:
            raise UnknownDefinition(self.name, self.fault)
        return self.codecs.action_serializers(self.name)[message]

    def fill_goal(self, args: object) -> dict[str, Any]:
        """Return the goal that ``args`` stand for; as `ServiceType.fill_request`."""
        return self.goal(_by_name(args, self.arguments, self.name))


AnyType: TypeAlias = MessageType | ServiceType | ActionType
"""The type of a topic, a service or an action."""


class Codecs:
    """The types of some definitions, with validators and encoders, each made on first use.

    Args:
        definitions: those of the folders, or one that a client brought.
        now: returns the nanoseconds since 1970, for messages that ask for the time.
    """

    def __init__(self, definitions: Definitions, now: Callable[[], int]) -> None:
        self.definitions = definitions
        self.validators = Validators(definitions, now, lenient=True)
        self.cbor = CborEncoders(definitions)
        self.serializers = Serializers(definitions)
        self.long_integers = LongIntegers(definitions)
        self._messages: dict[str, CheckedType] = {}
        self._services: dict[str, ServiceType] = {}
        self._service_serializers: dict[str, tuple[Serializer, Serializer]] = {}
        self._action_serializers: dict[str, tuple[Serializer, Serializer, Serializer]] = {}
        self._actions: dict[str, ActionType] = {}

    def message(self, name: str) -> CheckedType:
        """Return the type of a topic; raises `InterfaceError` if it is unknown."""
        if name not in self._messages:
            self._messages[name] = CheckedType(name, self)
        return self._messages[name]

    def service(self, name: str) -> ServiceType:
        """Return the type of a service; as `message`."""
        if name not in self._services:
            service = self.definitions.service(name)
            self._services[name] = ServiceType(
                name,
                self._validate(service.request),
                self._validate(service.response),
                _fields(service.request),
                self.definitions.service_md5(name),
                self,
            )
        return self._services[name]

    def service_serializers(self, name: str) -> tuple[Serializer, Serializer]:
        """Return the serializers of a service's request and response; as `message`."""
        if name not in self._service_serializers:
            service = self.definitions.service(name)
            self._service_serializers[name] = (
                self.serializers.of_definition(service.request),
                self.serializers.of_definition(service.response),
            )
        return self._service_serializers[name]

    def action_serializers(self, name: str) -> tuple[Serializer, Serializer, Serializer]:
        """Return the serializers of an action's goal, feedback and result; as `message`."""
        if name not in self._action_serializers:
            action, make = self.definitions.action(name), self.serializers.of_definition
            self._action_serializers[name] = (
                make(action.goal),
                make(action.feedback),
                make(action.result),
            )
        return self._action_serializers[name]

    def action(self, name: str) -> ActionType:
        """Return the type of an action; as `message`."""
        if name not in self._actions:
            action, md5 = self.definitions.action(name), self.definitions.md5
            self._actions[name] = ActionType(
                name,
                self._validate(action.goal),
                self._validate(action.feedback),
                self._validate(action.result),
                _fields(action.goal),
                (md5(action.goal.type), md5(action.feedback.type), md5(action.result.type)),
                self,
            )
        return self._actions[name]

    def _validate(self, definition: MessageDefinition) -> Validate:
        return self.validators.of_definition(definition).validate


class Types:
    """All types of one hub, each made on first use.

    Types that clients brought are kept while something of the graph holds them. An object that has
    one may use it after that, too: each type holds the definitions that it needs.

    Args:
        now: returns the nanoseconds since 1970, for messages that ask for the time.
        strict: refuse types of unknown packages, rather than relay their messages unchecked.
        shows: as of `ClientDefinitions`.
    """

    def __init__(
        self,
        interfaces: Interfaces,
        now: Callable[[], int],
        *,
        strict: bool,
        shows: Shows = show_all,
    ) -> None:
        self.definitions = ClientDefinitions(interfaces, shows)
        self._now = now
        self._strict = strict
        self._installed = Codecs(interfaces, now)
        self._own = self._installed if interfaces.is_standard else Codecs(Interfaces(), now)
        """The standard types, which the hub's own topics and services have."""
        self._brought: dict[ClientDefinition, Codecs] = {}
        """The codecs of the definitions that are held."""

    def message(
        self,
        name: str,
        definition: str | None = None,
        client: str = "",
        md5sum: str | None = None,
    ) -> MessageType:
        """Return the type of a topic.

        Args:
            name: ``package/Type``.
            definition: its text, if the client brought one.
            client: the client's node.
            md5sum: that of the type, if the client knows it. Without a definition, it chooses from
                the types of this name that are known; if it is that of none, the fields are
                unknown.

        Raises:
            InterfaceError: the definition is wrong, or the type's package does not have it.
            DefinitionMismatch: none that is known has the md5, and types are strict, or it is none.
        """
        try:
            found = self._codecs("msg", name, definition, client, md5sum).message(name)
        except (UnknownPackage, DefinitionLimit) as error:
            fault, meant = self._fault(error)
            return UncheckedType(name, fault, meant)
        if definition is None and md5sum not in (None, ANY_TYPE, found.md5sum):
            mismatch = DefinitionMismatch(name, md5sum, found.md5sum or "")
            if self._strict or not _MD5.fullmatch(md5sum):
                raise mismatch
            return UncheckedType(name, str(mismatch), claimed=md5sum)
        return found

    def service(
        self,
        name: str,
        definition: str | None = None,
        client: str = "",
        md5sum: str | None = None,
    ) -> ServiceType:
        """Return the type of a service; arguments and errors as with `message`."""
        try:
            return self._codecs("srv", name, definition, client, md5sum).service(name)
        except (UnknownPackage, DefinitionLimit) as error:
            fault, meant = self._fault(error)
        return ServiceType(name, _relayed(name), _relayed(name), fault=fault, meant=meant)

    def action(self, name: str, definition: str | None = None, client: str = "") -> ActionType:
        """Return the type of an action; arguments and errors as with `message`."""
        try:
            return self._codecs("action", name, definition, client, None).action(name)
        except (UnknownPackage, DefinitionLimit) as error:
            fault, meant = self._fault(error)
        relayed = _relayed(name)
        return ActionType(name, relayed, relayed, relayed, fault=fault, meant=meant)

    def own_message(self, name: str) -> MessageType:
        """Return the type of one of the hub's own topics, which is the standard one.

        If that of the folders is the same, it is that object.
        """
        return self._own_codecs("msg", name).message(name)

    def own_service(self, name: str) -> ServiceType:
        """Return the type of one of the hub's own services; as `own_message`."""
        return self._own_codecs("srv", name).service(name)

    def _own_codecs(self, kind: Kind, name: str) -> Codecs:
        own = self._own
        if own is self._installed or _has_md5(
            self._installed, kind, name, own.definitions.md5_of(kind, name)
        ):
            return self._installed
        return own

    def without_definition(self, type_: MessageType) -> MessageType:
        """Return a type without the definition that a client brought."""
        return type_ if self._strict or _brought(type_) is None else UncheckedType(type_.name)

    def hold(self, type_: AnyType, holder: Hashable) -> None:
        """Keep the definition of a type until its holder releases it; see `ClientDefinitions`."""
        definition = _brought(type_)
        if definition is not None and type_.codecs is not None:
            self.definitions.hold(definition, holder)
            self._brought[definition] = type_.codecs

    def release(self, type_: AnyType, holder: Hashable) -> None:
        """Let a holder use the definition of a type no longer; the last one forgets it."""
        definition = _brought(type_)
        if definition is not None and self.definitions.release(definition, holder):
            del self._brought[definition]

    def _codecs(
        self, kind: Kind, name: str, text: str | None, client: str, md5sum: str | None
    ) -> Codecs:
        """Return the codecs of a type that the folders or clients have, or this client brings."""
        if text is None:
            if md5sum not in (None, ANY_TYPE):
                found = self._with_md5(kind, name, client, md5sum)
                if found is not None:
                    return found
            definition = self.definitions.find_for(client, kind, name)
        else:
            definition = self.definitions.read(kind, name, text, client)
        return self._codecs_of(definition)

    def _with_md5(self, kind: Kind, name: str, client: str, md5sum: str) -> Codecs | None:
        """Return the codecs of the type of this name and md5, if it is known."""
        for each in (self._installed, self._own):
            if _has_md5(each, kind, name, md5sum):
                return each
        definition = self.definitions.find_for(client, kind, name, md5sum)
        return None if definition is None else self._codecs_of(definition)

    def _codecs_of(self, definition: ClientDefinition | None) -> Codecs:
        if definition is None:
            return self._installed
        return self._brought.get(definition) or Codecs(definition, self._now)

    def _fault(self, error: UnknownPackage | DefinitionLimit) -> tuple[str, str]:
        """Return the ``fault`` and ``meant`` of an unchecked type.

        Raises:
            UnknownPackage, DefinitionLimit: the error itself, if types are strict.
        """
        if self._strict:
            raise error
        if isinstance(error, DefinitionLimit):
            return str(error), ""
        return "", error.meant or ""


def _brought(type_: AnyType) -> ClientDefinition | None:
    """Return the definition of a type, if a client brought it."""
    definitions = type_.codecs.definitions if type_.codecs is not None else None
    return definitions if isinstance(definitions, ClientDefinition) else None


def _has_md5(codecs: Codecs, kind: Kind, name: str, md5sum: str) -> bool:
    """Return whether a type is among these, with this md5."""
    try:
        return codecs.definitions.md5_of(kind, name) == md5sum
    except InterfaceError:
        return False


def _fields(definition: MessageDefinition) -> tuple[str, ...]:
    return tuple(field.name for field in definition.fields)


def _by_name(args: object, names: tuple[str, ...] | None, type_: str) -> dict[str, Any]:
    if isinstance(args, list):
        if names is None:
            raise InvalidMessage(
                f"Expected a JSON object for type {type_}, whose fields are not known here"
            )
        return dict(zip(names, args, strict=False))
    return args if isinstance(args, dict) else {}


def _relayed(name: str) -> Validate:
    """Return a check of the one thing that can be checked: that a message is an object."""

    def validate(msg: object) -> dict[str, Any]:
        if not isinstance(msg, dict):
            raise InvalidMessage(
                f"Expected a JSON object for type {name} but received a {type(msg).__name__}"
            )
        return {name: _as_json(value) for name, value in msg.items()}

    return validate


def _as_json(value: Any) -> Any:
    """Return a value with base64 for bytes, which CBOR can hold and no type describes here."""
    if isinstance(value, bytes):
        return base64text.encode(value)
    if isinstance(value, dict):
        return {name: _as_json(each) for name, each in value.items()}
    if isinstance(value, list) and not _SCALARS.issuperset(map(type, value)):
        return [_as_json(each) for each in value]
    return value


def unknown_service(
    name: str = ANY_TYPE, md5sum: str | None = None, fault: str = ""
) -> ServiceType:
    """Return the type of a service whose definition is still to be learned."""
    relayed = _relayed(name)
    return ServiceType(name, relayed, relayed, md5sum=md5sum, fault=fault, is_known=False)
