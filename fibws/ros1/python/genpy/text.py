"""Values as YAML: the ``str()`` of messages, and the output of rostopic."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from fibws.interfaces import Message as GraphMessage
from fibws.values.yaml_text import listed, quoted
from genpy.rostime import Time, TVal


def strify_message(
    val: Any,
    indent: str = "",
    time_offset: Time | None = None,
    current_time: object = None,
    field_filter: Callable[[Any], Iterable[str]] | None = None,
    fixed_numeric_width: int | None = None,
) -> str:
    """Return a value, such as a message, as YAML.

    Args:
        val: the value.
        indent: the start of each line; if it is not empty, a message begins with a line break.
        time_offset: print times as durations since then.
        current_time: has no effect.
        field_filter: returns the names of the fields of a message to print; None for all.
        fixed_numeric_width: number of characters of each number; None for its natural width.
    """
    return _Formatter(time_offset, field_filter, fixed_numeric_width).value(val, indent)


class _Formatter:
    """Formats values with the options of `strify_message`."""

    def __init__(
        self,
        time_offset: Time | None,
        field_filter: Callable[[Any], Iterable[str]] | None,
        width: int | None,
    ) -> None:
        self._time_offset = time_offset
        self._filter = field_filter
        self._width = width

    def value(self, val: Any, indent: str) -> str:
        kind = type(val)
        if kind in (int, float) and self._width is not None:
            return _fixed(val, self._width)
        if kind in (int, float, bool):
            return str(val)
        if isinstance(val, str):
            return quoted(val)
        if isinstance(val, TVal):
            return self._time(val, indent)
        if kind in (list, tuple):
            return self._array(val, indent)
        if isinstance(val, GraphMessage):
            return self._message(val, indent)
        return str(val)

    def _time(self, val: TVal, indent: str) -> str:
        if self._time_offset is not None and isinstance(val, Time):
            val = val - self._time_offset
        if self._width is None:
            return f"\n{indent}secs: {val.secs}\n{indent}nsecs: {val.nsecs:9d}"
        secs, nsecs = _fixed(val.secs, self._width), _fixed(val.nsecs, self._width)
        return f"\n{indent}secs: {secs}\n{indent}nsecs: {nsecs}"

    def _array(self, val: list[Any] | tuple[Any, ...], indent: str) -> str:
        if not val:
            return "[]"
        first = type(val[0])
        if first in (int, float) and self._width is not None:
            return f"[{', '.join(self.value(each, indent) for each in val)}]"
        if isinstance(val[0], str):
            return listed(val, indent)
        if first in (int, float, bool):
            return str(list(val))
        deeper = f"{indent}  "
        return "".join(f"\n{indent}- {self.value(each, deeper)}" for each in val)

    def _message(self, message: Any, indent: str) -> str:
        names = message.__slots__
        shown = names if self._filter is None else list(self._filter(message))
        lines = "\n".join(
            f"{indent}{name}: {self.value(_field(message, name, type_), f'  {indent}')}"
            for name, type_ in zip(names, message._slot_types, strict=False)
            if name in shown
        )
        return f"\n{lines}" if indent else lines


def _field(message: Any, name: str, type_: str) -> Any:
    """Return the value of a field; bytes as a list of numbers."""
    value = getattr(message, name)
    if "uint8[" not in type_:
        return value
    if isinstance(value, str):
        return [ord(each) for each in value]
    return list(value) if isinstance(value, bytes) else value


def _fixed(number: float, width: int) -> str:
    if isinstance(number, int):
        return f"{number:{width}d}"
    digits = f"{number:.{width}f}"
    return digits[: max(digits.find("."), width)]
