"""Checks of arguments that several modules of the node library take."""

from __future__ import annotations

import math
from numbers import Real


def is_number(value: object) -> bool:
    """Return whether a value is a real number; those of NumPy are, too."""
    return isinstance(value, Real)


def check_seconds(timeout: object) -> None:
    """Raise TypeError unless ``timeout`` is a number or None."""
    if timeout is not None and not is_number(timeout):
        raise TypeError(f"timeout must be a number of seconds, got {timeout!r}")


def check_queue_size(queue_size: int) -> None:
    """Raise ValueError unless ``queue_size`` is at least 1, TypeError if it is not a number."""
    if not is_number(queue_size):
        raise TypeError(f"queue_size must be a number of messages, got {queue_size!r}")
    if queue_size < 1:
        raise ValueError(f"queue_size must be at least 1, got {queue_size}")


def check_timeout(timeout: float | None) -> None:
    """Raise ValueError unless ``timeout`` is a finite number of seconds above 0, or None."""
    check_seconds(timeout)
    if timeout is not None and not 0 < timeout < math.inf:
        raise ValueError(f"timeout must be a finite number of seconds above 0, got {timeout!r}")


def check_types(**given: tuple[object, type]) -> None:
    """Raise TypeError unless each value, by its argument's name, is of a class or None."""
    for name, (value, class_) in given.items():
        if value is not None and not isinstance(value, class_):
            wanted = f"{class_.__module__}.{class_.__qualname__}"
            raise TypeError(f"{name} must be a {wanted}, got {value!r}")


def without_surrogates(text: str) -> str:
    """Return the text with lone surrogates replaced: JSON cannot carry them."""
    return text.encode("utf-8", "replace").decode()


def described(error: Exception) -> str:
    """Return an error's class and text for another program: ``KeyError: 'boom'``."""
    text, name = str(error), type(error).__name__
    return without_surrogates(f"{name}: {text}" if text else name)
