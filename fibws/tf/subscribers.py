"""The subscribers of a topic."""

from __future__ import annotations

import asyncio
from math import inf

import fibws

FIRST_PAUSE, PAUSE = 0.01, 0.5
"""The first and the longest pause between two requests to the hub, in seconds."""


class Subscribers:
    """The nodes that subscribe to a topic, as of the latest update."""

    def __init__(self, node: fibws.Node, topic: str) -> None:
        self._node = node
        self._topic = topic
        self.names: frozenset[str] | None = None
        """The nodes' names; None before the first update."""

    @property
    def is_empty(self) -> bool:
        """Whether the topic is known to have no subscribers."""
        return self.names == frozenset()

    async def update(self) -> None:
        """Ask the hub for the subscribers; if it fails, nothing changes."""
        try:
            self.names = frozenset(await self._node.graph.subscribers(self._topic))
        except fibws.ServiceError as error:
            self._node.log.debug("Cannot get the subscribers of %s: %s", self._topic, error)

    async def watch(self, patience: float = inf) -> None:
        """Update until there have been no subscribers for ``patience`` seconds."""
        pause, longest = FIRST_PAUSE, min(PAUSE, patience / 4)
        empty_for = 0.0
        while empty_for < patience:
            pause = min(2 * pause, longest)
            await asyncio.sleep(pause)
            await self.update()
            empty_for = empty_for + pause if self.is_empty else 0.0
