"""Helpers that keep texts from clients in the hub's log readable and short."""

from __future__ import annotations

LONGEST_TEXT = 1000
"""Most characters of a text about an operation, which may repeat names that a client chose."""


def is_power_of_ten(count: int) -> bool:
    """Return whether to log the ``count``-th of events that may come thousands a second."""
    return str(count).strip("0") == "1"


def printable(text: str) -> str:
    """Return a text with line ends and terminal codes escaped."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in shortened(text.strip()))


def shortened(text: str) -> str:
    """Return a text, cut to a readable length."""
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}..."
