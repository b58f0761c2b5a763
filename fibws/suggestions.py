"""What a name was perhaps meant to be, for errors that there is nothing of that name."""

from __future__ import annotations

from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The one of the known names that is almost the same, if any is."""
    from difflib import get_close_matches  # only an error has a use for it

    return next(iter(get_close_matches(name, list(known), 1)), None)


def hint(name: str, known: Iterable[str]) -> str:
    """The end of an error's text, ``; did you mean /chatter?``; empty if no name is near."""
    found = nearest(name, known)
    return f"; did you mean {found}?" if found else ""


def hint_or_all(name: str, known: Iterable[str]) -> str:
    """The same, but all the names if none is near, ``; known are arg, node``; empty without any."""
    names = list(known)
    return hint(name, names) or (f"; known are {', '.join(names)}" if names else "")
