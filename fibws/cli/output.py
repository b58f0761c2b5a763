"""How tools print: whole lines, at once, in a form that pipes can use and terminals can bear.

What messages say may be anybody's. A terminal obeys control characters, so it is shown them and
never sent them; a pipe gets a text as it is.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Sequence

import click

_BIDIRECTIONAL = "\u200e\u200f\u202a-\u202e\u2066-\u2069"
_CONTROL = re.compile(f"[\x00-\x1f\x7f-\x9f{_BIDIRECTIONAL}]")
"""What makes a terminal do something: C0 with escape, C1 with CSI, what turns the order of text."""


def is_terminal() -> bool:
    """Whether a person sees what is printed now; else it is a program that reads it."""
    return sys.stdout is not None and sys.stdout.isatty()


def obeys() -> bool:
    """Whether control sequences are obeyed where this prints: no pipe does, nor a dumb terminal."""
    is_dumb = os.environ.get("TERM", "dumb") == "dumb" and sys.platform != "win32"
    return is_terminal() and not is_dumb


def has_colours() -> bool:
    """Whether what is printed may have colours: where it obeys, without $NO_COLOR."""
    context = click.get_current_context(silent=True)
    return obeys() and not (context is not None and context.find_root().color is False)


def encoding() -> str:
    """The encoding of what is printed; one that has all characters if it is printed nowhere."""
    return getattr(sys.stdout, "encoding", None) or "utf-8"


def can_show(text: str) -> bool:
    """Whether the encoding of what is printed has these characters."""
    try:
        text.encode(encoding())
    except UnicodeEncodeError:
        return False
    return True


def visible(text: str, keep: str = "\n\t") -> str:
    """A text whose control characters are spelled out: an escape is ``\\x1b``.

    Args:
        text: somebody's words.
        keep: the control characters that stay.
    """
    return _CONTROL.sub(lambda found: found[0] if found[0] in keep else ascii(found[0])[1:-1], text)


def counted(number: int, noun: str) -> str:
    """A number of things, whose plural has an s: ``1 node``, ``2 nodes``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def line(text: str = "", *, colour: str | None = None, bold: bool = False) -> None:
    """Print a line now, also into a pipe; on a terminal control characters do nothing.

    Args:
        text: the line, or several, with no styles in it.
        colour: one of click's names of colours, for terminals alone.
        bold: whether it stands out on a terminal.
    """
    if is_terminal():
        text = visible(text)
    text = text.encode(encoding(), "backslashreplace").decode(encoding())
    if has_colours() and (colour or bold):
        text = click.style(text, fg=colour, bold=bold or None)
    # Else click would take out of a text what it thinks is a style.
    click.echo(text, color=True)


def as_json(value: object) -> None:
    """Print a value as one line of JSON."""
    import json  # 3 ms, which help has no use for

    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    if not can_show(text):
        text = json.dumps(value, separators=(",", ":"))
    if is_terminal():
        # Within JSON all of them stand in strings, where this is their other spelling.
        text = _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", text)
    click.echo(text, color=True)


def names(found: Iterable[str], *, json_: bool = False) -> None:
    """Print names, one a line and sorted."""
    for name in sorted(found):
        as_json(name) if json_ else line(name)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns, as wide as what is in them, with no line drawn: fit for ``awk``."""
    cells = [[visible(cell, keep="") for cell in row] for row in (heads, *rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(heads))]
    for row in cells:
        line("  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip())
