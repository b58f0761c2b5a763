"""Definitions of messages: http://wiki.ros.org/msg."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from fibws.errors import DefinitionError, InterfaceError
from fibws.interfaces.parser import parse_message
from fibws.msg import default_interfaces
from roslib import names

EXT = ".msg"
SEP = "/"
CONSTCHAR = "="
COMMENTCHAR = "#"
HEADER = "Header"
TIME = "time"
DURATION = "duration"
PRIMITIVE_TYPES = [
    *("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"),
    *("float32", "float64", "string", "bool", "char", "byte"),
]
BUILTIN_TYPES = [*PRIMITIVE_TYPES, TIME, DURATION]
RESERVED_TYPES = [*BUILTIN_TYPES, HEADER]
_HEADERS = (HEADER, "std_msgs/Header", "roslib/Header")


class MsgSpecException(Exception):
    """A definition is invalid, or unknown."""


def base_msg_type(type_: str | None) -> str | None:
    """Return the type of an array's elements: ``int32`` for ``int32[3]``; else the type."""
    return None if type_ is None else type_.partition("[")[0]


def resolve_type(type_: str, package_context: str) -> str:
    """Return a type with its package, if it is not built in: ``std_msgs/String[]``."""
    base = base_msg_type(type_)
    if base in BUILTIN_TYPES or SEP in type_:
        return "std_msgs/Header" if base == HEADER else type_
    return "std_msgs/Header" if base == HEADER else f"{package_context}{SEP}{type_}"


def parse_type(type_: str) -> tuple[str, bool, int | None]:
    """Return a type's base, whether it is an array, and how many elements it always has.

    Raises:
        MsgSpecException: it has another form.
    """
    if not type_:
        raise MsgSpecException("Invalid empty type")
    base, bracket, rest = type_.partition("[")
    if not bracket:
        return base, False, None
    if "[" in rest:
        raise MsgSpecException(f"Currently only support 1-dimensional array types: {type_}")
    if rest == "]":
        return base, True, None
    try:
        return base, True, int(rest[:-1])
    except ValueError:
        raise MsgSpecException(f"Invalid array dimension: [{rest[:-1]}]") from None


def is_valid_msg_type(x: str) -> bool:
    """Return whether a type, which may be an array, is well-formed."""
    if not x or x != x.strip():
        return False
    base, *dimensions = x.split("[")
    return names.is_legal_resource_name(base) and all(
        each.endswith("]") and (each == "]" or each[:-1].isdigit()) for each in dimensions
    )


def is_valid_constant_type(x: str) -> bool:
    """Return whether constants may have a type."""
    return x in PRIMITIVE_TYPES


def is_valid_msg_field_name(x: str) -> bool:
    """Return whether a field may have a name."""
    return names.is_legal_resource_base_name(x)


def is_header_type(type_: str) -> bool:
    """Return whether a type is that of headers, by any of its names."""
    return type_ in _HEADERS


def is_builtin(msg_type_name: str) -> bool:
    """Return whether a type is built in, such as ``int32``, ``string`` or ``time``."""
    return msg_type_name in BUILTIN_TYPES


class Constant:
    """A constant: its type, name, value, and the value's text."""

    __slots__ = ["name", "type", "val", "val_text"]

    def __init__(self, type_: str, name: str, val: Any, val_text: str) -> None:
        if val is None:
            raise ValueError("Constant must have non-None parameters")
        self.type = type_
        self.name = name.strip()
        self.val = val
        self.val_text = val_text

    def __eq__(self, other: object) -> bool:
        mine = (self.type, self.name, self.val)
        return isinstance(other, Constant) and mine == (other.type, other.name, other.val)

    __hash__ = None  # type: ignore[assignment]  # As in ROS: constants can be changed.

    def __repr__(self) -> str:
        return f"{self.type} {self.name}={self.val}"


class Field:
    """A field: its name, its type, and the parts of the type."""

    def __init__(self, name: str, type: str) -> None:
        self.name = name
        self.type = type
        self.base_type, self.is_array, self.array_len = parse_type(type)
        self.is_header = is_header_type(self.base_type)
        self.is_builtin = is_builtin(self.base_type)

    def __repr__(self) -> str:
        return f"[{self.name}, {self.type}, {self.base_type}, {self.is_array}, {self.array_len}]"


class MsgSpec:
    """The definition of a message.

    Args:
        types: the fields' types.
        names: the fields' names.
        constants: its constants.
        text: the definition.
        full_name: the message's type, with its package.
        short_name: that without the package.
        package: the package.

    Raises:
        MsgSpecException: two fields have the same name.
    """

    def __init__(
        self,
        types: Sequence[str],
        names: Sequence[str],
        constants: Iterable[Constant],
        text: str,
        full_name: str = "",
        short_name: str = "",
        package: str = "",
    ) -> None:
        if len(set(names)) != len(names):
            raise MsgSpecException(f"Duplicate field names in message: {names}")
        self.types = list(types)
        self.names = list(names)
        self.constants = list(constants)
        self.text = text
        self.full_name = full_name
        self.short_name = short_name
        self.package = package
        self.header_present = self.fields()[:1] in [[(each, "header")] for each in _HEADERS]
        self._parsed_fields = [Field(name, type_) for type_, name in self.fields()]

    def fields(self) -> list[tuple[str, str]]:
        """Return the fields, as pairs of type and name."""
        return list(zip(self.types, self.names, strict=True))

    def parsed_fields(self) -> list[Field]:
        """Return the fields."""
        return self._parsed_fields

    def has_header(self) -> bool:
        """Return whether the first field is a header of the name ``header``."""
        return self.header_present

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MsgSpec):
            return False
        mine = (self.types, self.names, self.constants, self.text)
        return mine == (other.types, other.names, other.constants, other.text)

    __hash__ = None  # type: ignore[assignment]  # As in ROS.

    def __repr__(self) -> str:
        parts = [self.constants] if self.constants else []
        return f"MsgSpec[{', '.join(map(repr, [*parts, self.types, self.names]))}]"


def load_from_string(
    text: str, package_context: str = "", full_name: str = "", short_name: str = ""
) -> MsgSpec:
    """Return the definition that a text has.

    Args:
        text: the content of a .msg file.
        package_context: the package of types that are named without one; empty to keep these so.
        full_name: the message's type, with its package.
        short_name: that without the package.

    Raises:
        MsgSpecException: the text is invalid.
    """
    try:
        definition = parse_message(text, package_context or "package", short_name or "Message")
    except DefinitionError as error:
        raise MsgSpecException(str(error)) from None
    lines = text.split("\n")
    types = []
    for field in definition.fields:
        type_ = lines[field.line - 1].split()[0]
        is_relative = SEP not in type_ and base_msg_type(type_) not in RESERVED_TYPES
        types.append(f"{package_context}{SEP}{type_}" if package_context and is_relative else type_)
    constants = [
        Constant(each.type, each.name, each.value, each.text) for each in definition.constants
    ]
    fields = [field.name for field in definition.fields]
    return MsgSpec(types, fields, constants, text, full_name, short_name, package_context)


def load_from_file(file_path: str, package_context: str = "") -> tuple[str, MsgSpec]:
    """Return the type that a .msg file defines, and its definition; as `load_from_string`.

    Raises:
        MsgSpecException: the file is invalid.
        OSError: it cannot be read.
    """
    short = Path(file_path).name.removesuffix(EXT)
    package = package_context.rstrip(SEP)
    type_ = names.resource_name(package, short)
    text = Path(file_path).read_text(encoding="utf-8")
    try:
        return type_, load_from_string(text, package, type_, short)
    except MsgSpecException as error:
        raise MsgSpecException(f"{file_path}: {error}") from None


def load_by_type(msgtype: str, package_context: str = "") -> tuple[str, MsgSpec]:
    """Return a type with its package, and its definition.

    Args:
        msgtype: the type.
        package_context: its package, if the type does not name it.

    Raises:
        MsgSpecException: it is unknown, or its definition is invalid.
    """
    package, short = names.package_resource_name(msgtype)
    package = package or package_context
    try:
        definition = default_interfaces().message(f"{package}/{short}")
    except InterfaceError as error:
        raise MsgSpecException(f"Cannot locate message type [{msgtype}]: {error}") from None
    return definition.type, load_from_string(definition.text, package, definition.type, short)


def list_msg_types(package: str, include_depends: bool = False) -> list[str]:
    """Return the names of a package's messages, without the package.

    Raises:
        MsgSpecException: the package is unknown.
    """
    try:
        types = default_interfaces().messages(package)
    except InterfaceError as error:
        raise MsgSpecException(str(error)) from None
    return [names.resource_name_base(each) for each in types]
