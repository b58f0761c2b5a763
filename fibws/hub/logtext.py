"""What of the things that clients do may go to the log: it stays readable, and it stays short."""

from __future__ import annotations

LONGEST_TEXT = 1000
"""Characters of what is said about an operation: it may repeat names of a client's making."""


def is_power_of_ten(count: int) -> bool:
    """Whether to log the ``count``-th of things of which there may be thousands in a second."""
    return str(count).strip("0") == "1"


def printable(text: str) -> str:
    """What may be written to a log of a text that may hold line ends and terminal codes."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in shortened(text.strip()))


def shortened(text: str) -> str:
    """A text, cut to a length that is fit to be read."""
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}..."
