"""The base of message classes, and the other public names of genpy.message."""

from __future__ import annotations

import logging
import struct
from dataclasses import replace
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar, Self

from fibws.errors import InvalidMessage
from fibws.interfaces import Message as GraphMessage
from fibws.interfaces import MessageDefinition
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.message import ObjectStyle
from fibws.interfaces.serialization import class_codec
from fibws.suggestions import suggestion
from genpy.checking import check_type
from genpy.errors import DeserializationError, MessageException, SerializationError
from genpy.filling import fill_message_args, get_printable_message_args
from genpy.lookup import get_message_class, get_service_class
from genpy.member import Member, refused
from genpy.member import attribute as python_name
from genpy.rostime import Duration, Time, TVal
from genpy.text import strify_message

__all__ = [
    "DeserializationError",
    "Duration",
    "Message",
    "MessageException",
    "SerializationError",
    "TVal",
    "Time",
    "check_type",
    "fill_message_args",
    "get_message_class",
    "get_printable_message_args",
    "get_service_class",
    "strify_message",
    "struct_I",
]

struct_I = struct.Struct("<I")
"""The struct of a length in ROS 1's serialization."""


class Message(GraphMessage):
    """A message: ``Int32(5)`` or ``Int32(data=5)`` creates one of its subclass ``Int32``.

    Fields that are omitted, or None, have their defaults.

    Raises:
        TypeError: both positional and named fields, or some positional ones but not all.
        AttributeError: a field is unknown.
    """

    __slots__ = ["_connection_header"]
    _slot_types: ClassVar[list[str]] = []
    _type: ClassVar[str] = ""
    _md5sum: ClassVar[str] = ""
    _has_header: ClassVar[bool] = False
    _full_text: ClassVar[str] = ""
    _members: ClassVar[tuple[Member, ...]] = ()
    _definition: ClassVar[MessageDefinition]

    _connection_header: dict[str, str]

    if TYPE_CHECKING:  # The fields are unknown to type checkers.

        def __getattr__(self, name: str) -> Any: ...
        def __setattr__(self, name: str, value: Any) -> None: ...

    def __init__(self, *args: Any, **kwds: Any) -> None:
        if args or kwds:
            self._assign(args, kwds)
            return
        for attribute, _, default, *_ in self._members:
            setattr(self, attribute, default())

    def _assign(self, args: tuple[Any, ...], kwds: dict[str, Any]) -> None:
        names: Any = self.__slots__
        if args and kwds:
            raise TypeError("Message constructor may only use args OR keywords, not both")
        if args and len(args) != len(names):
            raise TypeError(
                f"Invalid number of arguments, args should be {names!s} args are{args!s}"
            )
        given = dict(zip(names, args, strict=True)) if args else kwds
        for name in given:
            if name not in names:
                hint = suggestion(name, names)
                raise AttributeError(f"{name} is not an attribute of {type(self).__name__}{hint}")
        for attribute, _, default, *_ in self._members:
            value = given.get(attribute)
            setattr(self, attribute, default() if value is None else value)

    def to_dict(self) -> dict[str, Any]:
        """Return a dict for JSON; validation refuses values that genpy cannot pack."""
        return {
            name: write(getattr(self, attribute)) for attribute, name, _, write, *_ in self._members
        }

    @classmethod
    def dict_of(cls, value: Any) -> Any:
        """Do the same as `to_dict` for any object that has all fields of this class."""
        try:
            return {
                name: write(getattr(value, attribute))
                for attribute, name, _, write, *_ in cls._members
            }
        except AttributeError:
            return refused(value)

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Self:
        """Make a message from a valid dict with all fields; None becomes NaN."""
        message = cls.__new__(cls)
        for attribute, name, _, _, read, *_ in cls._members:
            setattr(message, attribute, read(values[name]))
        return message

    @classmethod
    def from_dict_numpy(cls, values: dict[str, Any]) -> Self:
        """Do the same as `from_dict`, with numpy's arrays for arrays of numbers."""
        message = cls.__new__(cls)
        for attribute, name, _, _, _, read, _ in cls._members:
            setattr(message, attribute, read(values[name]))
        return message

    def serialize(self, buff: BinaryIO) -> None:
        """Write the message to a file in ROS 1's serialization.

        Raises:
            SerializationError: a value does not fit its field.
        """
        try:
            data = class_codec(type(self)).serialize(self)
        except InvalidMessage as error:
            self._check_types(error)
            raise SerializationError(str(error)) from None
        buff.write(data)

    def deserialize(self, str: bytes) -> Self:
        """Set all fields from ROS 1's serialization; return the message itself.

        Raises:
            DeserializationError: the bytes are invalid for the type.
        """
        return self._take(str, self._style)

    def serialize_numpy(self, buff: BinaryIO, numpy: Any) -> None:
        """Do the same as `serialize`, which accepts numpy's arrays."""
        self.serialize(buff)

    def deserialize_numpy(self, str: bytes, numpy: Any) -> Self:
        """Do the same as `deserialize`, with numpy's arrays for arrays of numbers."""
        return self._take(str, NUMPY_STYLE)

    def _take(self, data: bytes, style: ObjectStyle) -> Self:
        try:
            other = class_codec(type(self), style=style).deserialize(data)
        except InvalidMessage as error:
            raise DeserializationError(str(error)) from None
        for member in self._members:
            setattr(self, member.attribute, getattr(other, member.attribute))
        return self

    @classmethod
    def _definition_in(cls, interfaces: Definitions) -> MessageDefinition:
        return cls._definition

    @classmethod
    def _nested_class(cls, name: str) -> type[GraphMessage]:
        nested = next(member.nested for member in cls._members if member.name == name)
        assert nested is not None
        return nested

    def _get_types(self) -> list[str]:
        return self._slot_types

    def _check_types(self, exc: Exception | None = None) -> None:
        """Find the field whose value does not fit.

        Args:
            exc: the error that shows that there is one.

        Raises:
            SerializationError: with the field; with the text of ``exc`` if no field is found.
        """
        for name, type_ in zip(self.__slots__, self._get_types(), strict=False):
            check_type(name, type_, getattr(self, name))
        if exc:
            raise SerializationError(str(exc))

    def __getstate__(self) -> list[Any]:
        return [getattr(self, name) for name in self.__slots__]

    def __setstate__(self, state: list[Any]) -> None:
        for name, value in zip(self.__slots__, state, strict=False):
            setattr(self, name, value)

    def __repr__(self) -> str:
        return strify_message(self)

    def __str__(self) -> str:
        return strify_message(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return False
        return all(
            _are_equal(getattr(self, name, None), getattr(other, name, None))
            for name in self.__slots__
        )

    __hash__ = None  # type: ignore[assignment]  # as in genpy, whose messages can change


def _are_equal(one: Any, other: Any) -> bool:
    """Return whether two values are equal; a list may equal a tuple."""
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return tuple(one) == tuple(other)
    return bool(one == other)


_undecodable: set[str] = set()
"""The types whose strings have been reported as invalid."""


def _report_invalid_text(message_class: type[GraphMessage], error: UnicodeDecodeError) -> None:
    """Log that a string is not UTF-8, once for each type, as genpy does."""
    type_ = message_class._type
    if type_ not in _undecodable:
        _undecodable.add(type_)
        logging.getLogger("rosout").error(
            "Characters replaced when decoding message %s (will print only once): %s", type_, error
        )


STYLE = ObjectStyle(
    python_name,
    {"time": Time, "duration": Duration},
    carry="canon",
    arrays="tuple",
    exact=False,
    on_invalid_text=_report_invalid_text,
)
NUMPY_STYLE = replace(STYLE, arrays="numpy")
Message._style = STYLE
