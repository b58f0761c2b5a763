"""The bases of the Python classes that `generator` writes for messages, services and actions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import Field, dataclass, fields
from functools import cache, partial
from math import nan
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Generic,
    Literal,
    NamedTuple,
    Self,
    TypeAlias,
    get_args,
    get_origin,
    get_type_hints,
)

from typing_extensions import TypeVar

from fibws.interfaces import base64text
from fibws.interfaces.catalogue import Definitions, Interfaces
from fibws.interfaces.definition import MessageDefinition
from fibws.interfaces.python_names import python_name, ros_name
from fibws.interfaces.times import Duration, Time

if TYPE_CHECKING:
    from fibws.interfaces.serialization import ClassCodec

_Convert: TypeAlias = Callable[[Any], Any]


# Its subclasses are dataclasses without methods of their own for == and repr: to write those for
# each of a package's classes takes longer than all the rest of the package's import.
@dataclass(slots=True, eq=False, repr=False)
class Message:
    """The base of message classes, called as in rospy: ``Int32(5)`` or ``Int32(data=5)``."""

    _type: ClassVar[str] = ""
    _service: ClassVar[str] = ""
    """The service, if this is its request or response."""
    _style: ClassVar[ObjectStyle]
    _find_interfaces: ClassVar[Callable[[], Definitions]]
    """Returns the types among which the class's definition is looked up; set by `fibws.msg`."""
    _codecs: ClassVar[dict[Any, Any]]
    """The cache of `class_codec`."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(_value(self, field) == _value(other, field) for field in fields(self))

    def __repr__(self) -> str:
        values = (f"{field.name}={_value(self, field)!r}" for field in fields(self))
        return f"{type(self).__name__}({', '.join(values)})"

    def to_dict(self) -> dict[str, Any]:
        """Return the message as a dict for JSON: bytes are base64.

        Values of a wrong type are not changed, so that `MessageValidator.validate` refuses them.
        """
        return {
            member.name: member.write(getattr(self, member.attribute))
            for member in _members(type(self))
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Self:
        """Make a message from a valid dict with all fields; None becomes NaN."""
        return cls(
            **{member.attribute: member.read(values[member.name]) for member in _members(cls)}
        )

    # Used by `class_codec`. No field can have such a name: fields' names begin with letters.

    @classmethod
    def _definition_in(cls, interfaces: Definitions) -> MessageDefinition:
        """The class's definition."""
        if not cls._service:
            return interfaces.message(cls._type)
        service = interfaces.service(cls._service)
        return service.request if service.request.type == cls._type else service.response

    @classmethod
    def _nested_class(cls, name: str) -> type[Message]:
        """The class of the messages in a field."""
        found: type[Message] = next(each.nested for each in _members(cls) if each.name == name)
        return found

    @classmethod
    def _make_codec(cls, interfaces: Definitions, style: ObjectStyle) -> ClassCodec[Self]:
        """A new codec of the class."""
        from fibws.interfaces.serialization import ClassCodec

        return ClassCodec(cls, interfaces, style)


@dataclass(frozen=True, slots=True, eq=False)
class ObjectStyle:
    """How the objects of a kind of message classes look to `class_codec`.

    Attributes:
        attribute: returns the attribute for a field's name.
        times: the classes for ``time`` and ``duration``, with ``secs`` and ``nsecs``.
        carry: the method of a time that carries over whole seconds in ``nsecs``.
        arrays: makes a deserialized array of numbers; arrays of uint8 are always `bytes`.
        exact: whether values of nested messages and times must be of the very class.
        on_invalid_text: is called when a string that is not UTF-8 is deserialized.
    """

    attribute: Callable[[str], str]
    times: Mapping[str, type]
    carry: str
    arrays: Literal["list", "tuple", "numpy"]
    exact: bool
    on_invalid_text: Callable[[type[Message], UnicodeDecodeError], None] | None = None


Message._style = ObjectStyle(
    python_name, {"time": Time, "duration": Duration}, "_carry", "list", exact=True
)
Message._find_interfaces = cache(Interfaces)


Req = TypeVar("Req", bound=Message, default=Any)
Res = TypeVar("Res", bound=Message, default=Any)
G = TypeVar("G", bound=Message, default=Any)
R = TypeVar("R", bound=Message, default=Any)
F = TypeVar("F", bound=Message, default=Any)


class Service(Generic[Req, Res]):
    """The base of service classes: ``AddTwoInts.Request`` and ``AddTwoInts.Response`` are messages.

    No objects are made of it. A function that takes a ``type[Service[Req, Res]]`` and a ``Req`` can
    return a ``Res``.
    """

    _type: ClassVar[str]
    Request: type[Req]
    """The class of the requests."""
    Response: type[Res]
    """The class of the responses."""

    def __init_subclass__(cls) -> None:
        for name in ("Request", "Response"):
            if name in cls.__dict__:
                cls.__dict__[name]._service = cls._type


class Action(Generic[G, R, F]):
    """The base of action classes, whose messages are ``Goal``, ``Feedback`` and ``Result``."""

    _type: ClassVar[str]
    Goal: type[G]
    """The class of the goals."""
    Result: type[R]
    """The class of the results."""
    Feedback: type[F]
    """The class of the feedback."""


def _value(message: object, field: Field[Any]) -> Any:
    return getattr(message, field.name)


class _Member(NamedTuple):
    """A field of a message class: its names, and how its value is converted to JSON and back.

    ``nested`` is the class of the messages in it, if there are any.
    """

    attribute: str
    name: str
    nested: Any
    write: _Convert
    read: _Convert


_known_members: dict[type[Message], tuple[_Member, ...]] = {}


def _members(message: type[Message]) -> tuple[_Member, ...]:
    """The fields of a message class, which are found on first use."""
    if message not in _known_members:
        hints = get_type_hints(message)
        _known_members[message] = tuple(
            _Member(
                field.name,
                ros_name(field.name),
                (get_args(hints[field.name]) or (hints[field.name],))[0],
                *_converters(hints[field.name]),
            )
            for field in fields(message)
        )
    return _known_members[message]


def _converters(hint: Any) -> tuple[_Convert, _Convert]:
    """Return how a value of the annotated type is converted to JSON and back."""
    if get_origin(hint) is list:
        (element,) = get_args(hint)
        if element is float:
            return _write_numbers, _read_floats
        if element in (int, bool):
            return _write_numbers, _same
        write, read = _converters(element)
        if write is _same:
            return _same, _same
        return partial(_write_all, write), partial(_read_all, read)
    if hint is bytes:
        return _write_bytes, base64text.decode
    if hint is float:
        return _same, _read_float
    if hint in (Time, Duration):
        return partial(_write_time, hint), partial(_read_time, hint)
    if issubclass(hint, Message):
        return _write_message, hint.from_dict
    return _same, _same


def _same(value: Any) -> Any:
    return value


def _write_numbers(values: Any) -> Any:
    """Convert a tuple or an array, such as numpy's, to a list."""
    if isinstance(values, tuple):
        return list(values)
    return values.tolist() if hasattr(values, "tolist") else values


def _write_all(write: _Convert, values: Any) -> Any:
    return [write(value) for value in values] if isinstance(values, (list, tuple)) else values


def _read_all(read: _Convert, values: list[Any]) -> list[Any]:
    return [read(value) for value in values]


def _write_message(value: Any) -> Any:
    return value.to_dict() if isinstance(value, Message) else value


class _Text:
    """A placeholder for a str in a field of bytes: validation would take it for base64."""


_Text.__name__ = "str"  # The name in the error.


def _write_bytes(value: Any) -> Any:
    if isinstance(value, str):
        return _Text()
    try:
        view = memoryview(value)
    except TypeError:
        return value
    # In other arrays, an element has several bytes.
    return base64text.encode(view.tobytes()) if view.format == "B" else value


def _read_float(value: float | None) -> float:
    return nan if value is None else value


def _read_floats(values: list[float | None]) -> list[float]:
    return [nan if value is None else value for value in values]


def _write_time(kind: type[Time | Duration], value: Any) -> Any:
    return {"secs": value.secs, "nsecs": value.nsecs} if isinstance(value, kind) else value


def _read_time(kind: type[Time | Duration], value: dict[str, int]) -> Time | Duration:
    return kind(value["secs"], value["nsecs"])
