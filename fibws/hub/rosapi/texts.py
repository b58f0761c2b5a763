"""JSON texts about types, each made once."""

from __future__ import annotations

from collections.abc import Callable

MOST_BYTES = 2**24
"""Bytes that such texts may have together: clients bring types, and each may hold all others."""


class Texts:
    """JSON texts by the names of types, which never change their meaning.

    Args:
        make: makes the text of a type; what it raises is not kept.
        max_bytes: when all have more they are forgotten, and made anew when they are asked for.
    """

    def __init__(self, make: Callable[[str], bytes], max_bytes: int = MOST_BYTES) -> None:
        self._make = make
        self._max_bytes = max_bytes
        self._texts: dict[str, bytes] = {}
        self._bytes = 0

    def of(self, name: str) -> bytes:
        """The text of a type."""
        text = self._texts.get(name)
        if text is None:
            text = self._make(name)
            self._bytes += len(text)
            if self._bytes > self._max_bytes:
                self._texts.clear()
                self._bytes = len(text)
            self._texts[name] = text
        return text
