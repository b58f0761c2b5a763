"""Who is connected: /client_count and /connected_clients, as rosbridge_server publishes them.

The hub's own nodes find the clients here to tell of them, and to have them do something.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Protocol

from fibws.hub.clock import Clock, Timer
from fibws.hub.graph.publisher import Publisher
from fibws.hub.outbox import Outbox
from fibws.protocol.closing import Closing

PERIOD = 0.1
"""Seconds between two publications at least: a thousand clients that come at once would have a
thousand lists published, each longer than the one before."""


class Client(Protocol):
    """One client's connection."""

    address: str
    """The IP address that it comes from."""
    peer: str
    """That with its port."""
    outbox: Outbox

    @property
    def name(self) -> str:
        """The name of its node."""

    def ping(self, data: bytes) -> None:
        """Send it a WebSocket ping, whose pong brings the data back."""

    def close(self, closing: Closing) -> None:
        """Close the connection."""


class ConnectedClients:
    """The clients that are connected, published whenever that changes.

    Args:
        count: publishes how many there are (std_msgs/Int32).
        listing: publishes which they are (rosbridge_msgs/ConnectedClients).
    """

    def __init__(self, count: Publisher, listing: Publisher, clock: Clock) -> None:
        count.current = self._number
        listing.current = self._list
        self._publishers = (listing, count)
        self._clock = clock
        self._clients: dict[Client, int] = {}
        """With the nanoseconds since 1970 when each came, the first to come first."""
        self._timer: Timer | None = None
        self._published = -math.inf  # The first to come need not wait.

    def connected(self, client: Client, since: int) -> None:
        """Count a client in, which came so many nanoseconds after 1970."""
        self._clients[client] = since
        self._changed()

    def disconnected(self, client: Client) -> None:
        """Count a client out; nothing happens if it was not in."""
        if self._clients.pop(client, None) is not None:
            self._changed()

    def __iter__(self) -> Iterator[tuple[Client, int]]:
        """Each with the nanoseconds since 1970 when it came, the first to come first."""
        return iter(self._clients.items())

    def of(self, node: str) -> Client | None:
        """The client that is a node; None if there is none of that name, or it is the hub's own."""
        named = (client for client in reversed(self._clients) if client.name == node)
        # Whoever was replaced may still be here.
        return next(named, None)

    def close(self) -> None:
        """Publish no more."""
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
        for publisher in self._publishers:
            if publisher.current is not None and publisher.topic.channels:
                publisher.publish(publisher.current())

    def _number(self) -> dict[str, Any]:
        return {"data": len(self._clients)}

    def _list(self) -> dict[str, Any]:
        return {"clients": [_connected(client.address, since) for client, since in self]}


def _connected(address: str, since: int) -> dict[str, Any]:
    secs, nsecs = divmod(since, 1_000_000_000)
    return {"ip_address": address, "connection_time": {"secs": secs, "nsecs": nsecs}}
