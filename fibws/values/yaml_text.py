"""Texts as YAML: byte for byte what PyYAML writes for rostopic and genpy, mostly without it."""

from __future__ import annotations

import re
from collections.abc import Sequence

LONGEST_LINE = 80
"""Characters after which YAML breaks a line."""
_ESCAPES = {
    **{ord(character): f"\\{character}" for character in '"\\'},
    **dict(
        zip(b"\0\a\b\t\n\v\f\r\x1b\x85\xa0", (f"\\{each}" for each in "0abtnvfreN_"), strict=True)
    ),
    **{0x2028: "\\L", 0x2029: "\\P"},
}
_IN_NEED = re.compile(r"[^ !#-\[\]-~]")
_NEEDLESS = re.compile(r"[a-z_/][a-z0-9_/]*", re.IGNORECASE)
# What YAML 1.1 takes for something else than a text.
_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})


def quoted(what: str) -> str:
    """A text as YAML has it between double quotes, in ASCII; an empty one between single quotes."""
    if not what:
        return "''"
    line = f'"{_IN_NEED.sub(_escape, what)}"'
    if len(line) <= LONGEST_LINE:
        return line
    import yaml  # 25 ms, which only those pay who have lines to break

    dumped: str = yaml.safe_dump(what, default_style='"')
    return dumped.rstrip("\n")


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code in _ESCAPES:
        return _ESCAPES[code]
    if code < 0x100:
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code < 0x10000 else f"\\U{code:08X}"


def listed(what: Sequence[str], indent: str) -> str:
    """Several texts, a line each behind a line break, with quotation marks where YAML needs them.

    Args:
        what: the texts.
        indent: what each line begins with.
    """
    if all(_NEEDLESS.fullmatch(each) and each.lower() not in _WORDS for each in what):
        lines = [f"- {each}" for each in what]
    else:
        import yaml  # 25 ms, but its rules are many

        lines = yaml.safe_dump(list(what), default_flow_style=False).rstrip("\n").split("\n")
    return "".join(f"\n{indent}{line}" for line in lines)
