"""The types of topics, services and actions: what checks and encodes their messages.

A type of a package that nobody has defined is unchecked: its messages are relayed as they come.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn, Protocol, TypeAlias

import cbor2

from fibws.errors import InvalidMessage, UnknownDefinition, UnknownPackage
from fibws.interfaces import Interfaces, MessageDefinition, Validators, base64text
from fibws.interfaces.cbor import CborEncoders
from fibws.interfaces.serialization import Serializer, Serializers

_SCALARS = frozenset({str, int, float, bool, type(None)})

Buffer: TypeAlias = bytes | bytearray | memoryview
"""Serialized bytes; whoever holds them must not change them."""
Validate: TypeAlias = Callable[[object], dict[str, Any]]
"""Returns a message with every field filled; raises `InvalidMessage`."""


class MessageType(Protocol):
    """The type of a topic's messages: a `CheckedType` or an `UncheckedType`."""

    name: str
    """``package/Type``."""
    checked: bool
    """Whether the fields are known, so that messages are checked."""
    sequenced: bool
    """Whether publishers count their messages in ``header.seq``, as rospy's do."""
    validate: Validate

    @property
    def has_floats(self) -> bool:
        """Whether a message may hold NaN or infinity."""

    @property
    def md5sum(self) -> str | None:
        """The md5 of the definition, as ROS 1 computes it, if it is known."""

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """Return the fields that a valid message leaves to their defaults: ``pose.x``."""

    def cbor(self, values: dict[str, Any]) -> bytes:
        """Return valid values as CBOR."""

    def cbor_of(self, data: Buffer) -> tuple[bytes, bool]:
        """Return checked bytes as CBOR, and whether a string in them was not UTF-8."""

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

    def __init__(self, name: str, codecs: Codecs) -> None:
        validator = codecs.validators.of(name)
        self.name = validator.type
        self.validate: Validate = validator.validate
        self.missing = validator.missing
        self.sequenced = validator.has_sequenced_header
        self._codecs = codecs

    @cached_property
    def md5sum(self) -> str | None:
        return self._codecs.interfaces.md5(self.name)

    @cached_property
    def has_floats(self) -> bool:
        interfaces = self._codecs.interfaces
        return interfaces.has_floats(interfaces.message(self.name))

    @cached_property
    def check(self) -> Callable[[Buffer], None]:
        return self._serializer.check

    @cached_property
    def serialize(self) -> Callable[[dict[str, Any]], Buffer]:
        return self._serializer.serialize

    @cached_property
    def cbor(self) -> Callable[[dict[str, Any]], bytes]:
        return self._codecs.cbor.of(self.name).encode

    @cached_property
    def _serializer(self) -> Serializer:
        return self._codecs.serializers.of(self.name)

    def cbor_of(self, data: Buffer) -> tuple[bytes, bool]:
        """Return checked bytes as CBOR, and whether a string in them was not UTF-8."""
        try:
            return self._serializer.to_cbor(data), False
        except UnicodeDecodeError:
            return self._serializer.to_cbor(data, "replace"), True

    def check_known(self) -> None:
        """Do nothing: the fields are known."""

    def deserialize(self, data: Buffer) -> tuple[dict[str, Any], bool]:
        """Return the values of checked bytes, and whether a string in them was not UTF-8."""
        try:
            return self._serializer.deserialize(data), False
        except UnicodeDecodeError:
            return self._serializer.deserialize(data, "replace"), True


class UncheckedType:
    """A type whose fields nobody has defined: its messages are relayed as they come."""

    checked = False
    sequenced = False
    has_floats = True
    md5sum: str | None = None

    def __init__(self, name: str) -> None:
        self.name = name
        self.validate: Validate = _relayed(name)

    def missing(self, msg: dict[str, Any]) -> list[str]:
        """Return nothing: the fields are unknown."""
        return []

    def cbor(self, values: dict[str, Any]) -> bytes:
        """Return values as CBOR."""
        return cbor2.dumps(values)

    def check_known(self) -> NoReturn:
        """Raise `UnknownDefinition`."""
        raise UnknownDefinition(self.name)

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

    ``arguments`` are the request's fields in order, and ``md5sum`` stands for the definition, if
    they are known.
    """

    name: str
    request: Validate
    response: Validate
    arguments: tuple[str, ...] | None
    md5sum: str | None

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
    feedback and result, if they are known.
    """

    name: str
    goal: Validate
    feedback: Validate
    result: Validate
    arguments: tuple[str, ...] | None
    md5sums: tuple[str, str, str] | None

    def fill_goal(self, args: object) -> dict[str, Any]:
        """Return the goal that ``args`` stand for; as `ServiceType.fill_request`."""
        return self.goal(_by_name(args, self.arguments, self.name))


@dataclass(frozen=True, slots=True, eq=False)
class Codecs:
    """The validators and encoders of all known types."""

    interfaces: Interfaces
    validators: Validators
    cbor: CborEncoders
    serializers: Serializers


class Types:
    """All types of one hub, each made when first asked for.

    Args:
        now: gives the nanoseconds since 1970, for messages that ask for the time.
        strict: refuse types of unknown packages, rather than relay their messages unchecked.
    """

    def __init__(self, interfaces: Interfaces, now: Callable[[], int], *, strict: bool) -> None:
        self._interfaces = interfaces
        self._strict = strict
        self._codecs = Codecs(
            interfaces,
            Validators(interfaces, now, lenient=True),
            CborEncoders(interfaces),
            Serializers(interfaces),
        )
        self._messages: dict[str, CheckedType] = {}
        self._services: dict[str, ServiceType] = {}
        self._actions: dict[str, ActionType] = {}

    def message(self, name: str, definition: str | None = None) -> MessageType:
        """Return the type of a topic.

        Args:
            name: ``package/Type``.
            definition: its text, if the client brought one.

        Raises:
            InterfaceError: the definition is wrong, or the type's package does not have it.
        """
        if definition is not None:
            self._interfaces.learn(name, definition)
        try:
            if name not in self._messages:
                self._messages[name] = CheckedType(name, self._codecs)
            return self._messages[name]
        except UnknownPackage:
            if self._strict:
                raise
            return UncheckedType(name)

    def service(self, name: str, definition: str | None = None) -> ServiceType:
        """Return the type of a service; arguments and errors as with `message`."""
        if definition is not None:
            self._interfaces.learn_service(name, definition)
        if name not in self._services:
            try:
                service = self._interfaces.service(name)
            except UnknownPackage:
                if self._strict:
                    raise
                return ServiceType(name, _relayed(name), _relayed(name), None, None)
            self._services[name] = ServiceType(
                name,
                self._validate(service.request),
                self._validate(service.response),
                _fields(service.request),
                self._interfaces.service_md5(name),
            )
        return self._services[name]

    def action(self, name: str, definition: str | None = None) -> ActionType:
        """Return the type of an action; arguments and errors as with `message`."""
        if definition is not None:
            self._interfaces.learn_action(name, definition)
        if name not in self._actions:
            try:
                action = self._interfaces.action(name)
            except UnknownPackage:
                if self._strict:
                    raise
                relayed = _relayed(name)
                return ActionType(name, relayed, relayed, relayed, None, None)
            self._actions[name] = ActionType(
                name,
                self._validate(action.goal),
                self._validate(action.feedback),
                self._validate(action.result),
                _fields(action.goal),
                (
                    self._interfaces.md5(action.goal.type),
                    self._interfaces.md5(action.feedback.type),
                    self._interfaces.md5(action.result.type),
                ),
            )
        return self._actions[name]

    def _validate(self, definition: MessageDefinition) -> Validate:
        return self._codecs.validators.of_definition(definition).validate


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
