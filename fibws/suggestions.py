"""Similar names, for the end of an error about an unknown name: ``; did you mean /chatter?``."""

from __future__ import annotations

import re
from collections.abc import Iterable

MISSPELLED = 0.84
"""Similarity of two topics' names from which one is likely misspelled: `/fibonaci` and
`/fibonacci` have 0.95, names of six letters of which one differs 0.83."""

MOST_COMPARED = 20
"""Similar names of which the last parts are compared."""
SHORT = 3
"""Letters of a last part in which one that differs would be too much."""


def nearest(name: str, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Return the known name that is most similar, regardless of case; None if none is.

    Its last part must be similar, too: names in one namespace, or of packages that end in
    ``_msgs``, have much in common that says nothing.

    Args:
        cutoff: the least similarity, from 0 to 1.
    """
    from difflib import get_close_matches  # Only errors need it.

    by_lower = {each.lower(): each for each in reversed(list(known))}
    last = _last(name.lower())
    for near in get_close_matches(name.lower(), list(by_lower), MOST_COMPARED, cutoff):
        if len(last) <= SHORT or get_close_matches(last, [_last(near)], 1, cutoff):
            return by_lower[near]
    return None


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return ``; did you mean /chatter?``, or an empty string if no known name is similar.

    Empty, too, if the name itself is known by now: it may appear while an error is being written.
    """
    found = nearest(name, known)
    return f"; did you mean {found}?" if found and found != name else ""


def suggestion_or_known(name: str, known: Iterable[str]) -> str:
    """Return ``; did you mean arg?``, or ``; known are arg, node`` if no name is similar."""
    names = list(known)
    return suggestion(name, names) or (f"; known are {', '.join(names)}" if names else "")


def misspelled(name: str, others: Iterable[str]) -> str | None:
    """Return the name of a topic that is likely the same one, spelled differently.

    It has another namespace, case or underscores, or a letter differs. Names that differ only in
    numbers, such as ``/camera_1`` and ``/camera_2``, differ on purpose.
    """
    from difflib import SequenceMatcher

    candidates = [each for each in others if _without_numbers(each) != _without_numbers(name)]
    same_base = [each for each in candidates if _base(each) == _base(name)]
    if same_base:
        return min(same_base, key=lambda each: (len(each), each))
    similarities = [
        (SequenceMatcher(None, name.lower(), each.lower()).ratio(), each) for each in candidates
    ]
    similarity, most_similar = max(similarities, default=(0.0, None))
    return most_similar if similarity >= MISSPELLED else None


def _last(name: str) -> str:
    """Return a name without its namespace or package."""
    return name.rpartition("/")[2]


def _base(name: str) -> str:
    """Return a name without its namespace, regardless of case and underscores."""
    return _last(name).replace("_", "").lower()


def _without_numbers(name: str) -> str:
    return re.sub(r"\d+", "0", name)
