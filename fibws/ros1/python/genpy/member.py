"""One field of a message class: its default, and how its value is converted to JSON and back.

Scripts may assign all values that genpy packs: numpy's numbers for ints, ints for floats, lists,
tuples, arrays and other collections. They are converted for `MessageValidator.validate`; other
values are converted to something that validation refuses.
"""

from __future__ import annotations

import keyword
from array import array
from collections.abc import Callable, Collection, Iterable
from functools import partial
from math import nan
from operator import index
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from fibws.interfaces import base64text, builtin
from genpy.rostime import SECOND, Duration, Time

if TYPE_CHECKING:
    from fibws.interfaces.definition import Field
    from genpy.message import Message

Convert: TypeAlias = Callable[[Any], Any]

RESERVED = frozenset({*keyword.kwlist, "self"})
"""Names that fields cannot have in Python; these get a ``_`` at the end."""

_CODES = {
    **{"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"},
    **{"int64": "q", "uint64": "Q", "byte": "b", "char": "B"},
    **{"float32": "d", "float64": "d"},  # Validation rounds a float32.
}
"""The type codes of `array` for numbers; bools are in lists."""

_DTYPES = {"byte": "int8", "char": "uint8", "bool": "bool"}
"""The names of dtypes that differ from those of ROS."""


class Member(NamedTuple):
    """A field of a message class.

    ``attribute`` and ``name`` are its names in Python and in ROS, ``default`` makes its default.
    ``write`` converts its value to JSON; ``read`` converts a valid one back, and ``read_numpy``
    does so with numpy's arrays for arrays of numbers. ``nested`` is the class of the messages in
    it, if there are any.
    """

    attribute: str
    name: str
    default: Callable[[], Any]
    write: Convert
    read: Convert
    read_numpy: Convert
    nested: type[Message] | None


def make_member(field: Field, nested: type[Message] | None) -> Member:
    """Return the member for a field.

    Args:
        field: its definition.
        nested: the class of the messages in it, if there are any.
    """
    write, read = _element(field.type, nested)
    read_numpy = nested.from_dict_numpy if nested else read
    default: Callable[[], Any] = partial(_new, field, nested)
    if field.is_bytes:
        write, read = _write_bytes, base64text.decode
        read_numpy = read
    elif field.array is not None and (field.type in _CODES or field.type == "bool"):
        convert = partial(array, _CODES[field.type]) if field.type in _CODES else _bools
        write = partial(_write_numbers, convert)
        read = _READ_ALL.get(field.type, tuple)
        read_numpy = partial(_read_array, _DTYPES.get(field.type, field.type))
    elif field.array is not None:
        write, read = partial(_write_all, write), partial(_read_all, read)
        read_numpy = partial(_read_all, read_numpy)
    elif nested is not None or field.type in builtin.TIMES:
        default = _class_of(field, nested)
    return Member(attribute(field.name), field.name, default, write, read, read_numpy, nested)


def attribute(name: str) -> str:
    """Return the name of a field or a constant in Python."""
    return f"{name}_" if name in RESERVED else name


def _class_of(field: Field, nested: type[Message] | None) -> Callable[[], Any]:
    return nested or (Time if field.type == "time" else Duration)


def _new(field: Field, nested: type[Message] | None) -> Any:
    """Return the default of a field that is not a single message or time."""
    if field.array is None:
        return field.default_value
    if field.is_bytes:
        return bytes(map(int, field.default_elements)) if field.default else bytes(field.fixed_size)
    if nested is None and field.type not in builtin.TIMES:
        return list(field.default_elements)
    return [_class_of(field, nested)() for _ in range(field.fixed_size)]


def _element(type_: str, nested: type[Message] | None) -> tuple[Convert, Convert]:
    """Return how one value of the type is converted to JSON and back."""
    if nested is not None:
        return nested.dict_of, nested.from_dict
    return _ELEMENTS.get(type_, (_write_int, _same))


def is_array(values: object) -> bool:
    """Return whether genpy packs the value as an array: anything of a known length but a text."""
    return isinstance(values, Collection) and not isinstance(values, str)


def _same(value: Any) -> Any:
    return value


def refused(value: Any) -> Any:
    """Return a placeholder for a value that validation would accept although genpy does not.

    Validation shows the name of its class in the error.
    """
    return type(type(value).__name__, (), {})()


def _write_int(value: Any) -> Any:
    if type(value) is int:
        return value
    try:
        return int(index(value))
    except TypeError:
        return value


def _write_bool(value: Any) -> Any:
    """Return a bool; also for the numbers that fit into genpy's one byte for it."""
    if type(value) is bool:
        return value
    try:
        number = index(value)
    except TypeError:  # numpy's bools are not numbers
        return value.item() if hasattr(value, "item") else value
    return bool(number) if 0 <= number <= 255 else value


def _bools(values: Iterable[Any]) -> list[Any]:
    return [_write_bool(value) for value in values]


def _write_float(value: Any) -> Any:
    if type(value) is float:
        return value
    if not hasattr(value, "__float__") and not hasattr(value, "__index__"):
        return refused(value)
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return value


def _read_float(value: float | None) -> float:
    return nan if value is None else value


def _read_floats(values: list[float | None]) -> tuple[float, ...]:
    return tuple([nan if value is None else value for value in values])


def _write_text(value: Any) -> Any:
    return str(value) if isinstance(value, str) else value


def _write_time(value: Any) -> Any:
    try:
        return {"secs": _write_int(value.secs), "nsecs": _write_int(value.nsecs)}
    except AttributeError:
        return refused(value)


def _read_time(kind: type[Time | Duration], value: dict[str, int]) -> Time | Duration:
    time = kind.__new__(kind)
    time.secs, time.nsecs = value["secs"], value["nsecs"]
    if time.nsecs >= SECOND or time.nsecs < 0:
        time.canon()
    return time


def _write_bytes(value: Any) -> Any:
    """Return bytes as base64; also those in a list, a tuple or an array of small integers."""
    try:
        data = bytes(value if isinstance(value, (list, tuple)) else _view(value))
    except (TypeError, ValueError):
        return value if isinstance(value, (list, tuple)) else refused(value)
    return base64text.encode(data)


def _view(value: Any) -> memoryview:
    view = memoryview(value)
    if view.format not in ("B", "c"):
        raise TypeError("the bytes of other arrays are not their elements")
    return view


def _write_numbers(convert: Callable[[Iterable[Any]], array[Any] | list[Any]], values: Any) -> Any:
    """Return an array of numbers as a list; ``convert`` makes numbers of the field's type."""
    if hasattr(values, "tolist"):
        values = values.tolist()
    if not is_array(values):
        return refused(values)
    # A list, because `array` takes bytes for the memory of its elements.
    numbers = list(values)
    try:
        return list(convert(numbers))
    except (TypeError, ValueError, OverflowError):
        return [refused(value) if value is None else value for value in numbers]


def _read_array(dtype: str, values: list[Any]) -> Any:
    import numpy

    return numpy.array(values, dtype=dtype)


def _write_all(write: Convert, values: Any) -> Any:
    if not is_array(values):
        return refused(values)
    return [write(value) for value in values]


def _read_all(read: Convert, values: list[Any]) -> list[Any]:
    return [read(value) for value in values]


_ELEMENTS: dict[str, tuple[Convert, Convert]] = {
    "bool": (_write_bool, _same),
    "string": (_write_text, _same),
    "wstring": (_write_text, _same),
    "float32": (_write_float, _read_float),
    "float64": (_write_float, _read_float),
    "time": (_write_time, partial(_read_time, Time)),
    "duration": (_write_time, partial(_read_time, Duration)),
}
"""How a value of a builtin type that is not an integer is converted to JSON and back."""

_READ_ALL: dict[str, Convert] = {
    "bool": list,
    "float32": _read_floats,
    "float64": _read_floats,
}
"""How an array of numbers that are not integers is converted from JSON."""
