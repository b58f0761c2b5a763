"""YAML text of messages, byte for byte as rostopic and genpy print it, mostly without PyYAML."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from fibws.values.typedefs import FLOATS, STRINGS, TIMES, TypedefField, Typedefs

MAX_LINE = 80
"""Number of characters after which YAML breaks a line."""


class Style(NamedTuple):
    """How values are printed, as by rostopic echo."""

    noarr: bool = False
    """Print the lengths of arrays only."""
    nostr: bool = False
    """Print the lengths of strings only."""
    width: int | None = None
    """The width of numbers, in characters; None prints them in full."""
    offset: int | None = None
    """A time in nanoseconds since 1970 that is subtracted from times."""


PLAIN = Style()


def message_text(message: Mapping[str, Any], typedefs: Typedefs) -> str:
    """Return a message as YAML, without a line break at the end.

    Args:
        message: a message as in the hub's JSON; missing fields are printed with their defaults.
        typedefs: the definition of its type; an unknown type is guessed from the values.
    """
    return value_text(message, TypedefField("", typedefs.root), typedefs)


def value_text(value: Any, field: TypedefField, typedefs: Typedefs, style: Style = PLAIN) -> str:
    """Return the value of a field as YAML; see `message_text`."""
    return _Printer(typedefs, style).value(value, field, "", shorten=True)


class _Printer:
    """Prints values of one type in one style."""

    def __init__(self, typedefs: Typedefs, style: Style) -> None:
        self._typedefs = typedefs
        self._style = style

    def value(self, value: Any, field: TypedefField, indent: str, *, shorten: bool) -> str:
        """Return a value; an indented one of several lines begins with a line break.

        Args:
            shorten: obey the style's ``noarr`` and ``nostr``: rostopic ignores them in arrays of
                messages.
        """
        if field.length is not None:
            return self._array(value, field, indent, shorten=shorten)
        if field.type in TIMES:
            return self._time(value, field.type, indent)
        if field.type in self._typedefs:
            fields: Iterable[TypedefField] = self._typedefs.fields(field.type)
            return self._message(value, fields, indent, shorten=shorten)
        if field.type in STRINGS:
            if shorten and self._style.nostr:
                return quoted(f"<string length: {len(value)}>")
            return quoted(str(value))
        if isinstance(value, Mapping):  # Its type is unknown.
            fields = [_guess(name, each) for name, each in value.items()]
            return self._message(value, fields, indent, shorten=shorten)
        return self._scalar(value, field.type)

    def _message(
        self,
        message: Mapping[str, Any],
        fields: Iterable[TypedefField],
        indent: str,
        *,
        shorten: bool,
    ) -> str:
        texts = []
        for field in fields:
            is_given = field.name in message
            value = message[field.name] if is_given else self._typedefs.default(field)
            texts.append((field.name, self.value(value, field, indent + "  ", shorten=shorten)))
        return fields_text(texts, indent)

    def _time(self, time: Mapping[str, int], type_: str, indent: str) -> str:
        secs, nsecs = time.get("secs", 0), time.get("nsecs", 0)
        if type_ == "time" and self._style.offset is not None:
            secs, nsecs = divmod(secs * 10**9 + nsecs - self._style.offset, 10**9)
        return time_text(secs, nsecs, indent, self._style.width)

    def _array(self, value: Any, field: TypedefField, indent: str, *, shorten: bool) -> str:
        found = field.elements(value)
        if shorten and (self._style.noarr or (self._style.nostr and field.type in STRINGS)):
            return quoted(f"<array type: {field.type}, length: {len(found)}>")
        if not found:
            return "[]"
        if field.type in STRINGS:
            return listed(found, indent)
        if field.type in self._typedefs or field.type in TIMES or isinstance(found[0], Mapping):
            element, deeper = TypedefField("", field.type), indent + "  "
            return array_text(
                (self.value(each, element, deeper, shorten=False) for each in found), indent
            )
        if self._style.width is None and None not in found:
            return str(found)  # Fast: images have millions of elements.
        return f"[{', '.join(self._scalar(each, field.type) for each in found)}]"

    def _scalar(self, value: Any, type_: str) -> str:
        if type_ in FLOATS:
            value = float("nan") if value is None else float(value)
        elif type_ == "bool":
            value = bool(value)
        elif value is None:
            return "null"
        return number_text(value, self._style.width)


def _guess(name: str, value: Any) -> TypedefField:
    """Return a field of an unknown type."""
    if isinstance(value, list):
        return TypedefField(name, "string" if value and isinstance(value[0], str) else "unknown", 0)
    return TypedefField(name, "string" if isinstance(value, str) else "unknown")


def fields_text(fields: Iterable[tuple[str, str]], indent: str) -> str:
    """Return the lines of a message, given the names and the texts of its fields.

    An indented message begins with a line break.
    """
    lines = "\n".join(f"{indent}{name}: {text}" for name, text in fields)
    return f"\n{lines}" if indent else lines


def array_text(elements: Iterable[str], indent: str) -> str:
    """Return the lines of an array, given the texts of its elements, which are several lines."""
    return "".join(f"\n{indent}- {element}" for element in elements)


def time_text(secs: int, nsecs: int, indent: str, width: int | None) -> str:
    """Return the lines of a time or a duration."""
    if width is None:
        return f"\n{indent}secs: {secs}\n{indent}nsecs: {nsecs:9d}"
    return f"\n{indent}secs: {secs:{width}d}\n{indent}nsecs: {nsecs:{width}d}"


def number_text(value: Any, width: int | None) -> str:
    """Return a number, a bool or anything else that is printed in one line."""
    if width is None or not isinstance(value, int | float) or isinstance(value, bool):
        return str(value)
    if isinstance(value, int):
        return f"{value:{width}d}"
    digits = f"{value:.{width}f}"
    return digits[: max(digits.find("."), width)]


_ESCAPES = {
    **{ord(character): f"\\{character}" for character in '"\\'},
    **dict(
        zip(b"\0\a\b\t\n\v\f\r\x1b\x85\xa0", (f"\\{each}" for each in "0abtnvfreN_"), strict=True)
    ),
    **{0x2028: "\\L", 0x2029: "\\P"},
}
_SPECIAL = re.compile(r"[^ !#-\[\]-~]")
_UNQUOTED = re.compile(r"[a-z_/][a-z0-9_/]*", re.IGNORECASE)
_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})
"""Words that YAML 1.1 does not take for strings."""


def quoted(string: str) -> str:
    """Return a string in double quotes, in ASCII; an empty one in single quotes."""
    if not string:
        return "''"
    line = f'"{_SPECIAL.sub(_escape, string)}"'
    if len(line) <= MAX_LINE:
        return line
    import yaml  # 25 ms, which only long strings need

    dumped: str = yaml.safe_dump(string, default_style='"')
    return dumped.rstrip("\n")


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code in _ESCAPES:
        return _ESCAPES[code]
    if code < 0x100:
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code < 0x10000 else f"\\U{code:08X}"


def listed(strings: Sequence[str], indent: str) -> str:
    """Return a line for each string, quoted where YAML needs it; begin with a line break."""
    if all(_UNQUOTED.fullmatch(each) and each.lower() not in _WORDS for each in strings):
        lines = [f"- {each}" for each in strings]
    else:
        import yaml  # 25 ms

        lines = yaml.safe_dump(list(strings), default_flow_style=False).rstrip("\n").split("\n")
    return "".join(f"\n{indent}{line}" for line in lines)
