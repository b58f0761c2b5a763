"""Values in definitions: constants, and the defaults of ROS 2, by rosidl's grammar."""

from __future__ import annotations

import re
from typing import Final

from fibws.interfaces import builtin
from fibws.interfaces.definition import Scalar

_NUMBER = re.compile(r"[-+.\w]+", re.ASCII)
_BOOLEANS: Final = {"true": True, "1": True, "false": False, "0": False}
_QUOTED = re.compile(r""" *(?:"((?:[^"]|(?<=\\)")*)(?<!\\)"|'((?:[^']|(?<=\\)')*)(?<!\\)') *""")
_PLAIN = re.compile(r" *([^,\"' ][^,]*)")


class LiteralError(ValueError):
    """A value is invalid; the text is the reason."""


def scalar(kind: str, text: str) -> Scalar:
    """Return the value of a builtin type that ``text`` spells; a string is the text itself.

    A ``byte`` above 127 is ROS 2's, in which it has no sign: it is the same byte in ROS 1.

    Raises:
        LiteralError: the text is no such value.
    """
    if kind in builtin.STRINGS:
        return text
    if kind == "bool":
        if text.lower() not in _BOOLEANS:
            raise LiteralError(f"{text[:40]!r} is not a bool")
        return _BOOLEANS[text.lower()]
    try:
        if not _NUMBER.fullmatch(text):
            raise ValueError  # it has digits or blanks that only Python reads
        if kind in builtin.FLOATS:
            return float(text)
        value = _integer(text)
    except ValueError:
        raise LiteralError(f"{text[:40]!r} is not a {kind}") from None
    low, high = builtin.INTEGERS[kind]
    if kind == "byte" and high < value < 256:
        return value - 256
    if not low <= value <= high:
        raise LiteralError(f"{text[:40]} is not in {low}..{high}")
    return value


def _integer(text: str) -> int:
    try:
        return int(text)  # ROS 1's 007
    except ValueError:
        return int(text, 0)  # ROS 2's 0x10, 0b11, 0o17


def unquoted(text: str) -> str:
    """Return the string that ROS 2 reads: without quotes around it, and escapes of these.

    Raises:
        LiteralError: a quote within it is not escaped.
    """
    if len(text) < 2 or text[0] != text[-1] or text[0] not in "\"'":
        return text
    found = _QUOTED.fullmatch(text)
    if found is None:
        raise LiteralError(f"a quote in {text[:40]} is not escaped with a backslash")
    return _content(found)


def elements(kind: str, text: str) -> list[str]:
    """Return the texts of an array's elements, strings without their quotes.

    Raises:
        LiteralError: the text is no array.
    """
    if not (text.startswith("[") and text.endswith("]") and len(text) > 1):
        raise LiteralError("the default of an array must be in brackets, such as [1, 2]")
    inner = text[1:-1]
    if kind not in builtin.STRINGS:
        return [each.strip(" ") for each in inner.split(",")] if inner else []
    found: list[str] = []
    place = 0
    while place < len(inner):
        quoted = _QUOTED.match(inner, place)
        element = quoted or _PLAIN.match(inner, place)
        end = element.end() if element is not None else place
        if element is None or (end < len(inner) and inner[end] != ","):
            raise LiteralError(f"expected strings with commas between them, got {text[:40]}")
        found.append(_content(quoted) if quoted is not None else element[1].strip(" "))
        place = end + 1
    return found


def _content(quoted: re.Match[str]) -> str:
    if quoted[1] is not None:
        return quoted[1].replace('\\"', '"')
    return quoted[2].replace("\\'", "'")
