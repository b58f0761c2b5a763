"""The pydantic_core schemas of builtin types and arrays.

pydantic_core checks the ordinary values by itself. Python functions take part only where ROS has a
rule of its own: float32's rounding, byte strings, and times that are relative to now.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from math import nan
from struct import Struct, pack, unpack
from struct import error as StructError
from typing import Any, Final, TypeAlias

from pydantic_core import PydanticCustomError, SchemaValidator, core_schema

from fibws.interfaces import base64text, builtin
from fibws.interfaces.definition import Array, Field

Stamp: TypeAlias = Callable[[], dict[str, int]]
"""Returns a time as a new object ``{"secs": .., "nsecs": ..}``."""

FAULT: Final = "fibws"
"""The type of the errors that these functions raise; the text is the reason."""
CHOICE: Final = "#"
"""Prefix of the steps in an error's path that only choose between schemas."""
TIME_PARTS: Final[dict[str, list[list[str | int]]]] = {
    "secs": [["secs"], ["sec"]],
    "nsecs": [["nsecs"], ["nanosec"], ["nsec"]],
}
"""The parts of a time, with all accepted spellings."""

_FLOAT32 = Struct("<f")
_pack, _unpack = _FLOAT32.pack, _FLOAT32.unpack


def scalar_schema(field: Field, *, lenient: bool, rounded: bool = True) -> core_schema.CoreSchema:
    """The schema of one value of a field that is neither a time nor a message.

    Args:
        rounded: whether to round a float32, which `rounded_columns` does otherwise.
        lenient: whether to take numbers as clients write them whose language has one kind of
            number: 5.0 for an integer, "NaN" and "Infinity", and decimal strings for int64 and
            uint64, of which JavaScript's numbers hold but a part.
    """
    if field.type in builtin.INTEGERS:
        low, high = builtin.INTEGERS[field.type]
        integer: core_schema.CoreSchema = core_schema.int_schema(strict=True, ge=low, le=high)
        return _before(_WHOLE.get(field.type, _whole), integer) if lenient else integer
    if field.type in builtin.STRINGS:
        # The minimum makes pydantic_core look at the characters: lone surrogates cannot be sent.
        return core_schema.str_schema(strict=True, min_length=0, max_length=field.limit)
    if field.type == "bool":
        return core_schema.bool_schema(strict=True)
    schema: core_schema.CoreSchema = core_schema.float_schema(strict=True)
    if field.type == "float32" and rounded:
        schema = core_schema.no_info_after_validator_function(_round, schema)
    schema = core_schema.nullable_schema(schema)
    return _before(_number, schema) if lenient else schema


def array_schema(
    field: Field, element: core_schema.CoreSchema, *, lenient: bool
) -> core_schema.CoreSchema:
    """The schema of an array; ``lenient`` as in `scalar_schema`."""
    assert field.array is not None
    if field.is_bytes:
        return core_schema.no_info_plain_validator_function(_bytes_reader(element, field.array))
    if field.type == "float32":
        floats: core_schema.CoreSchema = core_schema.nullable_schema(
            core_schema.float_schema(strict=True)
        )
        if lenient:
            floats = _before(_number, floats)
        return core_schema.no_info_after_validator_function(
            _round_all, _list_of(floats, field.array)
        )
    return _list_of(element, field.array)


def rounded_columns(
    names: Sequence[str], elements: core_schema.CoreSchema, exact: core_schema.CoreSchema
) -> core_schema.CoreSchema:
    """The schema of an array of messages whose float32 fields are rounded together.

    To round the coordinates of a cloud one by one would take most of its time.

    Args:
        names: the float32 fields.
        elements: the schema of the array without rounding.
        exact: the schema with it, which names a value that does not fit.
    """
    one_by_one = SchemaValidator(exact)

    def round_(messages: list[dict[str, Any]]) -> list[dict[str, Any]]:
        layout = f"<{len(messages)}f"
        for name in names:
            column = [message[name] for message in messages]
            try:
                rounded = unpack(layout, pack(layout, *column))
            except (StructError, OverflowError):  # null, or a value that is too large
                valid: list[dict[str, Any]] = one_by_one.validate_python(messages)
                return valid
            for message, value in zip(messages, rounded, strict=True):
                message[name] = value
        return messages

    return core_schema.no_info_after_validator_function(round_, elements)


def time_schema(
    kind: str, base: Stamp, now: Stamp | None, *, lenient: bool
) -> core_schema.CoreSchema:
    """The schema of ``time`` or ``duration``: an object of secs and nsecs, or null.

    Args:
        kind: ``time`` or ``duration``.
        base: returns the values of the object's missing parts, which are both for null.
        now: returns the value of the word "now"; None if that word is invalid.
        lenient: as in `scalar_schema`.
    """
    partial = SchemaValidator(_secs_and_nsecs(kind, required=False, lenient=lenient))

    def complete(value: object) -> dict[str, int]:
        if now is not None and isinstance(value, str) and value == "now":
            return now()
        if value is None:
            return base()
        given: dict[str, int] = partial.validate_python(value)
        return base() | given

    return core_schema.union_schema(
        [
            (_secs_and_nsecs(kind, required=True, lenient=lenient), f"{CHOICE}whole"),
            (core_schema.no_info_plain_validator_function(complete), f"{CHOICE}partial"),
        ],
        mode="left_to_right",
    )


def zero_time() -> dict[str, int]:
    """The default of a time or a duration."""
    return {"secs": 0, "nsecs": 0}


def _secs_and_nsecs(kind: str, *, required: bool, lenient: bool) -> core_schema.CoreSchema:
    """The schema of an object with both parts, as ROS 1, ROS 2 or older clients spell them."""
    low, high = builtin.INTEGERS[builtin.TIMES[kind]]
    part: core_schema.CoreSchema = core_schema.int_schema(strict=True, ge=low, le=high)
    if lenient:
        part = _before(_whole, part)
    return core_schema.typed_dict_schema(
        {
            name: core_schema.typed_dict_field(part, required=required, validation_alias=spellings)
            for name, spellings in TIME_PARTS.items()
        },
        extra_behavior="ignore",
        strict=True,
    )


def _list_of(element: core_schema.CoreSchema, array: Array) -> core_schema.ListSchema:
    # Stop at the first error: a list of a million must not make a million errors.
    return core_schema.list_schema(
        element, min_length=array.fixed, max_length=array.size, strict=True, fail_fast=True
    )


def _bytes_reader(element: core_schema.CoreSchema, array: Array) -> Callable[[object], str]:
    """Convert base64, a list of integers, or bytes (from CBOR) to canonical base64."""
    numbers = SchemaValidator(_list_of(element, Array()))

    def read(value: object) -> str:
        if isinstance(value, str):
            try:
                text, size = base64text.canonical(value)
            except ValueError as error:
                raise fault(f"bad base64: {error}") from None
        else:
            is_bytes = isinstance(value, (bytes, bytearray))
            elements: Any = value if is_bytes else numbers.validate_python(value)
            size, text = len(elements), base64text.encode(bytes(elements))
        if size < (array.fixed or 0) or (array.size is not None and size > array.size):
            most = "" if array.fixed else "at most "
            raise fault(f"it has {size} elements, not {most}{array.size}")
        return text

    return read


def _before(
    convert: Callable[[Any], Any], schema: core_schema.CoreSchema
) -> core_schema.CoreSchema:
    return core_schema.no_info_before_validator_function(convert, schema)


def _whole(value: Any) -> Any:
    """Return an integer for a float without a fraction; any other value as it is."""
    return int(value) if type(value) is float and value.is_integer() else value


def _whole_or_digits(value: Any) -> Any:
    """Return an integer for a decimal string, too."""
    return int(value) if type(value) is str and _DIGITS.fullmatch(value) else _whole(value)


_DIGITS = re.compile(r"-?\d{1,20}", re.ASCII)
_WHOLE: Final = {"int64": _whole_or_digits, "uint64": _whole_or_digits}


def _number(value: Any) -> Any:
    """Return the float that a string names as JavaScript does; any other value as it is."""
    return _NAMED_FLOATS.get(value, value) if type(value) is str else value


_NAMED_FLOATS: Final = {name: float(name) for name in ("NaN", "Infinity", "-Infinity")}


def _round(value: float) -> float:
    """Round to a float32."""
    try:
        rounded: float = _unpack(_pack(value))[0]
    except OverflowError:
        raise fault(f"{value!r} does not fit a float32") from None
    return rounded


def _round_all(values: list[float | None]) -> list[float]:
    layout = f"<{len(values)}f"
    try:
        return list(unpack(layout, pack(layout, *values)))
    except StructError:  # a None among them
        return _round_all([nan if value is None else value for value in values])
    except OverflowError:
        # Rounding them one by one finds the value to name.
        return [_round(nan if value is None else value) for value in values]


def fault(reason: str) -> PydanticCustomError:
    """An error with the text ``reason``, which may contain any characters."""
    return PydanticCustomError(FAULT, "{reason}", {"reason": reason})
