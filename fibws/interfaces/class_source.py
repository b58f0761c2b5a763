"""The source of the Python class of one message, service or action.

It is formatted as ruff does, so that a generated module may be checked in anywhere. This module and
all that it imports need only Python itself: packages of fibws are built where nothing else is.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import isfinite

from fibws.interfaces import builtin
from fibws.interfaces.definition import (
    ActionDefinition,
    Constant,
    Field,
    MessageDefinition,
    Scalar,
    ServiceDefinition,
)
from fibws.interfaces.python_names import python_name

LINE_LENGTH = 100


def message_class(definition: MessageDefinition, home: str | None) -> Iterator[str]:
    """The lines of a message's class.

    Args:
        definition: the message's.
        home: the package whose messages are in the same module, if it is one of messages; those
            of all others are named with their package.
    """
    yield "@dataclass(slots=True, eq=False, repr=False)"
    yield f"class {definition.name}(ros.Message):"
    yield f'    """{definition.type}"""'
    yield ""
    yield f'    _type: ClassVar[str] = "{definition.type}"'
    for constant in definition.constants:
        yield f"    {_constant(constant)}"
    if definition.fields:
        yield ""
    for field in definition.fields:
        line = f"    {_field(field, home)}"
        if len(line) > LINE_LENGTH:
            line = line.replace("= field(", "= field(\n        ")[:-1] + "\n    )"
        yield line


def service_class(definition: ServiceDefinition) -> Iterator[str]:
    """The lines of a service's class, whose messages are in the same module."""
    yield from _class_of_messages(
        definition,
        "Service",
        {"Request": definition.request.name, "Response": definition.response.name},
    )


def action_class(definition: ActionDefinition) -> Iterator[str]:
    """The lines of an action's class, whose messages are in fibws.msg."""
    yield from _class_of_messages(
        definition,
        "Action",
        {
            "Goal": f"{definition.package}.{definition.goal.name}",
            "Result": f"{definition.package}.{definition.result.name}",
            "Feedback": f"{definition.package}.{definition.feedback.name}",
        },
    )


def _class_of_messages(
    definition: ServiceDefinition | ActionDefinition, base: str, messages: dict[str, str]
) -> Iterator[str]:
    name, parameters = definition.name, ", ".join(messages.values())
    line, inner = f"class {name}(ros.{base}[{parameters}]):", f"    ros.{base}[{parameters}]"
    if len(line) <= LINE_LENGTH:
        yield line
    elif len(inner) <= LINE_LENGTH:
        yield from (f"class {name}(", inner, "):")
    else:
        yield from (f"class {name}(", f"    ros.{base}[")
        yield from (f"        {message}," for message in messages.values())
        yield from ("    ]", "):")
    yield f'    """{definition.type}"""'
    yield ""
    yield f'    _type = "{definition.type}"'
    # A plain assignment would do, but type checkers take no variable for a type.
    yield from (f"    {part}: TypeAlias = {message}" for part, message in messages.items())


def _constant(constant: Constant) -> str:
    annotation = type(constant.value).__name__
    return f"{python_name(constant.name)}: ClassVar[{annotation}] = {_literal(constant.value)}"


def _field(field: Field, home: str | None) -> str:
    name, element = python_name(field.name), _element(field, home)
    if field.is_bytes:
        return f"{name}: bytes = {_bytes(field)}"
    if field.array is not None:
        return f"{name}: list[{element}] = field(default_factory={_list(field, element)})"
    if field.type in builtin.CONSTANTS:
        return f"{name}: {element} = {_literal(field.default_value)}"
    # A lambda looks later, and in the module: in the class a member may have the nested class's
    # name, and another package may not be loaded yet if it imports this one.
    factory = f"lambda: {element}()" if field.is_nested else element
    return f"{name}: {element} = field(default_factory={factory})"


def _element(field: Field, home: str | None) -> str:
    """The Python type of the field, or of one element if it is an array."""
    if field.type in builtin.TIMES:
        return f"ros.{field.type.capitalize()}"
    if field.is_nested:
        package, _, name = field.type.partition("/")
        return name if package == home else f"{package}.{name}"
    return type(builtin.zero(field.type)).__name__


def _bytes(field: Field) -> str:
    if field.default is None:
        return f"bytes({field.fixed_size})" if field.fixed_size else 'b""'
    return f"bytes({list(field.default_elements)})"


def _list(field: Field, element: str) -> str:
    """Return the source of a function that makes the default list."""
    if field.default is not None:
        return f"lambda: [{', '.join(map(_literal, field.default_elements))}]"
    if not field.fixed_size:
        return "list"
    if field.type in builtin.CONSTANTS:
        return f"lambda: [{_literal(builtin.zero(field.type))}] * {field.fixed_size}"
    return f"lambda: [{element}() for _ in range({field.fixed_size})]"


def _literal(value: Scalar) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, float) and not isfinite(value):
        return f'float("{value}")'
    return repr(value)
