"""Caches for responses that many clients ask for again and again, as JSON."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

from fibws.hub.graph.graph import Graph

LARGE = 256 * 1024
"""Bytes from which on a response takes so long to make that it is not made for every caller."""
FRESH_FOR = 1000
"""Nanoseconds for each byte, a second for a megabyte: about ten times what its making takes."""
MOST_TEXT_BYTES = 2**24
"""Bytes that cached texts of types may take: clients bring types, and each may hold all others."""

Make: TypeAlias = Callable[[str], bytes]
"""Makes a response for a caller's node."""


class CachedResponse(NamedTuple):
    """A response, the graph's revision that it is of, and when it was made."""

    text: bytes
    revision: int
    made: int


class ResponseCache:
    """Responses about the graph, each made once for each revision of it.

    Large responses that hold their own revision or time may be served a little stale, so that
    alternating changes and queries cannot keep the hub from everything else. Where a policy hides
    names from nodes, nothing is cached.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._responses: dict[Make, CachedResponse] = {}

    def get(self, make: Make, caller: str) -> bytes:
        """Return the result of ``make`` for this revision."""
        cached = self._responses.get(make)
        if cached is None or cached.revision != self._graph.revision:
            return self._make(make, caller)
        return cached.text

    def get_lately(self, make: Make, caller: str) -> bytes:
        """Return the result of ``make`` for this revision; a large one may be slightly older."""
        cached = self._responses.get(make)
        if cached is not None and cached.revision == self._graph.revision:
            return cached.text
        return self.get_recent(make, caller)

    def get_recent(self, make: Make, caller: str) -> bytes:
        """Return the result of ``make``; a large one may be slightly older."""
        cached = self._responses.get(make)
        # The clock may have been set back.
        if cached is None or not 0 <= self._graph.now() - cached.made < _fresh_for(cached.text):
            return self._make(make, caller)
        return cached.text

    def _make(self, make: Make, caller: str) -> bytes:
        text = make(caller)
        if self._graph.policy.allows_all:
            self._responses[make] = CachedResponse(text, self._graph.revision, self._graph.now())
        return text


def _fresh_for(text: bytes) -> int:
    """Return the nanoseconds for which a response may be served unchanged."""
    return len(text) * FRESH_FOR if len(text) >= LARGE else 0


class TextCache:
    """JSON texts by the names of types.

    Args:
        make: makes the text of a type; its errors are not cached.
        max_bytes: limit of all texts together; beyond it, all are dropped and made again on use.
    """

    def __init__(self, make: Callable[[str], bytes], max_bytes: int = MOST_TEXT_BYTES) -> None:
        self._make = make
        self._max_bytes = max_bytes
        self._texts: dict[str, bytes] = {}
        self._bytes = 0

    def get(self, name: str) -> bytes:
        """Return the text of a type."""
        text = self._texts.get(name)
        if text is None:
            text = self._make(name)
            self._bytes += len(text)
            if self._bytes > self._max_bytes:
                self._texts.clear()
                self._bytes = len(text)
            self._texts[name] = text
        return text

    def forget(self, name: str) -> None:
        """Drop the text of a type, if it is cached."""
        self._bytes -= len(self._texts.pop(name, b""))
