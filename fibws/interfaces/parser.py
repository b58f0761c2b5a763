"""Reads the text of .msg, .srv and .action files, in the spellings of ROS 1 and ROS 2.

The grammar is that of http://wiki.ros.org/msg as genmsg reads it, plus that of ROS 2: bounded
arrays and strings, ``wstring``, ``package/msg/Type`` and default values.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from fibws.errors import DefinitionError
from fibws.interfaces import builtin, literals
from fibws.interfaces.definition import (
    ActionDefinition,
    Array,
    Constant,
    Field,
    MessageDefinition,
    Scalar,
    ServiceDefinition,
)
from fibws.interfaces.literals import LiteralError

BLANKS = " \t\r\v\f"
"""The characters that are ignored between tokens. Programs differ on blanks beyond ASCII."""

# What stands before a comment; a # inside quotes (the default of a ROS 2 string) begins none.
_CODE = re.compile(r"""(?:[^#"']|"(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')*""")
_CONSTANT = re.compile(
    r"(?P<type>[\w/]+)(?P<limit><=\d+)?\s+(?P<name>\w+)\s*=(?P<value>.*)", re.ASCII
)
_FIELD = re.compile(
    r"(?P<type>[A-Za-z][\w/]*)(?:<=(?P<limit>\d{1,9}))?"
    r"(?P<array>\[(?P<bounded><=)?(?P<size>0|[1-9]\d{0,8})?\])?"
    r"\s+(?P<name>\w+)(?:\s+(?P<default>\S.*))?",
    re.ASCII,
)
_TYPE = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)?", re.ASCII)
_NAME = re.compile(r"[A-Za-z]\w*", re.ASCII)


def parse_message(
    text: str,
    package: str,
    name: str,
    source: str = "",
    first_line: int = 1,
    *,
    ros2: bool = False,
) -> MessageDefinition:
    """The message that ``text`` defines.

    Args:
        text: the content of a .msg file.
        package: where relative type names are looked for.
        name: the message's own, without its package.
        source: the file's name, for errors.
        first_line: the number of the text's first line in that file.
        ros2: whether the file is ROS 2's, in which quotes around a string constant are no part of
            it. A file that has defaults or bounds is one in any case.

    Raises:
        DefinitionError: a line does not parse, or has an invalid value.
    """
    source = source or f"{package}/{name}"
    fields: dict[str, Field] = {}
    constants: dict[str, Constant] = {}
    lines = text.split("\n")
    for index, raw in enumerate(lines):
        number = first_line + index
        try:
            member = _member(raw, package, number, ros2=ros2)
            if member is None:
                continue
            if member.name in fields or member.name in constants:
                raise _Fault(f"duplicate name {member.name}")
        except (_Fault, LiteralError) as fault:
            raise DefinitionError(source, number, raw[:200], str(fault)) from None
        if isinstance(member, Constant):
            constants[member.name] = member
        else:
            fields[member.name] = member
        lines[index] = _in_ros1(raw, member)
    if not ros2 and any(map(_is_ros2s, fields.values())):
        return parse_message(text, package, name, source, first_line, ros2=True)
    return MessageDefinition(
        package, name, tuple(fields.values()), tuple(constants.values()), "\n".join(lines), source
    )


def parse_service(
    text: str, package: str, name: str, source: str = "", *, ros2: bool = False
) -> ServiceDefinition:
    """Return the service that ``text``, the content of a .srv file, defines.

    Args:
        ros2: as in `parse_message`.

    Raises:
        DefinitionError: a line does not parse, or there are not two parts.
    """
    source = source or f"{package}/{name}"
    request, response = (
        parse_message(part, package, name + suffix, source, first_line, ros2=ros2)
        for suffix, (first_line, part) in zip(
            ("Request", "Response"), _parts(text, 2, source), strict=True
        )
    )
    return ServiceDefinition(package, name, request, response)


def parse_action(
    text: str, package: str, name: str, source: str = "", *, ros2: bool = False
) -> ActionDefinition:
    """Return the action that ``text``, the content of an .action file, defines.

    Args:
        ros2: as in `parse_message`.

    Raises:
        DefinitionError: a line does not parse, or there are not three parts.
    """
    source = source or f"{package}/{name}"
    goal, result, feedback = (
        parse_message(part, package, name + suffix, source, first_line, ros2=ros2)
        for suffix, (first_line, part) in zip(
            ("Goal", "Result", "Feedback"), _parts(text, 3, source), strict=True
        )
    )
    return ActionDefinition(package, name, goal, result, feedback)


def between(lines: list[str], separates: Callable[[str], bool]) -> Iterator[tuple[int, int]]:
    """Yield where each section between separator lines begins and ends."""
    cuts = [number for number, line in enumerate(lines) if separates(line)]
    return zip((0, *(cut + 1 for cut in cuts)), (*cuts, len(lines)), strict=True)


class _Fault(ValueError):
    """An error in a line; the caller knows the line's number and text."""


def _parts(text: str, count: int, source: str) -> Iterator[tuple[int, str]]:
    """The parts between lines of ``---``, each with the number of its first line."""
    lines = text.split("\n")
    parts = list(between(lines, lambda line: line.startswith("---")))
    if len(parts) != count:
        number = max(1, parts[min(count, len(parts) - 1)][0])
        # A line such as -- is likely meant to be one.
        meant = (at for at, line in enumerate(lines, 1) if line.strip() and not line.strip("- \t"))
        if len(parts) < count:
            number = next((at for at in meant if not lines[at - 1].startswith("---")), number)
        fault = f"expected {count - 1} line{'s' * (count > 2)} of ---, got {len(parts) - 1}"
        raise DefinitionError(source, number, lines[number - 1][:200], fault)
    for begin, end in parts:
        yield begin + 1, "\n".join(lines[begin:end])


def _is_ros2s(field: Field) -> bool:
    is_bounded = field.array is not None and field.array.bounded
    return field.default is not None or field.limit is not None or is_bounded


def _member(raw: str, package: str, number: int, *, ros2: bool) -> Field | Constant | None:
    """The field or the constant that a line declares, if any."""
    line = _CODE.match(raw)[0].strip(BLANKS)  # type: ignore[index]  # it matches the empty string
    rest = raw.strip(BLANKS)
    if not line and (not rest or rest.startswith("#")):
        return None
    if found := _CONSTANT.fullmatch(rest):
        return _constant(found, line, ros2=ros2)
    found = _FIELD.fullmatch(line)
    if found is None or len(line) < len(rest.partition("#")[0].rstrip(BLANKS)):
        raise _Fault("expected a field, such as int32 x, or a constant, such as int32 X=1")
    return _field(found, package, number)


def _constant(found: re.Match[str], line: str, *, ros2: bool) -> Constant:
    kind, name, text = found["type"], found["name"], found["value"].strip(BLANKS)
    _check_name(name)
    if kind not in builtin.CONSTANTS:
        raise _Fault(f"a constant cannot be of type {kind}")
    # A string's value is all that follows the =, a # included (http://wiki.ros.org/msg).
    is_string = kind in builtin.STRINGS
    if not is_string or ros2:
        text = line.partition("=")[2].strip(BLANKS)
    if is_string and ros2:
        rest = found["value"]
        is_open = len(text) < len(rest.partition("#")[0].strip(BLANKS))
        text = literals.unquoted(rest.partition("#")[0].strip(BLANKS) if is_open else text)
    if found["limit"] and kind not in builtin.STRINGS:
        raise _Fault(f"only strings can be bounded, not {kind}")
    value = literals.scalar(kind, text)
    # Foxglove cannot parse nan and inf, and would then read no topic of the hub.
    if kind in builtin.FLOATS and not re.search(r"\d", text):
        raise _Fault(f"a constant must be finite, such as {kind} {name}=1.5, got {text}")
    if kind in builtin.STRINGS:
        return Constant(name, "string", value, text)
    # ROS 1 knows neither 0x10 nor true, and no byte above 127.
    is_ros1s = text in ("True", "False") or not re.search("[a-df-zA-DF-Z_]", text)
    is_ros1s = is_ros1s and not (kind == "byte" and text.isdigit() and int(text) != value)
    return Constant(name, kind, value, text if is_ros1s else str(value))


def _field(found: re.Match[str], package: str, number: int) -> Field:
    kind, name = _type(found["type"], package), found["name"]
    _check_name(name)
    limit = int(found["limit"]) if found["limit"] else None
    if limit is not None and kind not in builtin.STRINGS:
        raise _Fault(f"only strings can be bounded, not {kind}")
    array = None
    if found["array"]:
        array = Array(int(found["size"]) if found["size"] else None, bool(found["bounded"]))
        if array.size is None and array.bounded:
            raise _Fault("the bound of the array is missing")
    member = Field(name, kind, array, limit, line=number)
    if found["default"] is None:
        return member
    return Field(name, kind, array, limit, _default(member, found["default"].strip(BLANKS)), number)


def _type(spelled: str, package: str) -> str:
    """``Point`` of geometry_msgs and ``geometry_msgs/msg/Point`` are geometry_msgs/Point."""
    first, slash, rest = spelled.partition("/msg/")
    name = f"{first}/{rest}" if slash else spelled
    if not _TYPE.fullmatch(name):
        raise _Fault(f"{spelled} is not a type")
    if name in builtin.NAMES:
        return name
    return builtin.ALIASES.get(name) or (name if "/" in name else f"{package}/{name}")


def _check_name(name: str) -> None:
    if not _NAME.fullmatch(name):
        raise _Fault(f"invalid name {name}: must begin with a letter")


def _default(field: Field, text: str) -> Scalar | tuple[Scalar, ...]:
    if field.type not in builtin.CONSTANTS:
        raise _Fault(f"{field.type} cannot have a default")
    if field.array is None:
        is_string = field.type in builtin.STRINGS
        value = literals.scalar(field.type, literals.unquoted(text) if is_string else text)
        _check_limit(field, value)
        return value
    values = literals.elements(field.type, text)
    size = field.array.size
    if size is not None and (len(values) > size or (len(values) < size and field.array.fixed)):
        raise _Fault(f"the default of {field.full_type} has {len(values)} elements")
    for value in values:
        _check_limit(field, value)
    return tuple(literals.scalar(field.type, value) for value in values)


def _check_limit(field: Field, value: Scalar) -> None:
    if field.limit is not None and isinstance(value, str) and len(value) > field.limit:
        raise _Fault(f"the default has more than {field.limit} characters")


def _in_ros1(raw: str, member: Field | Constant) -> str:
    """Return the line, or its spelling in ROS 1 if ROS 1 cannot read it."""
    if isinstance(member, Constant):
        spelled = raw.partition("=")[2]
        if member.type not in builtin.STRINGS:
            spelled = spelled.partition("#")[0]
        plain = re.match(rf"\s*{member.type}\s", raw) and spelled.strip(BLANKS) == member.text
        return raw if plain else f"{member.type} {member.name}={member.text}"
    field = member
    plain = (
        field.default is None
        and field.full_type == field.ros1_type
        and "/msg/" not in raw
        and not raw.lstrip().startswith("builtin_interfaces/")
    )
    return raw if plain else f"{field.ros1_type} {field.name}"
