"""Definitions of messages as ROS 2 has them, for those here, which are ROS 1's, and back.

In ROS 2 a header has no ``seq``, times are messages, and field names are in lower case. Apart from
that, most standard messages are the same in both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, TypeAlias

from fibws.errors import InterfaceError, Ros2Error
from fibws.interfaces import builtin, full_text
from fibws.interfaces.catalogue import Definitions, TextDefinitions
from fibws.interfaces.definition import Constant, Field, MessageDefinition

Find: TypeAlias = Callable[[str], MessageDefinition]
"""Returns the definition of a message by its name; raises `InterfaceError`."""

_TIMES: Final = {
    "time": ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec"),
    "duration": ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec"),
}
"""The messages that ROS 2 has for times: their types and definitions."""
_TYPES: Final = {"char": "uint8"}


def ros2_fields(definition: MessageDefinition) -> tuple[Field, ...]:
    """Return the fields that a message has in ROS 2: a header has no ``seq``."""
    fields = definition.fields
    if definition.type == builtin.HEADER and fields[:1] == (Field("seq", "uint32"),):
        return fields[1:]
    return fields


class Ros2Definitions(TextDefinitions):
    """The definitions in a full text of ROS 2 (``ros2msg``), as ROS 1 would have them.

    A type that ROS 1 has with the same fields is ROS 1's: its header has a ``seq``, and its field
    names may have upper case.

    Args:
        name: the type, ``package/Type`` or ``package/msg/Type``.
        text: its definition, followed by those of the types nested in it.
        known: ROS 1's definitions.

    Raises:
        InterfaceError: the name or the text is invalid.
    """

    def __init__(self, name: str, text: str, known: Definitions) -> None:
        super().__init__(name, text)
        self._known = known

    def other_fields(self, name: str) -> Iterator[str]:
        """Say how the fields of a type, and of those in it, differ from ROS 1's types.

        Raises:
            InterfaceError: it is unknown, or invalid.
        """
        found: dict[str, MessageDefinition] = {}
        self._collect(self.message(name), found)
        for definition in found.values():
            known = self._of_ros1(definition.type)
            if known is not None and not _is_same(known, definition):
                yield f"{definition.type} {_difference(definition, known)}"

    def _collect(self, definition: MessageDefinition, found: dict[str, MessageDefinition]) -> None:
        found[definition.type] = definition
        for field in definition.fields:
            if field.is_nested and field.type not in found:
                self._collect(self.message(field.type), found)

    def _find_message(self, name: str) -> MessageDefinition:
        known, own = self._of_ros1(name), self.types.get(name)
        if known is not None and (own is None or _is_same(known, own)):
            return known
        return super()._find_message(name)

    def _of_ros1(self, name: str) -> MessageDefinition | None:
        try:
            return self._known.message(name)
        except InterfaceError:
            return None


def _is_same(one: MessageDefinition, other: MessageDefinition) -> bool:
    return _layout(one) == _layout(other)


def _layout(definition: MessageDefinition) -> list[tuple[str, str]]:
    """Return the names and types of the fields in ROS 2, without what does not change bytes."""
    return [(field.name.lower(), _type_of(field)) for field in ros2_fields(definition)]


def _type_of(field: Field) -> str:
    type_ = field.ros1_type if field.type != "wstring" else field.full_type
    return type_.replace("char", "uint8") if field.type == "char" else type_


def _difference(own: MessageDefinition, known: MessageDefinition) -> str:
    theirs, ours = dict(_layout(own)), dict(_layout(known))
    parts = []
    if more := theirs.keys() - ours.keys():
        parts.append(f"has {', '.join(sorted(more))} in ROS 2 only")
    if less := ours.keys() - theirs.keys():
        parts.append(f"has {', '.join(sorted(less))} in ROS 1 only")
    if changed := sorted(name for name in theirs.keys() & ours if theirs[name] != ours[name]):
        parts.append(f"has another type of {', '.join(changed)}")
    return " and ".join(parts) or "has its fields in another order"


def write_ros2_message(name: str, find: Find) -> str:
    """Return the full text of a message in ROS 2's language, ``ros2msg``.

    Raises:
        InterfaceError: it is unknown.
        Ros2Error: ROS 2 cannot have it.
    """
    parts: dict[str, str] = {}
    _write(find(name), find, parts)
    own = parts.pop(name)
    nested = [f"MSG: {each}\n{text}" for each, text in parts.items()]
    return f"\n{full_text.SEPARATOR}\n".join([own, *nested])


def _write(definition: MessageDefinition, find: Find, parts: dict[str, str]) -> None:
    """Add the text of a message, and those of all types in it."""
    fields = ros2_fields(definition)
    names = {field.name.lower() for field in fields}
    if len(names) < len(fields):
        raise Ros2Error(f"{definition.type}: fields differ in upper and lower case only")
    lines = [*map(_constant_line, definition.constants), *map(_field_line, fields)]
    parts[definition.type] = "\n".join(lines)
    for field in fields:
        if field.type in _TIMES:
            type_, text = _TIMES[field.type]
            parts.setdefault(type_, text)
        elif field.is_nested and field.type not in parts:
            _write(find(field.type), find, parts)


def _constant_line(constant: Constant) -> str:
    text = constant.text
    if constant.type == "string":
        text = '"{}"'.format(text.replace("\\", "\\\\").replace('"', '\\"'))
    return f"{_TYPES.get(constant.type, constant.type)} {constant.name}={text}"


def _field_line(field: Field) -> str:
    type_ = _TIMES[field.type][0] if field.type in _TIMES else _TYPES.get(field.type, field.type)
    limit = "" if field.limit is None else f"<={field.limit}"
    return f"{type_}{limit}{field.array or ''} {field.name.lower()}"
