"""The types that a node uses: their classes, and how messages become bytes and JSON, and back."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any, Generic, cast

from typing_extensions import TypeVar

from fibws.action import action_class
from fibws.errors import InterfaceError, InvalidMessage, InvalidTypeName
from fibws.interfaces import Action, Duration, Interfaces, Message, Service, Time, Validators
from fibws.interfaces.message import F, G, R, Req, Res
from fibws.interfaces.python_names import ros_name
from fibws.interfaces.serialization import ClassCodec, Serializers, class_codec
from fibws.interfaces.serialized_values import SerializedValues
from fibws.msg import default_interfaces, message_class
from fibws.srv import service_class
from fibws.suggestions import suggestion_or_known

M = TypeVar("M", bound=Message, default=Any)
N = TypeVar("N", bound=Message)

ANY_TYPE = "*"
"""The type of rospy's AnyMsg, whose messages are not decoded."""


class MessageCodec(Generic[N]):
    """Converts the messages of one class to ROS 1's bytes and to JSON values, and back.

    Args:
        message_class: the class.
        validate: checks a message's JSON values and fills in defaults, or raises `InvalidMessage`.
        md5sum: the md5 of the type; None if the type is `ANY_TYPE`, or has no name of its own.
        definition: the type's text for hubs that may lack it; None for standard types.
        has_floats: whether a message may hold NaN or infinity.
    """

    def __init__(
        self,
        message_class: type[N],
        validate: Callable[[Any], dict[str, Any]],
        *,
        md5sum: str | None = None,
        definition: str | None = None,
        has_floats: bool = True,
    ) -> None:
        self.message_class = message_class
        self.md5sum = md5sum
        self.definition = definition
        self.has_floats = has_floats
        self._validate = validate

    @property
    def type(self) -> str:
        """The type's name, such as ``std_msgs/Int32``."""
        return self.message_class._type

    @cached_property
    def serialize(self) -> Callable[[Any], bytes]:
        """Returns a message's bytes.

        It raises InvalidMessage if a field does not fit the type, and TypeError if it is given
        anything but a message of the class.
        """
        return self._bytes.serialize

    @cached_property
    def serialize_after(self) -> Callable[[Callable[[int], bytes], Any], bytes]:
        """Returns a message's bytes behind a head; see `ClassCodec.serialize_after`."""
        return self._bytes.serialize_after

    @cached_property
    def deserialize(self) -> Callable[[bytes | bytearray | memoryview], N]:
        """Returns the message that some bytes are; it raises InvalidMessage if they are invalid."""
        return self._bytes.deserialize

    @cached_property
    def _bytes(self) -> ClassCodec[N]:
        return class_codec(self.message_class)

    def write(self, given: object) -> dict[str, Any]:
        """Return a message as JSON values.

        Args:
            given: a message of the class, or a mapping of its fields; those left out have defaults.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is neither.
        """
        if not isinstance(given, self.message_class) and not isinstance(given, Mapping):
            raise self.mismatch(given)
        try:
            return self._validate(_plain(given))
        except InvalidMessage:
            unknown = self._unknown_field(given) if isinstance(given, Mapping) else None
            if unknown is None:
                raise
            raise InvalidMessage(unknown) from None

    def make(self, values: Sequence[Any], named: Mapping[str, Any]) -> N:
        """Return the message of fields in order or by name, or of a mapping of them.

        Raises:
            InvalidMessage: a field of the mapping does not fit the type.
            TypeError: there is no such field, or there are too many; the text names them.
        """
        if len(values) == 1 and not named and isinstance(values[0], Mapping):
            return self.message_class.from_dict(self.write(values[0]))
        try:
            return self.message_class(*values, **named)
        except TypeError:
            fields = self._fields()
            if len(values) > len(fields):
                text = f"{self.type} has {len(fields)} fields, got {len(values)}: "
                raise TypeError(f"{text}{', '.join(fields) or 'none'}") from None
            unknown = self._unknown_field(map(ros_name, named))
            if unknown is None:
                raise
            raise TypeError(unknown) from None

    def _fields(self) -> list[str]:
        """Return the names of the fields."""
        return list(self.message_class().to_dict())

    def _unknown_field(self, names: Iterable[str]) -> str | None:
        """Return the text of an error if one of the names is not a field's."""
        fields = self._fields()
        for name in names:
            if name not in fields:
                hint = suggestion_or_known(str(name), fields)
                return f"Message type {self.type} does not have a field {name}{hint}"
        return None

    def mismatch(self, given: object) -> TypeError:
        """Return the error for something that is not a message of the class."""
        if isinstance(given, type):
            text = f"expected [{self.type}] but got the class {given.__name__}"
            is_meant = issubclass(given, self.message_class)
            return TypeError(f"{text}: write {given.__name__}()" if is_meant else text)
        found = given._type if isinstance(given, Message) else type(given).__name__
        text = f"expected [{self.type}] but got [{found}]"
        if not isinstance(given, Message):
            text += f"; write a dict of its fields: {', '.join(self._fields()) or 'it has none'}"
        if found == self.type:
            text += f": {_full_name(type(given))} is not {_full_name(self.message_class)}"
        return TypeError(text)

    def read(self, values: Any) -> N:
        """Return the message that JSON values or `SerializedValues` are.

        Raises:
            InvalidMessage: they do not fit the type.
        """
        if isinstance(values, SerializedValues):
            return self.deserialize(values.data)
        return self.message_class.from_dict(self._validate(values))

    def encode(self, given: object) -> bytes:
        """Return a message's bytes.

        Args:
            given: as for `write`.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is neither a message of the class nor a mapping.
        """
        if isinstance(given, self.message_class):
            return self.serialize(given)
        return self.serialize(self.message_class.from_dict(self.write(given)))

    def json(self, data: bytes) -> dict[str, Any]:
        """Return the JSON values of bytes that `encode` has returned."""
        return self.write(self.deserialize(data))


class SerializedCodec(MessageCodec[Any]):
    """Passes on serialized messages of one type, which this node need not know, as ``bytes``.

    Args:
        type_: the type's name.
        interfaces: where the type is looked up for a server without `fibws.v1`.
        md5sum: the md5 of the type, if it is known.
        definition: the type's text, for hubs that may lack it.
    """

    def __init__(
        self, type_: str, interfaces: Interfaces, *, md5sum: str | None, definition: str | None
    ) -> None:
        self.message_class: type[Any] = bytes
        self.md5sum = md5sum
        self.definition = definition
        self.has_floats = True
        self._type = type_
        self._interfaces = interfaces

    @property
    def type(self) -> str:
        """The type's name."""
        return self._type

    @cached_property
    def serialize_after(self) -> Callable[[Callable[[int], bytes], bytes], bytes]:
        """Returns the bytes behind a head."""
        return lambda head, data: head(len(data)) + data

    @cached_property
    def deserialize(self) -> Callable[[bytes | bytearray | memoryview], Any]:
        """Returns the bytes."""
        return bytes

    def make(self, values: Sequence[Any], named: Mapping[str, Any]) -> Any:
        """Return the bytes, which are the only value.

        Raises:
            TypeError: there are others, or none.
        """
        if len(values) != 1 or named or not isinstance(values[0], (bytes, bytearray, memoryview)):
            raise TypeError(f"messages for a serialized publisher of {self.type} are bytes")
        return bytes(values[0])

    def write(self, given: object) -> dict[str, Any]:
        """Return a message as JSON values.

        Raises:
            InvalidMessage: its bytes are invalid, or its type is unknown here.
        """
        assert isinstance(given, bytes)
        try:
            return Serializers(self._interfaces).of(self._type).deserialize(given, "replace")
        except InterfaceError as error:
            raise InvalidMessage(f"cannot be sent as JSON: {error}") from None


class NodeServiceType(Generic[Req, Res]):
    """One service type: the codecs of its requests and responses.

    Args:
        name: its name, ``package/Type``.
        md5sum: its md5.
        request: the codec of its requests.
        response: the codec of its responses.
    """

    def __init__(
        self, name: str, md5sum: str, request: MessageCodec[Req], response: MessageCodec[Res]
    ) -> None:
        self.name = name
        self.md5sum = md5sum
        self.request = request
        self.response = response

    def encode_request(self, given: Req | Mapping[str, Any] | None) -> bytes:
        """Return a caller's request as bytes; fields that are not given have defaults.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is not a request of this type.
        """
        return self.request.encode({} if given is None else given)

    def read_request(self, args: Any) -> Req:
        """Return the request that values are, or raise `InvalidMessage`."""
        return self.request.read({} if args is None else args)

    def encode_response(self, given: object) -> bytes:
        """Return what a handler returned as bytes.

        As in rospy it may be a response, a dict of its fields, a tuple or list of them in order, or
        the only field's value.

        Raises:
            InvalidMessage: it is of another type; the texts are rospy's (rospy.service).
        """
        if given is None:
            raise InvalidMessage("service handler returned None")
        if not isinstance(given, Mapping | Message):
            fields = given if isinstance(given, (tuple, list)) else (given,)
            try:
                given = self.response.message_class(*fields)
            except TypeError as error:
                raise InvalidMessage(f"handler returned wrong number of values: {error}") from None
        try:
            return self.response.encode(given)
        except (InvalidMessage, TypeError) as error:
            raise InvalidMessage(f"handler returned invalid value: {error}") from None


class NodeActionType(Generic[G, R, F]):
    """One action type: the codecs of its goals, results and feedback.

    Raises:
        InterfaceError: the type is unknown.
    """

    def __init__(self, types: NodeTypes, action: type[Action[G, R, F]]) -> None:
        self.name = action._type
        self.definition = types.action_definition(action._type)
        """The type's text for hubs that may lack it; None for standard types."""
        self.md5sum = types.action_md5(action._type)
        """The md5s of goal, feedback and result, with commas between them."""
        self.goal = types.codec(action.Goal)
        self.result = types.codec(action.Result)
        self.feedback = types.codec(action.Feedback)


class NodeTypes:
    """The types of one node.

    Args:
        now: returns the time in nanoseconds since 1970.
    """

    def __init__(self, now: Callable[[], int]) -> None:
        self._interfaces: Interfaces = default_interfaces()
        self._validators = Validators(self._interfaces, now)
        self._services: dict[type[Service[Any, Any]], NodeServiceType[Any, Any]] = {}

    def message_class(self, type_: Callable[..., M] | str) -> type[M]:
        """Return the class itself, or that of the type of this name.

        Raises:
            InterfaceError: the type is unknown.
            TypeError: it is neither.
        """
        if isinstance(type_, str):
            name = _with_package(type_, "a message")
            return cast(type[M], message_class(self._interfaces.message(name).type))
        found = cast(type[M], _checked(type_, "a message"))
        if found._type != ANY_TYPE:
            self._interfaces.message(found._type)
        return found

    def validate(self, type_: str) -> Callable[[Any], dict[str, Any]]:
        """Return what checks JSON values of a message type and fills in defaults."""
        return self._validators.of(type_).validate

    def codec(self, message_class: type[N]) -> MessageCodec[N]:
        """Return the codec of a message class.

        Raises:
            InterfaceError: the type is unknown.
        """
        name = message_class._type
        if name == ANY_TYPE:
            return MessageCodec(message_class, _refuse_json)
        return MessageCodec(
            message_class,
            self.validate(name),
            md5sum=self._interfaces.md5(name),
            definition=self.definition(name),
            has_floats=self._interfaces.has_floats(self._interfaces.message(name)),
        )

    def serialized(self, type_: str, md5sum: str | None, definition: str | None) -> SerializedCodec:
        """Return the codec of messages that are serialized already; see `SerializedCodec`.

        The definition of a standard type is left out: every hub has it.
        """
        if not isinstance(type_, str):
            raise TypeError(f"expected the name of a type, such as std_msgs/Int32, got {type_!r}")
        try:
            if self.definition(type_) is None and md5sum in (None, self._interfaces.md5(type_)):
                definition = None
        except InterfaceError:
            pass
        return SerializedCodec(type_, self._interfaces, md5sum=md5sum, definition=definition)

    def definition(self, type_: str) -> str | None:
        """Return the type's text for hubs that may lack it; None for standard types."""
        if self._interfaces.is_users(self._interfaces.message(type_).package):
            return self._interfaces.full_text(type_)
        return None

    def service_class(self, type_: type[Service[Req, Res]] | str) -> type[Service[Any, Any]]:
        """Return the class itself, or that of the service type of this name."""
        if isinstance(type_, str):
            return service_class(_with_package(type_, "a service"))
        return _checked(type_, "a service")

    def service(self, type_: type[Service[Req, Res]]) -> NodeServiceType[Req, Res]:
        """Return how messages of a service type become JSON values.

        Raises:
            InterfaceError: the type is unknown.
        """
        if type_ not in self._services:
            definition = self._interfaces.service(type_._type)
            request = self._validators.of_definition(definition.request).validate
            response = self._validators.of_definition(definition.response).validate
            self._services[type_] = NodeServiceType(
                definition.type,
                self._interfaces.service_md5(type_._type),
                MessageCodec(type_.Request, request),
                MessageCodec(type_.Response, response),
            )
        return self._services[type_]

    def service_definition(self, type_: str) -> str | None:
        """Return a service type's text, as `definition` does."""
        if self._interfaces.is_users(self._interfaces.service(type_).package):
            return self._interfaces.service_text(type_)
        return None

    def action_class(self, type_: type[Action[G, R, F]] | str) -> type[Action[Any, Any, Any]]:
        """Return the class itself, or that of the action type of this name."""
        if isinstance(type_, str):
            return action_class(_with_package(type_, "an action"))
        return _checked(type_, "an action")

    def action_md5(self, type_: str) -> str:
        """Return the md5s of an action's goal, feedback and result, with commas between them."""
        action = self._interfaces.action(type_)
        messages = (action.goal, action.feedback, action.result)
        return ",".join(self._interfaces.md5(each.type) for each in messages)

    def action_definition(self, type_: str) -> str | None:
        """Return an action type's text, as `definition` does."""
        if self._interfaces.is_users(self._interfaces.action(type_).package):
            return self._interfaces.action_text(type_)
        return None


_EXAMPLES = {
    "a message": "std_msgs/Int32",
    "a service": "std_srvs/Trigger",
    "an action": "actionlib_tutorials/Fibonacci",
}


def _with_package(type_: str, kind: str) -> str:
    """Return the name of a type; raise `InvalidTypeName` if it has no package."""
    if "/" not in type_:
        raise InvalidTypeName(type_, f"; write its package, too, as in {_EXAMPLES[kind]}")
    return type_


_Class = TypeVar("_Class")


def _checked(given: _Class, kind: str) -> _Class:
    """Return a class of messages, services or actions; raise TypeError if it is something else."""
    if not isinstance(given, type) or not isinstance(getattr(given, "_type", None), str):
        example = f"such as {_EXAMPLES[kind]}"
        raise TypeError(f"expected {kind} class or the name of a type, {example}, got {given!r}")
    return given


def _full_name(class_: type) -> str:
    return f"{class_.__module__}.{class_.__qualname__}"


def _refuse_json(values: Any) -> dict[str, Any]:
    raise InvalidMessage("a message of any type cannot come as JSON; it needs a hub of fibws.v1")


def _plain(value: object) -> Any:
    """Return a message, or fields that may hold messages, as JSON values."""
    match value:
        case Message():
            return value.to_dict()
        case Time() | Duration():
            return {"secs": value.secs, "nsecs": value.nsecs}
        case Mapping():
            return {name: _plain(field) for name, field in value.items()}
        case list() | tuple():
            return [_plain(element) for element in value]
        case _:
            return value
