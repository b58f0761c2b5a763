"""Finds the field with an invalid value; the error texts are genpy's."""

from __future__ import annotations

from operator import index
from typing import Any

from fibws.interfaces import Message as GraphMessage
from fibws.interfaces import builtin
from genpy.errors import SerializationError
from genpy.rostime import Duration, Time, TVal

_HEADERS = ("std_msgs/Header", "roslib/Header")
_TIMES: dict[str, type[TVal]] = {"time": Time, "duration": Duration}


def check_type(field_name: str, field_type: str, field_val: Any) -> None:
    """Check a value against the type of its field, recursively.

    Unlike in genpy, values that can be sent are valid: numpy's numbers and arrays, bools for
    numbers, and texts that are not in ASCII.

    Args:
        field_name: the field's name.
        field_type: its type, ``float64[36]``.
        field_val: the value.

    Raises:
        SerializationError: the value does not fit.
    """
    fault = _fault(field_name, field_type, field_val)
    if fault:
        raise SerializationError(f"field {fault}")


def _fault(name: str, type_: str, value: Any) -> str | None:
    if type_ in builtin.INTEGERS:
        return _integer_fault(name, type_, value)
    if type_ in builtin.FLOATS:
        fits = hasattr(value, "__float__") or hasattr(value, "__index__")
        return None if fits else f"{name} must be float type"
    if type_ == "bool":
        return None if _is_bool(value) else f"{name} is not a bool"
    if type_ in builtin.STRINGS:
        fits = isinstance(value, (bytes, str))
        return None if fits else f"{name} must be of type bytes or an ascii string"
    if type_ in _TIMES:
        kind = _TIMES[type_]
        return None if isinstance(value, kind) else f"{name} must be of type {kind.__name__}"
    if type_.endswith("]"):
        return _array_fault(name, type_[: type_.index("[")], value)
    return _message_fault(name, type_, value)


def _integer_fault(name: str, type_: str, value: Any) -> str | None:
    low, high = builtin.INTEGERS[type_]
    try:
        number = index(value)
    except TypeError:
        wanted = "unsigned integer type" if low == 0 else "an integer type"
        return f"{name} must be {wanted}"
    if low == 0 and number < 0:
        return f"{name} must be unsigned integer type"
    return None if low <= number <= high else f"{name} exceeds specified width [{type_}]"


def _is_bool(value: Any) -> bool:
    return type(value).__module__ == "numpy" or value in (True, False)


def _array_fault(name: str, type_: str, values: Any) -> str | None:
    if isinstance(values, (bytes, str)):
        if type_ in builtin.BYTES:
            return None
        return f"{name} must be a list or tuple type. Only uint8[] can be a string"
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, (bytearray, memoryview)) and type_ in builtin.BYTES:
        return None
    if not isinstance(values, (list, tuple)):
        return f"{name} must be a list or tuple type"
    faults = (_fault(f"{name}[]", type_, value) for value in values)
    return next((fault for fault in faults if fault), None)


def _message_fault(name: str, type_: str, value: Any) -> str | None:
    if not isinstance(value, GraphMessage):
        return f"{name} must be of type [{type_}]"
    if value._type in _HEADERS:
        if type_ not in ("Header", *_HEADERS):
            return f"{name} must be a Header instead of a {value._type}"
    elif value._type != type_:
        return f"{name} must be of type {type_} instead of {value._type}"
    message: Any = value
    for part, part_type in zip(message.__slots__, message._slot_types, strict=False):
        fault = _fault(f"{name}.{part}", part_type, getattr(message, part))
        if fault:
            return fault
    return None
