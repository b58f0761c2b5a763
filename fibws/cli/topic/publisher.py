"""A topic that a tool publishes."""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

import click

from fibws.cli.link import Link
from fibws.cli.message.typedefs import Typedefs, if_known


class Publisher:
    """The right to publish on one topic, until the link is closed.

    Args:
        topic: its global name.
        latch: have the hub keep the last message for late listeners.

    Raises:
        OperationRejected: the hub will not have the topic with this type.
    """

    def __init__(self, link: Link, topic: str, type_: str, *, latch: bool) -> None:
        self.link = link
        self.topic = topic
        link.send({"op": "advertise", "topic": topic, "type": type_, "latch": latch})
        self.typedefs = if_known(Typedefs.of_message, link, type_)
        """Of the type; none if nobody has defined it."""
        link.process(0)
        if self.typedefs.root not in self.typedefs:
            click.echo(f"WARNING: nobody has defined {type_}: messages are not checked", err=True)

    def publish(self, message: dict[str, Any]) -> None:
        """Publish a message: all who hear the topic are sent it by the time this returns.

        Raises:
            OperationRejected: the hub will not have it.
        """
        self._send(message)
        self.link.call("/rosapi/get_time")
        self.link.process(0)

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
            self.link.process(due - time.monotonic())
        self.link.call("/rosapi/get_time")
        self.link.process(0)

    def _send(self, message: dict[str, Any]) -> None:
        self.link.send({"op": "publish", "topic": self.topic, "msg": message})
