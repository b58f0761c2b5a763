"""Fills messages from lists and dicts, such as the YAML of a command line (YAMLCommandLine)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fibws.interfaces import Message as GraphMessage
from fibws.interfaces import builtin
from genpy.errors import MessageException
from genpy.lookup import get_message_class
from genpy.rostime import TVal

_NO_KEYS: dict[str, Any] = {}


def fill_message_args(
    msg: Any, msg_args: list[Any] | dict[str, Any] | None, keys: Mapping[str, Any] = _NO_KEYS
) -> None:
    """Set the fields of a message.

    Args:
        msg: the message.
        msg_args: the values of all fields in order; or a dict of some of them, or a list of that.
        keys: the values of words that may stand for a message or a time, such as ``now``.

    Raises:
        MessageException: too many or too few values, or one that does not fit its field.
        ValueError: ``msg_args`` is not a list or a dict, or ``msg`` is not a message.
    """
    args = [] if msg_args is None else msg_args
    if len(args) == 1 and isinstance(args, list) and isinstance(args[0], dict):
        args = args[0]
    _Filler(keys).fill(msg, args, "")


def get_printable_message_args(msg: Any, buff: Any = None, prefix: str = "") -> str:
    """Return the names of all fields, separated by spaces; nested ones as ``pose.x``."""
    text = " ".join(_names(msg, prefix))
    if buff is not None:
        buff.write(text)
        return str(buff.getvalue())
    return text


def _names(msg: Any, prefix: str) -> list[str]:
    names: list[str] = []
    for name in msg.__slots__:
        value = getattr(msg, name)
        is_nested = isinstance(value, GraphMessage)
        names += _names(value, f"{prefix}{name}.") if is_nested else [f"{prefix}{name}"]
    return names


class _Filler:
    """Fills messages; ``keys`` are the values of words."""

    def __init__(self, keys: Mapping[str, Any]) -> None:
        self._keys = keys

    def fill(self, msg: Any, args: Any, prefix: str) -> None:
        if not isinstance(msg, (GraphMessage, TVal)):
            raise ValueError(f"msg must be a Message instance: {msg}")
        names: list[str] = list(getattr(msg, "__slots__", ()))
        if isinstance(args, dict):
            for name, value in args.items():
                self._set(msg, name, "" if value is None else value, prefix)
            return
        if not isinstance(args, list):
            raise ValueError(f"invalid msg_args type: {args}")
        if len(args) != len(names):
            much = "many" if len(args) > len(names) else "few"
            start = "Too many" if much == "many" else "Not enough"
            raise MessageException(f"{start} arguments:\n * Given: {args}\n * Expected: {names}")
        for name, value in zip(names, args, strict=True):
            self._set(msg, name, value, prefix)

    def _set(self, msg: Any, name: str, value: Any, prefix: str) -> None:
        path = f"{prefix}{name}"
        if name not in msg.__slots__:
            raise MessageException(f"No field name [{path}]")
        now = getattr(msg, name)
        if isinstance(now, (GraphMessage, TVal)):
            setattr(msg, name, self._filled(now, value, f"{path}."))
        elif isinstance(now, list):
            setattr(msg, name, self._elements(msg, name, value, path))
        else:
            setattr(msg, name, value)

    def _filled(self, now: Any, value: Any, prefix: str) -> Any:
        """Return the message or the time of a field, filled with a value."""
        if isinstance(value, str):
            if value not in self._keys:
                raise MessageException(f"No key named [{value}]")
            return self._keys[value]
        if isinstance(now, TVal) and isinstance(value, int):
            return type(now).from_sec(value / 1e9)
        self.fill(now, value, prefix)
        return now

    def _elements(self, msg: Any, name: str, values: Any, path: str) -> Any:
        """Return the array for a field."""
        if not isinstance(values, (list, tuple)):
            kind = type(values).__name__
            raise MessageException(f"Field [{path}] must be a list or tuple instead of: {kind}")
        full_type = msg._slot_types[msg.__slots__.index(name)]
        type_, _, length = full_type.rstrip("]").partition("[")
        if length and len(values) != int(length):
            raise MessageException(
                f"Field [{path}] has incorrect number of elements: {len(values)} != {length}"
            )
        if type_ in builtin.CONSTANTS:
            return values
        element = get_message_class(type_)
        if element is None:
            raise MessageException(
                f"Cannot instantiate messages for field [{path}] : cannot load class {type_}"
            )
        return [self._element(element(), value, f"{path}.") for value in values]

    def _element(self, new: Any, value: Any, prefix: str) -> Any:
        if isinstance(new, TVal) and isinstance(value, int):
            return type(new).from_sec(value / 1e9)
        self.fill(new, value, prefix)
        return new
