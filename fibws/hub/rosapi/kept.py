"""Answers that are kept as JSON texts, for what many ask again and again."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fibws.hub.graph.graph import Graph

LARGE = 256 * 1024
"""Bytes from which on an answer takes so long to make that it is not made for every asker."""
GOOD_FOR = 1000
"""Nanoseconds for each byte, a second for a megabyte: about ten times what its making takes."""


class Kept(NamedTuple):
    """An answer, the graph's revision that it is of, and when it was made."""

    text: bytes
    revision: int
    made: int


class KeptAnswers:
    """Answers about the graph, each made once for each revision of it.

    Those that say themselves which revision or which time they are of may be `lately`'s or
    `just_now`'s: where they are large they are good for a while, whatever happens meanwhile. Who
    asks and changes the graph by turns would else keep the hub from doing anything but answering.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._answers: dict[Callable[[], bytes], Kept] = {}

    def of(self, make: Callable[[], bytes]) -> bytes:
        """What ``make`` gives for this revision."""
        kept = self._answers.get(make)
        if kept is None or kept.revision != self._graph.revision:
            kept = self._make(make)
        return kept.text

    def lately(self, make: Callable[[], bytes]) -> bytes:
        """What ``make`` gives for this revision; if that is large, what it has given just now."""
        kept = self._answers.get(make)
        if kept is not None and kept.revision == self._graph.revision:
            return kept.text
        return self.just_now(make)

    def just_now(self, make: Callable[[], bytes]) -> bytes:
        """What ``make`` gives; if that is large, what it has given just now."""
        kept = self._answers.get(make)
        # The clock may have been set back.
        if kept is None or not 0 <= self._graph.now() - kept.made < _good_for(kept.text):
            kept = self._make(make)
        return kept.text

    def _make(self, make: Callable[[], bytes]) -> Kept:
        kept = self._answers[make] = Kept(make(), self._graph.revision, self._graph.now())
        return kept


def _good_for(text: bytes) -> int:
    """The nanoseconds for which an answer is good, whatever happens."""
    return len(text) * GOOD_FOR if len(text) >= LARGE else 0
