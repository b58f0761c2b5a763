"""The types of topics, services and actions: what checks their messages, and what encodes them.

A type of a package that nobody defined is unchecked: its messages are relayed as they come.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import cbor2

from fibws.errors import InvalidMessage, OperationError, UnknownPackage
from fibws.hub.logtext import is_power_of_ten
from fibws.interfaces import Interfaces, MessageDefinition, Validators, base64text
from fibws.interfaces.cbor import CborEncoders
from fibws.interfaces.serialization import Serializers

logger = logging.getLogger("fibws.hub")

_PLAIN = frozenset({str, int, float, bool, type(None)})

Validate: TypeAlias = Callable[[object], dict[str, Any]]
"""Gives a message with every field filled; raises `InvalidMessage`."""
Encode: TypeAlias = Callable[[dict[str, Any]], bytes]
"""Encodes a valid message."""


@dataclass(frozen=True, slots=True, eq=False)
class MessageType:
    """What checks and encodes the messages of a topic.

    ``missing`` names the fields that a valid message leaves to their defaults. ``sequenced`` tells
    whether publishers count their messages in ``header.seq``, as rospy's do. ``binary`` raises
    `OperationError` if the type is not ``checked``.
    """

    name: str
    validate: Validate
    missing: Callable[[dict[str, Any]], list[str]]
    cbor: Encode
    binary: Encode
    sequenced: bool
    checked: bool

    def check_binary(self) -> None:
        """Raise `OperationError` if nobody knows how ROS 1 would serialize the messages."""
        if not self.checked:
            self.binary({})


@dataclass(frozen=True, slots=True, eq=False)
class ServiceType:
    """What checks the requests and responses of a service.

    ``arguments`` are the request's fields in order, and ``md5sum`` stands for the definition, if
    they are known.
    """

    name: str
    request: Validate
    response: Validate
    arguments: tuple[str, ...] | None
    md5sum: str | None

    def ask(self, args: object) -> dict[str, Any]:
        """The request that ``args`` stand for: an object, or a list of its fields in order.

        What is neither counts as no arguments at all, as the real server has it.

        Raises:
            InvalidMessage: a field does not fit the type.
        """
        return self.request(_named(args, self.arguments, self.name))


@dataclass(frozen=True, slots=True, eq=False)
class ActionType:
    """What checks the goals of an action, their feedback and their results.

    ``arguments`` are the goal's fields in order, if they are known.
    """

    name: str
    goal: Validate
    feedback: Validate
    result: Validate
    arguments: tuple[str, ...] | None

    def ask(self, args: object) -> dict[str, Any]:
        """The goal that ``args`` stand for; as `ServiceType.ask`."""
        return self.goal(_named(args, self.arguments, self.name))


def _named(args: object, names: tuple[str, ...] | None, type_: str) -> dict[str, Any]:
    if isinstance(args, list):
        if names is None:
            raise InvalidMessage(
                f"Expected a JSON object for type {type_}, whose fields are not known here"
            )
        return dict(zip(names, args, strict=False))
    return args if isinstance(args, dict) else {}


class Types:
    """All types of one hub, each made when first asked for.

    Args:
        now: gives the nanoseconds since 1970, for messages that ask for the time.
        strict: refuse types of unknown packages, rather than relay their messages unchecked.
    """

    def __init__(self, interfaces: Interfaces, now: Callable[[], int], *, strict: bool) -> None:
        self._interfaces = interfaces
        self._validators = Validators(interfaces, now)
        self._cbor = CborEncoders(interfaces)
        self._serializers = Serializers(interfaces)
        self._strict = strict
        self._times_unchecked = 0
        self._messages: dict[str, MessageType] = {}
        self._services: dict[str, ServiceType] = {}
        self._actions: dict[str, ActionType] = {}

    def message(self, name: str, definition: str | None = None) -> MessageType:
        """The type of a topic.

        Args:
            name: ``package/Type``.
            definition: its text, if the client brought one.

        Raises:
            InterfaceError: the definition is wrong, or the type's package does not have it.
        """
        if definition is not None:
            self._interfaces.learn(name, definition)
        try:
            return self._messages.get(name) or self._checked(name)
        except UnknownPackage as error:
            self._tolerate(name, error)
            return _unchecked(name)

    def service(self, name: str, definition: str | None = None) -> ServiceType:
        """The type of a service; arguments and errors as with `message`."""
        if definition is not None:
            self._interfaces.learn_service(name, definition)
        if name not in self._services:
            try:
                service = self._interfaces.service(name)
            except UnknownPackage as error:
                self._tolerate(name, error)
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
        """The type of an action; arguments and errors as with `message`."""
        if definition is not None:
            self._interfaces.learn_action(name, definition)
        if name not in self._actions:
            try:
                action = self._interfaces.action(name)
            except UnknownPackage as error:
                self._tolerate(name, error)
                relayed = _relayed(name)
                return ActionType(name, relayed, relayed, relayed, None)
            self._actions[name] = ActionType(
                name,
                self._validate(action.goal),
                self._validate(action.feedback),
                self._validate(action.result),
                _fields(action.goal),
            )
        return self._actions[name]

    def _checked(self, name: str) -> MessageType:
        validator = self._validators.of(name)
        self._messages[name] = MessageType(
            validator.type,
            validator.validate,
            validator.missing,
            # Few topics are ever heard in these encodings.
            lambda message: self._cbor.of(name).encode(message),
            lambda message: self._serializers.of(name).serialize(message),
            sequenced=validator.has_sequenced_header,
            checked=True,
        )
        return self._messages[name]

    def _validate(self, definition: MessageDefinition) -> Validate:
        return self._validators.of_definition(definition).validate

    def _tolerate(self, name: str, error: UnknownPackage) -> None:
        if self._strict:
            raise error
        self._times_unchecked += 1
        if is_power_of_ten(self._times_unchecked):
            logger.warning("%s. Messages of type %s are relayed unchecked.", error, name)


def _fields(definition: MessageDefinition) -> tuple[str, ...]:
    return tuple(field.name for field in definition.fields)


def _unchecked(name: str) -> MessageType:
    def binary(message: dict[str, Any]) -> bytes:
        raise OperationError(f"cbor-raw needs the definition of {name}, which nobody brought")

    return MessageType(
        name, _relayed(name), lambda msg: [], cbor2.dumps, binary, sequenced=False, checked=False
    )


def _relayed(name: str) -> Validate:
    """Only that a message is an object can be checked."""

    def validate(msg: object) -> dict[str, Any]:
        if not isinstance(msg, dict):
            raise InvalidMessage(
                f"Expected a JSON object for type {name} but received a {type(msg).__name__}"
            )
        return {name: _as_json(value) for name, value in msg.items()}

    return validate


def _as_json(value: Any) -> Any:
    """The value with base64 for bytes, which CBOR can bring where no type says what they are."""
    if isinstance(value, bytes):
        return base64text.encode(value)
    if isinstance(value, dict):
        return {name: _as_json(each) for name, each in value.items()}
    if isinstance(value, list) and not _PLAIN.issuperset(map(type, value)):
        return [_as_json(each) for each in value]
    return value
