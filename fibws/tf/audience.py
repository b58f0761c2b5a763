"""Who listens to a topic."""

from __future__ import annotations

import asyncio
from math import inf

import fibws

FIRST_PAUSE, PAUSE = 0.01, 0.5
"""Seconds between two looks at the graph, at first and in the end."""


class Audience:
    """The nodes that listen to a topic, as of the latest look."""

    def __init__(self, node: fibws.Node, topic: str) -> None:
        self._node = node
        self._topic = topic
        self.listeners: frozenset[str] | None = None
        """Their names; None as long as the hub has not told."""

    @property
    def is_empty(self) -> bool:
        """Whether it is known that nobody listens."""
        return self.listeners == frozenset()

    async def look(self) -> None:
        """Ask the hub who listens. If it does not tell, it is as it was."""
        try:
            self.listeners = frozenset(await self._node.graph.subscribers(self._topic))
        except fibws.ServiceError as error:
            self._node.log.debug("Who listens to %s is not known: %s", self._topic, error)

    async def watch(self, patience: float = inf) -> None:
        """Keep looking, until nobody has listened for ``patience`` seconds."""
        pause, longest = FIRST_PAUSE, min(PAUSE, patience / 4)
        silence = 0.0
        while silence < patience:
            pause = min(2 * pause, longest)
            await asyncio.sleep(pause)
            await self.look()
            silence = silence + pause if self.is_empty else 0.0
