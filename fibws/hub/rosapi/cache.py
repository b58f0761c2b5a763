"""Caches for responses that many clients ask for again and again, as JSON."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, NamedTuple, TypeAlias, TypeVar
from weakref import WeakKeyDictionary

from fibws.hub.graph.graph import Graph
from fibws.interfaces.catalogue import Definitions

LARGE = 256 * 1024
"""Bytes from which on a response takes so long to make that it is not made for every caller."""
FRESH_FOR = 1000
"""Nanoseconds for each byte, a second for a megabyte: about ten times what its making takes."""
OVERHEAD = 1000
"""Bytes that each response counts for besides its text."""
MOST_VIEWS = 100
"""Principals, each of which sees another part of the graph, whose lists of names are kept."""
MOST_RESPONSE_BYTES = 2**25
"""Bytes that cached responses of one kind may take: each principal has its own."""
MOST_TEXT_BYTES = 2**24
"""Bytes that cached texts of types may take: clients bring types, and each may hold all others."""

Make: TypeAlias = Callable[[str], bytes]
"""Makes a response for a caller's node."""


T = TypeVar("T")


class Views(Generic[T]):
    """A value computed from the graph as nodes see it, once for each view and revision.

    Args:
        make: makes it for a caller's node.
    """

    def __init__(self, graph: Graph, make: Callable[[str], T]) -> None:
        self._graph = graph
        self._make = make
        self._views: OrderedDict[Hashable, tuple[int, T]] = OrderedDict()
        """Each with its revision, the one that was used last at the end."""

    def get(self, caller: str) -> T:
        """Return what the caller's node sees."""
        view = self._graph.policy.view(caller)
        kept = self._views.pop(view, None)
        if kept is None or kept[0] != self._graph.revision:
            kept = (self._graph.revision, self._make(caller))
        self._views[view] = kept
        if len(self._views) > MOST_VIEWS:
            self._views.popitem(last=False)
        return kept[1]


class CachedResponse(NamedTuple):
    """A response, the graph's revision that it is of, and when it was made."""

    text: bytes
    revision: int
    made: int


class ResponseCache:
    """Responses about the graph, each made once for each revision of it, and for each view.

    Large responses that hold their own revision or time may be served a little stale, so that
    alternating changes and queries cannot keep the hub from everything else.

    Args:
        max_bytes: limit of all responses together; beyond it, those that were made first are
            dropped, and made again on use.
    """

    def __init__(self, graph: Graph, max_bytes: int = MOST_RESPONSE_BYTES) -> None:
        self._graph = graph
        self._max_bytes = max_bytes
        self._bytes = 0
        self._responses: OrderedDict[tuple[Make, Hashable], CachedResponse] = OrderedDict()
        """The one that was made last at the end."""

    def get(self, make: Make, caller: str) -> bytes:
        """Return the result of ``make`` for this revision."""
        cached = self._cached(make, caller)
        if cached is None or cached.revision != self._graph.revision:
            return self._make(make, caller)
        return cached.text

    def get_lately(self, make: Make, caller: str) -> bytes:
        """Return the result of ``make`` for this revision; a large one may be slightly older."""
        cached = self._cached(make, caller)
        if cached is not None and cached.revision == self._graph.revision:
            return cached.text
        return self.get_recent(make, caller)

    def get_recent(self, make: Make, caller: str) -> bytes:
        """Return the result of ``make``; a large one may be slightly older."""
        cached = self._cached(make, caller)
        # The clock may have been set back.
        if cached is None or not 0 <= self._graph.now() - cached.made < _fresh_for(cached.text):
            return self._make(make, caller)
        return cached.text

    def _cached(self, make: Make, caller: str) -> CachedResponse | None:
        return self._responses.get((make, self._graph.policy.view(caller)))

    def _make(self, make: Make, caller: str) -> bytes:
        graph, text = self._graph, make(caller)
        key = (make, graph.policy.view(caller))
        self._forget(key)
        self._responses[key] = CachedResponse(text, graph.revision, graph.now())
        self._bytes += len(text) + OVERHEAD
        while self._bytes > self._max_bytes and len(self._responses) > 1:
            self._forget(next(iter(self._responses)))
        return text

    def _forget(self, key: tuple[Make, Hashable]) -> None:
        older = self._responses.pop(key, None)
        if older is not None:
            self._bytes -= len(older.text) + OVERHEAD


def _fresh_for(text: bytes) -> int:
    """Return the nanoseconds for which a response may be served unchanged."""
    return len(text) * FRESH_FOR if len(text) >= LARGE else 0


class TextCache:
    """JSON texts of types, by the definitions in which these are and by their names.

    Args:
        make: makes the text of a type; its errors are not cached.
        max_bytes: limit of all texts together; beyond it, all are dropped and made again on use.
    """

    def __init__(
        self, make: Callable[[Definitions, str], bytes], max_bytes: int = MOST_TEXT_BYTES
    ) -> None:
        self._make = make
        self._max_bytes = max_bytes
        self._texts: WeakKeyDictionary[Definitions, dict[str, bytes]] = WeakKeyDictionary()
        self._bytes = 0
        """Bytes of all texts; texts of forgotten definitions count until all are dropped."""

    def get(self, definitions: Definitions, name: str) -> bytes:
        """Return the text of a type."""
        texts = self._texts.get(definitions, {})
        text = texts.get(name)
        if text is None:
            text = self._make(definitions, name)
            self._bytes += len(text)
            if self._bytes > self._max_bytes:
                self._texts.clear()
                self._bytes = len(text)
            self._texts.setdefault(definitions, {})[name] = text
        return text
