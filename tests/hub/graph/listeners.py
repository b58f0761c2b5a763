"""A topic with those who hear it."""

from __future__ import annotations

import json
from typing import Any

from fibws.hub.budget import Budget
from fibws.hub.graph.encoding import Publication
from fibws.hub.graph.publisher import Publisher
from fibws.hub.graph.subscription import Subscription
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.types import Types
from fibws.hub.outbox import Flusher, Outbox
from fibws.interfaces import Interfaces
from fibws.protocol.operations import Subscribe

from ..fakes import NANOSECONDS, FakeClock, payloads

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)


class Listeners:
    """A topic and subscriptions to it."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.flusher = Flusher(self.clock.call_soon)
        self.topic = Topic("/a")

    def subscribe(
        self,
        spelling: str = "/a",
        *,
        node: str = "/listener",
        outbox: Outbox | None = None,
        **fields: Any,
    ) -> tuple[Subscription, list[bytes]]:
        """A new subscription, and where its frames are written."""
        writes: list[bytes] = []
        outbox = outbox or Outbox(writes.append, print, self.flusher, max_bytes=1000)
        subscription = Subscription(
            node, self.topic, spelling, outbox, self.clock, print, queue_length=10
        )
        subscription.request(Subscribe(topic=spelling, **fields))
        self.topic.update(subscription)
        return subscription, writes

    def publisher(self, type_: str = "std_msgs/Int32", *, latch: bool = False) -> Publisher:
        return Publisher(
            "/talker",
            self.topic,
            TYPES.message(type_),
            lambda: NANOSECONDS,
            latch=latch,
            latches=Budget(1000),
        )

    def deliver(self, message: Any) -> None:
        self.topic.deliver(Publication(message, TYPES.message("std_msgs/Int32"), NANOSECONDS))
        self.clock.turn()


def heard_by(listeners: Listeners, writes: list[bytes]) -> list[Any]:
    listeners.clock.turn()
    return [json.loads(text)["msg"] for data in writes for text in payloads(data)]
