"""Who is connected: /client_count and /connected_clients, as rosbridge_server publishes them."""

from __future__ import annotations

import math
from typing import Any

from fibws.hub.clock import Clock, Timer
from fibws.hub.graph.topic import Publisher

PERIOD = 0.1
"""Seconds between two publications at least: a thousand clients that come at once would have a
thousand lists published, each longer than the one before."""


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
        self._clients: dict[object, tuple[str, int]] = {}
        self._timer: Timer | None = None
        self._published = -PERIOD
        self._published = -math.inf  # The first to come need not wait.

    def connected(self, client: object, address: str, since: int) -> None:
        """Count a client in.

        Args:
            client: any object that is no other client's.
            address: the IP address that it comes from.
            since: when it came, in nanoseconds since 1970.
        """
        self._clients[client] = (address, since)
        self._changed()

    def disconnected(self, client: object) -> None:
        """Count a client out; nothing happens if it was not in."""
        if self._clients.pop(client, None) is not None:
            self._changed()

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
        return {"clients": [_connected(*client) for client in self._clients.values()]}


def _connected(address: str, since: int) -> dict[str, Any]:
    secs, nsecs = divmod(since, 1_000_000_000)
    return {"ip_address": address, "connection_time": {"secs": secs, "nsecs": nsecs}}
