"""Where words come from that no argument has: a pipe or a file, a keyboard, or nowhere."""

from __future__ import annotations

import sys
from typing import TextIO


def is_keyboard() -> bool:
    """Whether standard input is a person, who is not to be waited for unasked."""
    return sys.stdin is not None and sys.stdin.isatty()


def piped() -> TextIO | None:
    """Standard input; None if it is a person, or closed."""
    return None if is_keyboard() else sys.stdin
