"""Nodes that are no clients of this hub, in its graph."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Self

from fibws.hub.graph.nodes import DistantNode


class ForeignNode(DistantNode):
    """A node of another graph; a `GraphNode` of this one.

    Args:
        since: when it was found, in nanoseconds since 1970.
        on_replaced: called when another node has taken its name.

    Attributes:
        published: the topics that it publishes here, with what its bridge keeps for each.
        subscribed: the topics that it subscribes to here.
        served: the services that it provides here.
    """

    __slots__ = ("_on_replaced", "name", "published", "served", "since", "subscribed")

    def __init__(self, name: str, since: int, on_replaced: Callable[[Self], object]) -> None:
        self.name = name
        self.since = since
        self.published: dict[str, Any] = {}
        self.subscribed: dict[str, Any] = {}
        self.served: dict[Any, Any] = {}
        self._on_replaced: Callable[[Any], object] = on_replaced

    def publishing(self) -> Iterable[str]:
        """Return the topics that it publishes."""
        return self.published

    def subscribing(self) -> Iterable[str]:
        """Return the topics that it subscribes to."""
        return self.subscribed

    def providing(self) -> Iterable[str]:
        """Return the services that it provides."""
        return self.served

    def replaced(self) -> None:
        """Leave, since another node has taken its name."""
        self._on_replaced(self)
