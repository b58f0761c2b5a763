"""Printing lines, JSON and tables.

Text in messages may come from anybody. A terminal would act on its control characters, so they are
escaped, in a pipe as well: its other end may be a terminal, too.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Sequence

import click

_BIDIRECTIONAL = "\u200e\u200f\u202a-\u202e\u2066-\u2069"
_CONTROL = re.compile(f"[\x00-\x1f\x7f-\x9f{_BIDIRECTIONAL}]")
"""Control characters: C0 with escape, C1 with CSI, and changes of the text's direction."""


def is_terminal() -> bool:
    """Return whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def has_control_sequences() -> bool:
    """Return whether the output supports control sequences; pipes and dumb terminals do not."""
    is_dumb = os.environ.get("TERM", "dumb") == "dumb" and sys.platform != "win32"
    return is_terminal() and not is_dumb


def has_colours() -> bool:
    """Return whether the output may have colours: a terminal without $NO_COLOR."""
    context = click.get_current_context(silent=True)
    is_off = context is not None and context.find_root().color is False
    return has_control_sequences() and not is_off


def encoding() -> str:
    """Return the encoding of the output; UTF-8 if there is none."""
    return getattr(sys.stdout, "encoding", None) or "utf-8"


def can_show(text: str) -> bool:
    """Return whether the encoding of the output has these characters."""
    try:
        text.encode(encoding())
    except UnicodeEncodeError:
        return False
    return True


def visible(text: str, keep: str = "\n\t") -> str:
    """Return a text with its control characters escaped, as in ``\\x1b``.

    Args:
        keep: control characters that are not escaped.
    """
    return _CONTROL.sub(lambda found: found[0] if found[0] in keep else ascii(found[0])[1:-1], text)


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: ``1 node``, ``2 nodes``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def line(text: str = "", *, colour: str | None = None, bold: bool = False) -> None:
    """Print one or more lines without delay, with control characters escaped.

    Args:
        colour: click's name of a colour, for terminals only.
        bold: whether to print bold, on terminals only.
    """
    text = visible(text)
    text = text.encode(encoding(), "backslashreplace").decode(encoding())
    if has_colours() and (colour or bold):
        text = click.style(text, fg=colour, bold=bold or None)
    # Without color=True, click would remove what looks like a style.
    click.echo(text, color=True)


def line_as_is(text: str, is_error: bool) -> None:
    """Print a line of a program as it is, with escape sequences, to standard output or error."""
    text = text.encode(encoding(), "backslashreplace").decode(encoding())
    # Without color=True, click would remove escape sequences.
    click.echo(text, err=is_error, color=True)


_CONSTANTS = {"Infinity": "1e999", "NaN": "null"}
_CONSTANT = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"|Infinity|NaN')


def as_json(value: object) -> None:
    """Print a value as one line of JSON.

    JSON has no infinity and no NaN: infinity is a number that no float can hold, as in the hub's
    JSON, which parsers read as infinity; NaN is null.
    """
    import json  # 3 ms, which help does not need.

    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    if not can_show(text):
        text = json.dumps(value, separators=(",", ":"))
    if "Infinity" in text or "NaN" in text:
        text = _CONSTANT.sub(lambda found: _CONSTANTS.get(found[0], found[0]), text)
    # In JSON they are all in strings, where this is an equal spelling.
    text = _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)
    click.echo(text, color=True)


def names(found: Iterable[str], *, json_: bool = False) -> None:
    """Print sorted names, one per line."""
    for name in sorted(found):
        as_json(name) if json_ else line(name)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print aligned columns without borders, which ``awk`` can read.

    A terminal that is too narrow for them gets a block of lines for each row instead.
    """
    cells = [[visible(cell, keep="") for cell in row] for row in (heads, *rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(heads))]
    if is_terminal() and sum(widths) + 2 * len(widths) - 2 > _columns():
        _blocks(cells)
        return
    for row in cells:
        line("  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip())


def _columns() -> int:
    import shutil  # Few tools need it.

    return shutil.get_terminal_size().columns


def _blocks(cells: Sequence[Sequence[str]]) -> None:
    """Print rows as blocks of lines, with the first row's cell in front of each value."""
    heads, *rows = cells
    width = max(map(len, heads))
    for number, row in enumerate(rows):
        if number:
            line("")
        for head, cell in zip(heads, row, strict=True):
            line(f"{head:{width}}  {cell}".rstrip())
