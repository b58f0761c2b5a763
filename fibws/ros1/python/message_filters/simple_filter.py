"""What all filters are: something that hands messages to callbacks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class SimpleFilter:
    """Hands what it lets through to its callbacks, in the order in which they came."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., object], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., object], *args: Any) -> int:
        """Have a function given the messages that come through, followed by ``args``.

        Returns:
            The number of the callback, its key in ``callbacks``.
        """
        number = len(self.callbacks)
        self.callbacks[number] = (cb, args)
        return number

    def signalMessage(self, *msg: Any) -> None:
        """Let messages through: one, or those that belong together."""
        for callback, args in list(self.callbacks.values()):
            callback(*msg, *args)
