"""A subscriber that records every message of a topic."""

from __future__ import annotations

from typing import Any

from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import SinkReport


class Recorder:
    """A `Sink` that keeps the publications it is given."""

    def __init__(self, node: str = "/recorder") -> None:
        self.node = node
        self.received: list[Publication] = []
        self.replayed: list[Publication] = []

    def receive(self, publication: Publication) -> None:
        self.received.append(publication)

    def replay(self, publication: Publication) -> None:
        self.replayed.append(publication)

    def report(self) -> SinkReport:
        return SinkReport(messages=len(self.received), dropped=2, queue_length=7, encoding="ros1")

    @property
    def values(self) -> list[dict[str, Any]]:
        """The fields of each message."""
        return [publication.values() for publication in self.received]

    @property
    def numbers(self) -> list[Any]:
        """The ``data`` of each message."""
        return [values["data"] for values in self.values]
