"""The words of a command line: ``-5``, which is a number and no option; options of many words."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from typing import Any

import click

VALUES: dict[str, Any] = {"ignore_unknown_options": True}
"""The settings of a command whose arguments may be negative numbers: `check` knows which are."""

_NEGATIVE = re.compile(r"-(\.?\d.*|\.inf|\s.*|)", re.IGNORECASE | re.DOTALL)
_NUMBER = re.compile(r"-\.?\d[\d.e+-]*", re.IGNORECASE)


def check(context: click.Context, parameter: click.Parameter, words: Any) -> Any:
    """Return the words, or the word; an unknown option among them raises `NoSuchOption`."""
    for word in (words,) if isinstance(words, str) else words or ():
        if word.startswith("-") and not _NEGATIVE.fullmatch(word) and word != "---":
            raise click.NoSuchOption(word, ctx=context)
    return words


def spread(words: Iterable[str], options: Collection[str]) -> list[str]:
    """The words of a command that has options which take all words up to the next option.

    Args:
        words: as they are typed: ``-s a b -v``.
        options: those options.

    Returns:
        What click can read, where the option stands before each of its words: ``-s a -s b -v``. One
        without any stands at the end, of which click says that it lacks one; what is behind ``--``
        is left out then, lest it be that one.
    """
    typed = list(words)
    end = typed.index("--") if "--" in typed else len(typed)
    plain: list[str] = []
    lone: dict[str, None] = {}
    option = ""
    for word in typed[:end]:
        if word in options:
            option = word
            lone[option] = None
        elif option and not word.startswith("-"):
            plain += [option, word]
            lone.pop(option, None)
        else:
            option = ""
            plain.append(word)
    return [*plain, *(lone or typed[end:])]


class DigitOptions(click.Command):
    """A command with an option such as ``-1``: negative numbers have to stand behind ``--``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the words; a `UsageError` names the ``--`` that is missing before a number."""
        words = args[: args.index("--")] if "--" in args else list(args)
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption:
            options = {name for each in self.params for name in each.opts}
            for word in words:
                if _NUMBER.fullmatch(word) and word not in options:
                    remedy = f"write -- before the values, as in -- {word}"
                    raise click.UsageError(f"{word} is taken for options: {remedy}", ctx) from None
            raise
