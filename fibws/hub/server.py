"""The hub as a server: one port, all connections, one timer."""

from __future__ import annotations

import asyncio
import errno
import ipaddress
import logging
import time
import uuid
from types import TracebackType
from typing import Self

from fibws import __version__
from fibws.errors import FibwsError, HubError
from fibws.hub.connection import Connection, Shared
from fibws.hub.gate import Gate
from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Flusher
from fibws.hub.pages import Pages, read
from fibws.hub.rosapi.nodes import OwnNodes
from fibws.hub.settings import Settings
from fibws.interfaces import Interfaces
from fibws.protocol.closing import SHUTDOWN

logger = logging.getLogger("fibws.hub")

SWEEP_INTERVAL = 1.0
BACKLOG = 1024
"""Connections that may wait to be accepted: enough for a thousand that come at once."""


class Hub:
    """A hub that listens while its ``async with`` block runs.

    Raises:
        HubError: on entering, when it cannot listen, most likely because the port is taken.
        InterfaceError: a folder of definitions is not there.
    """

    def __init__(self, settings: Settings | None = None) -> None:
        self.settings = settings or Settings()
        self.port = self.settings.port
        """The port it listens on, also when the settings leave the choice to the system."""
        self.graph = Graph(
            Interfaces(self.settings.interfaces),
            time.time_ns,
            strict_types=self.settings.strict_types,
            max_parameter_bytes=self.settings.max_parameter_bytes,
        )
        self._connections: set[Connection] = set()
        self._server: asyncio.Server
        self._own: OwnNodes
        self._shared: Shared
        self._sweeper: asyncio.TimerHandle
        self._started = 0.0
        self._closing = False
        self._dropped = 0
        self._empty = asyncio.Event()
        self._empty.set()

    async def __aenter__(self) -> Self:
        loop = asyncio.get_running_loop()
        host, port = self.settings.host, self.settings.port
        try:
            self._server = await loop.create_server(
                lambda: Connection(self._shared), host, port, backlog=BACKLOG, start_serving=False
            )
        except OSError as error:
            raise HubError(_why_not(host, port, error)) from error
        self.port = self._server.sockets[0].getsockname()[1]
        try:
            self._own = OwnNodes(
                self.graph, loop, host=_reached_at(host), port=self.port, run_id=str(uuid.uuid1())
            )
        except FibwsError:  # The parameters may have no room for even the first ones.
            self._server.close()
            raise
        self._shared = Shared(
            settings=self.settings,
            gate=Gate(self.settings, Pages(read()), self.health),
            graph=self.graph,
            loop=loop,
            flusher=Flusher(loop.call_soon),
            own=self._own,
            opened=self._opened,
            lost=self._lost,
        )
        self._warn_if_public()
        self._started = time.monotonic()
        self._sweeper = loop.call_later(SWEEP_INTERVAL, self._sweep)
        await self._server.start_serving()
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.close()

    @property
    def url(self) -> str:
        """Where nodes on this machine reach it."""
        host = _reached_at(self.settings.host)
        return f"ws://{f'[{host}]' if ':' in host else host}:{self.port}"

    async def close(self) -> None:
        """Once entered, say good-bye to all clients and stop; who does not answer is cut off."""
        self._closing = True
        self._server.close()
        self._sweeper.cancel()
        for connection in list(self._connections):
            connection.close(SHUTDOWN)
        try:
            await asyncio.wait_for(self._empty.wait(), self.settings.close_timeout)
        except TimeoutError:
            for connection in list(self._connections):
                connection.abort()
            await self._empty.wait()
        self._own.close()
        await self._server.wait_closed()

    def health(self) -> dict[str, object]:
        """What ``/healthz`` shows: counts, and the clients that read too slowly."""
        open_ = [each for each in self._connections if each.session is not None]
        return {
            "status": "ok",
            "version": __version__,
            "uptime_seconds": round(time.monotonic() - self._started, 3),
            "clients": len(open_),
            "topics": len(self.graph.topics),
            "dropped": self._dropped + sum(each.outbox.dropped for each in open_),
            "slow_clients": [
                {
                    "node": each.name,
                    "address": each.peer,
                    "kept_bytes": each.outbox.kept_bytes,
                    "dropped": each.outbox.dropped,
                    "dropped_by_topic": {
                        spelling: subscription.queue.dropped
                        for spelling, subscription in each.session.topics.subscriptions.items()
                        if subscription.queue.dropped
                    },
                }
                for each in open_
                if each.session is not None and each.outbox.dropped
            ],
        }

    def _warn_if_public(self) -> None:
        address = self._server.sockets[0].getsockname()[0]
        if not ipaddress.ip_address(address).is_loopback:
            logger.warning(
                "Other machines can reach this hub at %s, port %d; it asks nobody for a password.",
                address,
                self.port,
            )

    def _opened(self, connection: Connection) -> None:
        self._connections.add(connection)
        self._empty.clear()
        if self._closing:
            connection.abort()

    def _lost(self, connection: Connection) -> None:
        self._connections.discard(connection)
        self._own.disconnected(connection)
        if connection.session is not None:
            self._dropped += connection.outbox.dropped
        if not self._connections:
            self._empty.set()

    def _sweep(self) -> None:
        loop = asyncio.get_running_loop()
        now = loop.time()
        late = max(0.0, now - self._sweeper.when())
        self._sweeper = loop.call_later(SWEEP_INTERVAL, self._sweep)
        for connection in list(self._connections):
            try:
                connection.sweep(now, late)
            except Exception:
                # What is wrong with one client must not leave the others unwatched.
                logger.exception("%s: the sweep failed.", connection.name)


def _reached_at(host: str) -> str:
    """How programs on this machine call the address that a hub listens on."""
    return {"0.0.0.0": "127.0.0.1", "::": "::1", "": "127.0.0.1"}.get(host, host)


def _why_not(host: str, port: int, error: OSError) -> str:
    if error.errno == errno.EADDRINUSE:
        return f"Port {port} on {host} is taken: another hub may run there. Choose one with --port"
    if error.errno in (errno.EADDRNOTAVAIL, None):  # From Python 3.13 on asyncio names none.
        return f"{host} is not an address of this machine"
    return f"Cannot listen on {host}:{port}: {error.strerror or error}"
