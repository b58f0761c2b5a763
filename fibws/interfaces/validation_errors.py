"""Error texts for invalid messages, in the words of rosbridge_server.

The texts are those of its ``message_conversion.py``, which clients know, apart from "an int32".
Details that it does not give, such as the range of an integer, follow in parentheses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic_core import ErrorDetails, ValidationError

from fibws.errors import InvalidMessage
from fibws.interfaces import builtin, schema
from fibws.interfaces.definition import Field, MessageDefinition
from fibws.interfaces.md5sum import Lookup
from fibws.suggestions import suggestion

MOST_EXPLAINED = 1000
"""If there are more errors than this, finding the first one takes too long."""

LONGEST_PATH = 200
"""How many characters of an unknown field's name are shown."""


def explain(
    definition: MessageDefinition, lookup: Lookup, error: ValidationError
) -> InvalidMessage:
    """The error to raise for a message that pydantic_core refused."""
    count = error.error_count()
    if count > MOST_EXPLAINED:
        return InvalidMessage(f"Message type {definition.type} does not fit in {count} places")
    details = error.errors(include_url=False)
    # A part of a time may be missing, so this is never the reason.
    first = next((detail for detail in details if detail["type"] != "missing"), details[0])
    if not first["loc"]:
        found = type(first["input"]).__name__
        return InvalidMessage(
            f"Expected a JSON object for type {definition.type} but received a {found}"
        )
    return InvalidMessage(_describe(definition, lookup, first))


def _describe(definition: MessageDefinition, lookup: Lookup, detail: ErrorDetails) -> str:
    """Describe an error, following its path through the definitions."""
    path, expected, inside = "", definition.type, definition.type
    field: Field | None = None
    is_list = False
    for step in detail["loc"]:
        if inside in builtin.TIMES and str(step).startswith(schema.CHOICE):
            continue
        if is_list and field is not None:
            path, expected, is_list = f"{path}[{step}]", field.element_type, False
            continue
        path = f"{path}.{step}" if path else str(step)
        field = _field(definition, lookup, inside, step)
        if field is None:
            known = [member.name for member in _fields(definition, lookup, inside)]
            return (
                f"Message type {definition.type} does not have a field {path[:LONGEST_PATH]}"
                f"{suggestion(str(step)[:LONGEST_PATH], known)}"
            )
        expected, inside, is_list = field.full_type, field.type, field.array is not None
    found = type(detail["input"]).__name__
    reason = field and _reason(field, detail)
    because = f" ({reason})" if reason else ""
    return (
        f"{definition.type} message requires {_article(expected)} {expected} for field {path}, "
        f"but got {_article(found)} {found}{because}"
    )


def _article(name: str) -> str:
    """Return the article before a type: ``a uint8``, ``an int32``."""
    return "an" if name[0] in "aeio" else "a"


def _field(
    definition: MessageDefinition, lookup: Lookup, inside: str, name: str | int
) -> Field | None:
    """Look up a field of ``inside``, which is ``definition`` or a type nested in it."""
    if inside in builtin.TIMES:
        return Field(str(name), builtin.TIMES[inside])
    fields = _fields(definition, lookup, inside)
    return next((field for field in fields if field.name == name), None)


def _fields(definition: MessageDefinition, lookup: Lookup, inside: str) -> Sequence[Field]:
    return (definition if inside == definition.type else lookup(inside)).fields


def _reason(field: Field, detail: ErrorDetails) -> str | None:
    """Why a value of the right JSON type is invalid, if that is the error."""
    value: Any = detail["input"]
    match detail["type"]:
        case schema.FAULT:
            return detail["msg"]
        case "less_than_equal" | "greater_than_equal":
            low, high = builtin.INTEGERS[field.type]
            # Python refuses to print very long integers.
            shown = value if abs(value) < 2**128 else "this integer"
            return f"{shown} is not in {low}..{high}"
        case "too_short" | "too_long":
            assert field.array is not None
            if field.array.fixed is not None:
                return f"it has {len(value)} elements, not {field.array.size}"
            return f"it has {len(value)} elements, not at most {detail['ctx']['max_length']}"
        case "string_too_long":
            return f"it has {len(value)} characters, not at most {field.limit}"
        case "string_unicode":
            return "it contains a lone surrogate"
        case "float_type" if type(value) is int:
            return "it is too large"
    return None
