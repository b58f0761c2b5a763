"""Checks of arguments that several modules of the node library take."""

from __future__ import annotations

import math


def check_queue_size(queue_size: int) -> None:
    """Raise ValueError unless ``queue_size`` is at least 1."""
    if queue_size < 1:
        raise ValueError(f"queue_size must be at least 1, got {queue_size}")


def check_timeout(timeout: float | None) -> None:
    """Raise ValueError unless ``timeout`` is a finite number of seconds above 0, or None."""
    if timeout is not None and not 0 < timeout < math.inf:
        raise ValueError(f"timeout must be a finite number of seconds above 0, got {timeout!r}")


def without_surrogates(text: str) -> str:
    """Return the text with lone surrogates replaced: JSON cannot carry them."""
    return text.encode("utf-8", "replace").decode()


def described(error: Exception) -> str:
    """Return an error's class and text for another program: ``KeyError: 'boom'``."""
    text, name = str(error), type(error).__name__
    return without_surrogates(f"{name}: {text}" if text else name)
