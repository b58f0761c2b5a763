"""Reading a command line: negative numbers, options with several values, piped input."""

from __future__ import annotations

import re
import sys
from collections.abc import Collection, Iterable
from typing import Any, TextIO

import click

VALUES: dict[str, Any] = {"ignore_unknown_options": True}
"""Settings of a command with arguments that may be negative numbers; `check` finds the options."""

_NEGATIVE = re.compile(r"-(\.?\d.*|\.inf|\s.*|)", re.IGNORECASE | re.DOTALL)
_NUMBER = re.compile(r"-\.?\d[\d.e+-]*", re.IGNORECASE)


def check(context: click.Context, parameter: click.Parameter, words: Any) -> Any:
    """Return an argument's words; raise `NoSuchOption` for an unknown option among them."""
    for word in (words,) if isinstance(words, str) else words or ():
        if word.startswith("-") and not _NEGATIVE.fullmatch(word) and word != "---":
            raise click.NoSuchOption(word, ctx=context)
    return words


def spread(words: Iterable[str], options: Collection[str]) -> list[str]:
    """Repeat options that take all words up to the next option, as click reads them.

    Args:
        words: the words as typed: ``-s a b -v``.
        options: the options with several values.

    Returns:
        The words with the option before each of its values: ``-s a -s b -v``. An option without a
        value is moved to the end, so that click reports it; the words after ``--`` are left out
        then, as click would take them for its value.
    """
    typed = list(words)
    end = typed.index("--") if "--" in typed else len(typed)
    plain: list[str] = []
    without_value: dict[str, None] = {}
    option = ""
    for word in typed[:end]:
        if word in options:
            option = word
            without_value[option] = None
        elif ":=" in word:  # roslaunch ends a program's arguments with remappings.
            plain.append(word)
        elif option and not word.startswith("-"):
            plain += [option, word]
            without_value.pop(option, None)
        else:
            option = ""
            plain.append(word)
    return [*plain, *(without_value or typed[end:])]


class DigitOptions(click.Command):
    """A command with an option such as ``-1``: negative numbers must follow ``--``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments; a `UsageError` suggests ``--`` before a negative number."""
        words = args[: args.index("--")] if "--" in args else list(args)
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption:
            options = {name for each in self.params for name in each.opts}
            for word in words:
                if _NUMBER.fullmatch(word) and word not in options:
                    remedy = f"write -- before the values, as in -- {word}"
                    raise click.UsageError(f"{word} is read as an option: {remedy}", ctx) from None
            raise


def is_stdin_terminal() -> bool:
    """Return whether standard input is a terminal, where a person would have to type."""
    return sys.stdin is not None and sys.stdin.isatty()


def piped_input() -> TextIO | None:
    """Return standard input; None if it is a terminal or closed."""
    return None if is_stdin_terminal() else sys.stdin
