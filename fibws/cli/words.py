"""Values as the words of a command line, where ``-5`` is a number and no option."""

from __future__ import annotations

import re
from typing import Any

import click

VALUES: dict[str, Any] = {"ignore_unknown_options": True}
"""The settings of a command whose arguments may be negative numbers: `check` knows which are."""

_NEGATIVE = re.compile(r"-(\.?\d.*|\.inf|\s.*|)", re.IGNORECASE | re.DOTALL)


def check(context: click.Context, parameter: click.Parameter, words: Any) -> Any:
    """Return the words, or the word; an unknown option among them raises `NoSuchOption`."""
    for word in (words,) if isinstance(words, str) else words or ():
        if word.startswith("-") and not _NEGATIVE.fullmatch(word) and word != "---":
            raise click.NoSuchOption(word, ctx=context)
    return words
