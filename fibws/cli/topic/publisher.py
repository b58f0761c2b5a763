"""A topic that a tool publishes."""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

import click

from fibws.client.hub_client import HubClient
from fibws.values.typedefs import Typedefs, if_known


class Publisher:
    """The right to publish on one topic, until the client is closed.

    Args:
        topic: its global name.
        latch: have the hub keep the last message for late listeners.

    Raises:
        OperationRejected: the hub will not have the topic with this type.
    """

    def __init__(self, client: HubClient, topic: str, type_: str, *, latch: bool) -> None:
        self.client = client
        self.topic = topic
        client.send({"op": "advertise", "topic": topic, "type": type_, "latch": latch})
        self.typedefs = if_known(Typedefs.of_message, client, type_)
        """Of the type; none if nobody has defined it."""
        client.process(0)
        if self.typedefs.root not in self.typedefs:
            click.echo(f"WARNING: nobody has defined {type_}: messages are not checked", err=True)

    def publish(self, message: dict[str, Any]) -> None:
        """Publish a message: all who hear the topic are sent it by the time this returns.

        Raises:
            OperationRejected: the hub will not have it.
        """
        self._send(message)
        self.client.call("/rosapi/get_time")
        self.client.process(0)

    def publish_all(self, messages: Iterable[dict[str, Any]], rate: float) -> None:
        """Publish messages, so many a second; raises as `publish`."""
        due = time.monotonic()
        is_first = True
        for message in messages:
            if is_first:
                self.publish(message)
                is_first = False
            else:
                self._send(message)
            # Whoever falls behind by more than a message does not make up for it.
            due = max(due, time.monotonic() - 1 / rate) + 1 / rate
            self.client.process(due - time.monotonic())
        self.client.call("/rosapi/get_time")
        self.client.process(0)

    def _send(self, message: dict[str, Any]) -> None:
        self.client.send({"op": "publish", "topic": self.topic, "msg": message})
