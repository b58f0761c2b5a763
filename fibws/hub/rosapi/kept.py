"""Answers that are kept as JSON texts, for what many ask again and again."""

from __future__ import annotations

from collections.abc import Callable

from fibws.hub.graph.graph import Graph


class KeptAnswers:
    """Answers about the graph, each made once and kept until the graph changes."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._answers: dict[Callable[[], bytes], bytes] = {}
        self._revision = -1

    def of(self, make: Callable[[], bytes]) -> bytes:
        """What ``make`` gives."""
        if self._revision != self._graph.revision:
            self._answers.clear()
            self._revision = self._graph.revision
        if make not in self._answers:
            self._answers[make] = make()
        return self._answers[make]
