"""The clock by which a hub's connections keep their deadlines, advanced by the test."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import Any, cast

from fibws.hub.server import HubServer


class VirtualTime:
    """A steady clock in place of the event loop's; it also sweeps in place of the hub."""

    def __init__(self, hub: HubServer) -> None:
        self._hub = hub
        self._loop = hub._shared.loop
        self._now = self._loop.time()
        hub._sweeper.cancel()
        loop = cast(asyncio.AbstractEventLoop, self)
        hub._shared = replace(hub._shared, loop=loop)  # for connections that open later

    def time(self) -> float:
        return self._now

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loop, name)

    def advance(self, seconds: float) -> None:
        """Let time pass, and then do what is overdue at each connection."""
        self._now += seconds
        for connection in list(self._hub._connections):
            connection.sweep(self._now, late=0.0)
