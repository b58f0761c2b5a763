"""Connected clients: /client_count and /connected_clients, as in rosbridge_server."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Literal, Protocol

from fibws.access.rights import Principal
from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.graph.topic import Source
from fibws.protocol.websocket import CloseReason

PERIOD = 0.1
"""Least seconds between two publications: of a thousand clients that come at once, each would have
a list published that is longer than the one before."""


class ListedClient(Protocol):
    """One client's connection."""

    address: str
    """The IP address that it comes from."""
    peer: str
    """The address with its port."""
    queue: SendQueue
    principal: Principal | None
    """Its principal, on a hub with authentication."""
    bytes_received: int

    @property
    def limited(self) -> int:
        """Messages that were dropped because they were more than it may send."""

    @property
    def messages_received(self) -> int:
        """How many messages have come from it, pings and pongs included."""

    @property
    def protocol(self) -> str:
        """The name of the protocol that it speaks."""

    def registrations(self, what: Literal["subscriptions", "advertisements"]) -> int:
        """Return the number of the client's subscriptions or advertisements."""

    @property
    def name(self) -> str:
        """The name of its node."""

    def ping(self, data: bytes) -> None:
        """Send it a WebSocket ping, whose pong brings the data back."""

    def close(self, reason: CloseReason) -> None:
        """Close the connection."""


class ConnectedClients:
    """The clients that are connected, published whenever that changes.

    Args:
        count: publishes how many there are (std_msgs/Int32).
        listing: publishes which they are (rosbridge_msgs/ConnectedClients).
    """

    def __init__(self, count: Source, listing: Source, clock: Clock) -> None:
        count.make_latest = self._count
        listing.make_latest = self._list
        self._sources = (listing, count)
        self._clock = clock
        self._clients: dict[ListedClient, int] = {}
        """Each with the nanoseconds since 1970 when it connected, the oldest first."""
        self._by_name: dict[str, ListedClient] = {}
        """The newest of each name: a client that was replaced may still be here."""
        self._timer: Timer | None = None
        self._published = -math.inf  # The first need not wait.

    def connected(self, client: ListedClient, since: int) -> None:
        """Add a client that connected at a time in nanoseconds since 1970."""
        self._clients[client] = since
        self._by_name[client.name] = client
        self._changed()

    def disconnected(self, client: ListedClient) -> None:
        """Remove a client; nothing happens if it is not there."""
        if self._clients.pop(client, None) is not None:
            if self._by_name.get(client.name) is client:
                del self._by_name[client.name]
            self._changed()

    def __iter__(self) -> Iterator[tuple[ListedClient, int]]:
        """Iterate over the clients, each with the nanoseconds since 1970 when it connected."""
        return iter(self._clients.items())

    def find(self, node: str) -> ListedClient | None:
        """Return the client that is a node; None for unknown nodes and the hub's own."""
        return self._by_name.get(node)

    def close(self) -> None:
        """Stop publishing."""
        if self._timer is not None:
            self._timer.cancel()

    def _changed(self) -> None:
        if self._timer is not None:
            return
        rest = self._published + PERIOD - self._clock.time()
        if rest > 0:
            self._timer = self._clock.call_later(rest, self._publish)
        else:
            self._publish()

    def _publish(self) -> None:
        self._timer = None
        self._published = self._clock.time()
        for source in self._sources:
            if source.make_latest is not None and source.group.has_sinks:
                source.publish(source.make_latest())

    def _count(self) -> dict[str, Any]:
        return {"data": len(self._clients)}

    def _list(self) -> dict[str, Any]:
        return {"clients": [_entry(client.address, since) for client, since in self]}


def _entry(address: str, since: int) -> dict[str, Any]:
    secs, nsecs = divmod(since, 1_000_000_000)
    return {"ip_address": address, "connection_time": {"secs": secs, "nsecs": nsecs}}
