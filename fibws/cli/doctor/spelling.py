"""Names that were meant to be one: a letter slipped, or a namespace."""

from __future__ import annotations

import re
from collections.abc import Iterable

ALIKE = 0.84
"""How much of two names must agree; `/fibonaci` and `/fibonacci` have 0.95, one letter in six."""


def meant(name: str, others: Iterable[str]) -> str | None:
    """The one of the other names that was most likely meant by this one, if any was."""
    from difflib import SequenceMatcher

    candidates = [other for other in others if not _are_numbered(name, other)]
    slipped = [other for other in candidates if _base(other) == _base(name)]
    if slipped:
        return min(slipped, key=lambda other: (len(other), other))
    ratios = [
        (SequenceMatcher(None, name.lower(), other.lower()).ratio(), other) for other in candidates
    ]
    ratio, nearest = max(ratios, default=(0.0, None))
    return nearest if ratio >= ALIKE else None


def _base(name: str) -> str:
    """A name without its namespace, in which case and underscores make no difference."""
    return name.rpartition("/")[2].replace("_", "").lower()


def _are_numbered(name: str, other: str) -> bool:
    """Whether they differ by numbers alone, as ``/camera_1`` and ``/camera_2`` do on purpose."""
    return re.sub(r"\d+", "0", name) == re.sub(r"\d+", "0", other)
