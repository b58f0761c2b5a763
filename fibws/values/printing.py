"""Messages as text: the YAML that rostopic prints, byte for byte."""

from __future__ import annotations

from binascii import a2b_base64
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from fibws.values.typedefs import BYTES, FLOATS, STRINGS, TIMES, Field, Typedefs
from fibws.values.yaml_text import listed, quoted


class Style(NamedTuple):
    """How values are printed.

    ``noarr`` and ``nostr`` print what stands for arrays and texts, as does rostopic. ``width`` is
    the characters that numbers have, and None for as many as it takes. ``offset`` is nanoseconds
    since 1970 which times are counted from.
    """

    noarr: bool = False
    nostr: bool = False
    width: int | None = None
    offset: int | None = None


PLAIN = Style()


def text(
    message: Mapping[str, Any],
    typedefs: Typedefs,
    *,
    noarr: bool = False,
    nostr: bool = False,
    indent: int = 0,
) -> str:
    """A message as YAML, with no line break at its end.

    Args:
        message: it, as the hub's JSON has it; what is left out is printed with its default.
        typedefs: those of its type; where that is not known, by what its values look like.
        noarr: print the lengths of arrays only.
        nostr: print the lengths of texts only.
        indent: the spaces that each line begins with.
    """
    lines = value(message, Field("", typedefs.root), typedefs, Style(noarr, nostr))
    if not indent:
        return lines
    return "\n".join(" " * indent + line for line in lines.split("\n"))


def value(what: Any, field: Field, typedefs: Typedefs, style: Style = PLAIN) -> str:
    """Any value of a field as YAML, as `text`."""
    return _Printing(typedefs, style).value(what, field, "", shorten=True)


def elements(what: Any, field: Field) -> Sequence[Any]:
    """What is in an array; bytes come as base64."""
    if field.type in BYTES and isinstance(what, str):
        return list(a2b_base64(what))
    return what if isinstance(what, list) else []


class _Printing:
    """One way to print the values of one type."""

    def __init__(self, typedefs: Typedefs, style: Style) -> None:
        self._typedefs = typedefs
        self._style = style

    def value(self, what: Any, field: Field, indent: str, *, shorten: bool) -> str:
        """A value; if it takes lines of its own, it begins with a line break, but for the first.

        Args:
            shorten: whether texts and arrays are told by their lengths, where that is asked for:
                rostopic leaves those of messages in arrays.
        """
        if field.length is not None:
            return self._array(what, field, indent, shorten=shorten)
        if field.type in TIMES:
            return self._time(what, field.type, indent)
        if field.type in self._typedefs:
            fields: Iterable[Field] = self._typedefs.fields(field.type)
            return self._message(what, fields, indent, shorten=shorten)
        if field.type in STRINGS:
            if shorten and self._style.nostr:
                return quoted(f"<string length: {len(what)}>")
            return quoted(str(what))
        if isinstance(what, Mapping):  # Nobody has defined it, so it is printed by its looks.
            fields = [_guess(*each) for each in what.items()]
            return self._message(what, fields, indent, shorten=shorten)
        return self._scalar(what, field.type)

    def _message(
        self, message: Mapping[str, Any], fields: Iterable[Field], indent: str, *, shorten: bool
    ) -> str:
        deeper = indent + "  "
        lines = "\n".join(
            f"{indent}{each.name}: "
            f"{self.value(self._part(message, each), each, deeper, shorten=shorten)}"
            for each in fields
        )
        return f"\n{lines}" if indent else lines

    def _part(self, message: Mapping[str, Any], field: Field) -> Any:
        return message[field.name] if field.name in message else self._typedefs.default(field)

    def _time(self, time: Mapping[str, int], type_: str, indent: str) -> str:
        secs, nsecs = time.get("secs", 0), time.get("nsecs", 0)
        if type_ == "time" and self._style.offset is not None:
            secs, nsecs = divmod(secs * 10**9 + nsecs - self._style.offset, 10**9)
        width = self._style.width
        if width is None:
            return f"\n{indent}secs: {secs}\n{indent}nsecs: {nsecs:9d}"
        return f"\n{indent}secs: {secs:{width}d}\n{indent}nsecs: {nsecs:{width}d}"

    def _array(self, what: Any, field: Field, indent: str, *, shorten: bool) -> str:
        found = elements(what, field)
        if shorten and (self._style.noarr or (self._style.nostr and field.type in STRINGS)):
            return quoted(f"<array type: {field.type}, length: {len(found)}>")
        if not found:
            return "[]"
        if field.type in STRINGS:
            return listed(found, indent)
        element = Field("", field.type)
        if field.type in self._typedefs or field.type in TIMES or isinstance(found[0], Mapping):
            return "".join(
                f"\n{indent}- {self.value(each, element, indent + '  ', shorten=False)}"
                for each in found
            )
        if self._style.width is None and None not in found:
            return str(found)  # An image has millions.
        return f"[{', '.join(self._scalar(each, field.type) for each in found)}]"

    def _scalar(self, what: Any, type_: str) -> str:
        if type_ in FLOATS:
            what = float("nan") if what is None else float(what)
        elif type_ == "bool":
            what = bool(what)
        elif what is None:
            return "null"
        width = self._style.width
        if width is None or not isinstance(what, int | float) or isinstance(what, bool):
            return str(what)
        if isinstance(what, int):
            return f"{what:{width}d}"
        digits = f"{what:.{width}f}"
        return digits[: max(digits.find("."), width)]


def _guess(name: str, what: Any) -> Field:
    if isinstance(what, list):
        return Field(name, "string" if what and isinstance(what[0], str) else "unknown", 0)
    return Field(name, "string" if isinstance(what, str) else "unknown")
